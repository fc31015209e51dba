"""Results without snapshots or series: every command works, or says in one line what is missing."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from warpgran.cli.app import app
from warpgran.errors import ResultError
from warpgran.figures import plot
from warpgran.files import StorageError

SMALL = "grid = { right = 0.2, cells = 60 }\ntime.end = 0.02\n"
STUDIES = {
    "single": SMALL,
    "profile with phi": SMALL + 'column.profile = "heap.csv"\n',
    "batch": SMALL + '[sweep.over]\n"slope.angle" = [0, 10]\n',
    "two grids": SMALL + '[sweep.over]\n"grid.cells" = [60, 80]\n',
}
OUTPUTS = {"filled": "{ every = 0.01 }", "empty": "[]"}
COMMANDS = {"plot": "out.png", "animate": "out.gif", "summary": ""}
COMBINATIONS = [
    pytest.param("filled", "filled", marks=pytest.mark.slow),
    ("filled", "empty"),
    ("empty", "filled"),
    ("empty", "empty"),
]


@pytest.fixture(scope="module", params=STUDIES)
def study(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a run file of a few cells."""
    folder = tmp_path_factory.mktemp("study")
    (folder / "heap.csv").write_text("x,h,phi\n-0.2,0.1,0.6\n-0.1,0.1,0.62\n0.0,0.0,0.6\n")
    (folder / "out.toml").write_text(STUDIES[request.param])
    return folder


def lines_of(result: Result) -> list[str]:
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    return result.stderr.splitlines()


@pytest.mark.slow
@pytest.mark.parametrize(("snapshots", "series"), COMBINATIONS)
def test_every_command_works_or_says_what_is_missing(study: Path, snapshots: str, series: str) -> None:
    asked = ("--set", f"time.snapshots={OUTPUTS[snapshots]}", "--set", f"time.series={OUTPUTS[series]}")
    out = study / "out.h5"
    ran = CliRunner().invoke(app, ["run", str(study / "out.toml"), "-o", str(out), "--force", *asked])
    assert ran.exit_code == 0, lines_of(ran)
    batch = "sweep" in (study / "out.toml").read_text()
    drawable = series == "filled" or (snapshots == "filled" and not batch)
    no_picture = [line for line in lines_of(ran) if "no picture: " in line]
    assert len(no_picture) == (not drawable)
    assert ran.stdout.splitlines()[-1] == f"wrote {out}" + f" and {out.with_suffix('.png')}" * drawable

    works = {"plot": drawable, "animate": snapshots == "filled", "summary": True}
    for command, written in COMMANDS.items():
        (study / written).unlink(missing_ok=True) if written else None
        result = CliRunner().invoke(app, [command, str(out)])
        told = lines_of(result)
        assert result.exit_code == (0 if works[command] else 2), (command, told)
        if written:
            assert (study / written).exists() == works[command]
        if not works[command]:
            (line,) = told
            assert line.startswith("warpgran: ")
            assert ("snapshots" if command == "animate" else "series") in line


@pytest.mark.parametrize("error", [ResultError("why"), StorageError("why"), OSError("why")])
def test_a_picture_that_fails_takes_nothing_from_the_results(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: Exception
) -> None:
    def fail(*arguments: object, **options: object) -> None:
        raise error

    monkeypatch.setattr(plot, "plot", fail)
    (tmp_path / "out.toml").write_text(SMALL + "time.snapshots = []\n")
    ran = CliRunner().invoke(app, ["run", str(tmp_path / "out.toml"), "-o", str(tmp_path / "out.h5")])
    assert ran.exit_code == 0
    assert "warpgran: no picture: why" in lines_of(ran)
    assert ran.stdout.splitlines()[-1] == f"wrote {tmp_path / 'out.h5'}"
