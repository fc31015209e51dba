"""The command `warpgran view`, and the page of `warpgran run --view`."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from warpgran.cli.app import app
from warpgran.cli.arguments import numbers_of
from warpgran.errors import OptionError

QUICK = "slope.angle = 22.0\ngrid = { right = 0.6, cells = 200 }\ntime = { end = 0.2, snapshots = [0.1, 0.2] }\n"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The working folder, with a quick run file in it."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "quick.toml").write_text(QUICK)
    return tmp_path


def warpgran(*arguments: str) -> Result:
    return CliRunner().invoke(app, arguments)


def test_a_run_with_view_writes_the_page_that_view_writes(folder: Path) -> None:
    result = warpgran("run", "quick.toml", "--no-picture", "--view")
    assert result.exit_code == 0, result.output
    assert result.stdout.splitlines()[-1] == "wrote quick.h5 and quick.html"
    result = warpgran("view", "quick.h5", "-o", "again.html")
    assert result.stdout.startswith("wrote again.html, 0.0")
    assert "had not stopped at the end" in result.stderr
    assert (folder / "again.html").read_bytes() == (folder / "quick.html").read_bytes()


def test_a_run_with_view_does_not_begin_where_the_page_cannot_be_written(folder: Path) -> None:
    (folder / "quick.html").write_text("a letter")
    result = warpgran("run", "quick.toml", "--no-picture", "--view")
    assert result.exit_code == 2
    assert "quick.html: what is there was not written by warpgran" in result.stderr
    assert not (folder / "quick.h5").exists()


def test_files_of_one_name_are_told_apart_and_one_file_is_named_once(folder: Path) -> None:
    warpgran("run", "quick.toml", "--no-picture")
    (folder / "other").mkdir()
    warpgran("run", "quick.toml", "--no-picture", "-o", "other/quick.h5", "--set", "slope.angle=5")
    result = warpgran("view", "quick.h5", "other/quick.h5")
    assert result.exit_code == 0
    told = [line.partition(" had not stopped")[0] for line in result.stderr.splitlines()]
    assert told == ["warpgran: quick.h5: run 0", "warpgran: other/quick.h5: run 0"]
    assert '"files": ["quick.h5", "other/quick.h5"]' in (folder / "quick.html").read_text()
    result = warpgran("view", "quick.h5", "quick.h5")
    assert result.exit_code == 2 and "quick.h5 is named twice" in result.stderr


def test_a_batch_without_snapshots_has_a_page_of_its_runs(folder: Path) -> None:
    (folder / "batch.toml").write_text(QUICK + '[sweep.over]\n"slope.angle" = [0, 5]\n')
    quick = ("--set", "grid.cells=60", "--set", "time.snapshots=[]")
    result = warpgran("run", "batch.toml", *quick, "--no-picture", "--view")
    assert result.exit_code == 0, result.output
    assert result.stdout.splitlines()[-1] == "wrote batch.h5 and batch.html"


def test_runs_and_sizes_are_checked(folder: Path) -> None:
    assert numbers_of("0, 5,10-12", "runs") == [0, 5, 10, 11, 12]
    assert numbers_of(None, "runs") is None
    for text in ("", "a", "3-1", "-1", "1,,2", "0-99999999"):
        with pytest.raises(OptionError, match="allowed: as 0,5,10-19"):
            numbers_of(text, "runs")
    warpgran("run", "quick.toml", "--no-picture")
    result = warpgran("view", "quick.h5", "--max-size", "ten")
    assert result.exit_code == 2 and "max-size: 'ten' is not a size" in result.stderr
    for numbers, words in (("3", "runs: 3 is in no result"), ("0,3-9", "runs: 3, 4, 5, 6, 7, ... are in no result")):
        result = warpgran("view", "quick.h5", "--runs", numbers)
        assert result.exit_code == 2 and words in result.stderr


def test_the_page_is_opened_when_asked(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[str] = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    warpgran("run", "quick.toml", "--no-picture")
    warpgran("view", "quick.h5")
    assert opened == []
    warpgran("view", "quick.h5", "--open")
    assert opened == [(folder / "quick.html").as_uri()]
