"""The command line as a user meets it: what it writes, says, and refuses."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pytest
from typer.testing import CliRunner, Result

import warpgran as wg
from warpgran.case import read_study
from warpgran.case.case import Case
from warpgran.cli.app import app
from warpgran.cli.arguments import bytes_of
from warpgran.figures import animation
from warpgran.schema import Status
from warpgran.solve.expected_steps import expected_steps

QUICK = """
title = "Quick"
[slope]
angle = 22.0
[grid]
right = 0.6
cells = 200
[time]
end = 0.2
snapshots = { every = 0.05 }
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The working folder, with a quick run file in it."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "quick.toml").write_text(QUICK)
    return tmp_path


def warpgran(*arguments: str) -> Result:
    return CliRunner().invoke(app, arguments)


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_run_writes_a_file_and_a_picture_and_says_so(folder: Path) -> None:
    result = warpgran("run", "quick.toml")
    assert result.exit_code == 0, result.output
    assert result.stdout.splitlines()[-1] == "wrote quick.h5 and quick.png"
    assert "million cell-steps" in result.stdout
    assert all(word in result.stdout for word in ("Quick", "front", "max h", "volume", "stop"))
    (told,) = result.stderr.splitlines()  # no progress bar where there is no terminal
    said = r"run 0 had not stopped at the end \(.* m/s at t = 0.2 s\): its run-out is not final"
    assert re.fullmatch(rf"warpgran: {said}, and grew by .* % in the last tenth of the time", told)
    assert names(folder) == ["quick.h5", "quick.png", "quick.toml"]
    data = wg.open_dataset("quick.h5")
    assert data.attrs["run_file"] == QUICK
    assert int(data["status"][0]) == Status.OK


def test_both_engines_write_the_same_result(folder: Path) -> None:
    for engine in ("warp", "numpy"):
        assert warpgran("run", "quick.toml", "--engine", engine, "-o", f"{engine}.h5", "--no-picture").exit_code == 0
    ours, theirs = wg.open_dataset("warp.h5"), wg.open_dataset("numpy.h5")
    for name in ("h", "v", "phi", "front", "energy", "steps"):
        assert float(abs(ours[name] - theirs[name]).max()) <= 1e-10, name


def test_options_reach_the_run(folder: Path) -> None:
    result = warpgran("run", "quick.toml", "--set", "slope.angle=5", "--set", "time.snapshots=[0.2]",
                      "--precision", "float32", "-o", "other.h5", "--no-picture")  # fmt: skip
    assert result.exit_code == 0, result.output
    assert names(folder) == ["other.h5", "quick.toml"]
    data = wg.open_dataset("other.h5")
    assert data.attrs["precision"] == "float32"
    assert "angle = 5.0" in data.attrs["case_toml"]
    assert data.sizes["time"] == 1


@pytest.mark.slow
def test_plot_and_animate(folder: Path) -> None:
    warpgran("run", "quick.toml", "--no-picture")
    assert warpgran("plot", "quick.h5", "-o", "p.svg").stdout == "wrote p.svg\n"
    assert warpgran("animate", "quick.h5").stdout == "wrote quick.gif\n"
    assert names(folder) == ["p.svg", "quick.gif", "quick.h5", "quick.toml"]


def test_a_picture_of_one_run_does_not_replace_that_of_all(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    warpgran("run", "quick.toml", "--no-picture")
    monkeypatch.setattr(animation, "animate", lambda *data, **how: SimpleNamespace(advice=""))
    for command, wanted in (("plot", "quick_run0.png"), ("animate", "quick_run0.gif")):
        assert warpgran(command, "quick.h5", "--run", "0").stdout == f"wrote {wanted}\n"


def test_check_says_what_a_run_asks_for(folder: Path) -> None:
    result = warpgran("check", "quick.toml")
    assert result.exit_code == 0
    assert "200 cells of 4 mm" in result.stdout
    steps, cell_steps = expected_steps(Case.from_toml("quick.toml"))
    said = re.search(r", about (\d\d0*) steps\n.*\nabout (\d\d0*) cell-steps\n", result.stdout, re.DOTALL)
    assert said, "to two digits: they are estimates"
    assert [float(number) for number in said.groups()] == pytest.approx([steps, cell_steps], rel=0.05)
    assert "5 snapshots and 201 samples" in result.stdout
    assert names(folder) == ["quick.toml"]


def test_check_examines_some_runs_of_a_large_study(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("warpgran.cli.check.EXAMINED", 50)
    values = [0.5 + 1e-4 * run for run in range(300)]
    sweep = ["--set", "sweep.mode=zip", "--set", f"sweep.over.column.phi={values}"]
    result = warpgran("check", "quick.toml", *sweep)
    assert result.exit_code == 0
    assert "about 50 of 300 runs were checked, those with the least and the greatest values" in result.stdout
    values[137] = 1.5
    result = warpgran("check", "quick.toml", "--set", f"sweep.over.column.phi={values}", *sweep[:2])
    assert result.exit_code == 2
    assert "column.phi: 1.5 is out of range" in result.stderr
    assert "run 137" in result.stderr


@pytest.mark.parametrize(
    ("sizes", "bytes_"),
    [(("4GiB", "4gib", "4 Gi", "4294967296"), 4 * 2**30), (("4GB", "4g", "4e9", "4000MB"), 4e9), (("1.5KiB",), 1536.0)],
)
def test_sizes_of_memory(sizes: tuple[str, ...], bytes_: float) -> None:
    assert [bytes_of(size) for size in sizes] == [bytes_] * len(sizes)


def test_a_loss_through_the_end_is_told_and_marked(folder: Path) -> None:
    result = warpgran("run", "quick.toml", "--set", "grid.right=0.02", "--set", "grid.cells=200", "--no-picture")
    told = [line for line in result.stderr.splitlines() if "lost solid" in line]
    assert len(told) == 1 and told[0].startswith("warpgran: run 0 lost solid through an end of the grid (")
    assert result.exit_code == 0
    assert "> a lower bound: solid has left the grid" in result.stdout
    summary = warpgran("summary", "quick.h5")
    assert told[0] in summary.stderr
    warpgran("summary", "quick.h5", "--csv", "table.csv")
    header, row = (folder / "table.csv").read_text().splitlines()
    assert dict(zip(header.split(","), row.split(","), strict=True))["left_grid"] == "True"


def test_info_names_the_devices(folder: Path) -> None:
    result = warpgran("info")
    assert result.exit_code == 0
    assert re.search(
        r"device cpu: .* GiB: runs of 1000 cells that fit: [\d,]+ in float64, [\d,]+ in float32", result.stdout
    )


def test_a_diverged_run_is_told_and_kept(folder: Path) -> None:
    diverging = ["scheme.order=1", "scheme.viscosity=paper", "rheology.K=0", "time.series=[0, 0.001, 0.2]"]
    result = warpgran("run", "quick.toml", *(word for change in diverging for word in ("--set", change)))
    assert result.exit_code == 1
    assert "run 0 diverged after t = " in result.stderr
    assert "phi outside (0, 1]" in result.stderr
    assert "diverged" in result.stdout
    assert int(wg.open_dataset("quick.h5")["status"][0]) == Status.DIVERGED


def test_the_step_limit_is_told_and_kept(folder: Path) -> None:
    result = warpgran("run", "quick.toml", "--set", "time.step_limit=5")
    assert result.exit_code == 1
    assert "step_limit" in result.stdout
    before, after, *_ = result.stderr.splitlines()
    assert before.startswith("warpgran: warning: time.step_limit: 5 is reached before time.end; likely: more than ")
    assert after.startswith("warpgran: run 0 reached its step limit, 5 steps, at t = ")
    assert int(wg.open_dataset("quick.h5")["steps"][0]) == 5


BAD = [
    (["run", "quick.toml", "--set", "slope.angel=3"], "slope.angel: unknown key; did you mean slope.angle?"),
    (["run", "quick.toml", "--set", "rheology.mu1=-0.3"], "rheology.mu1: -0.3"),
    (["run", "quick.toml", "--set", "rheology.K=nan"], "rheology.K"),
    (["run", "quick.toml", "--set", "time.end=soon"], "time.end"),
    (["run", "quick.toml", "--set", "time.end=5e-324"], "time.end: 5e-324 is out of range; allowed: 0, or a size from"),
    (["check", "quick.toml", "--set", "scheme.cfl=1e-320"], "scheme.cfl: 1e-320 is out of range"),
    (["run", "quick.toml", "--engine", "numpy", "--set", "grid.right=1e160"], "grid.right: 1e+160 is out of range"),
    (["check", "quick.toml", "--set", f"grid.cells={'9' * 5000}"], "grid.cells"),
    (["run", "quick.toml", "--threads", "9" * 21], "is out of range; allowed: 1 to 4096"),
    (["run", "quick.toml", "--memory", "1e400GB"], "memory: inf is out of range"),
    (["run", "quick.toml", "--memory", "4Q"], "memory: '4Q' is not a size"),
    (["run", "quick.toml", "--shard", "²/3"], "shard: '²/3' is not a shard; allowed: I/N"),
    (["run", "quick.toml", "--set", "slope.bed=missing.csv"], "missing.csv"),
    (["run", "quick.toml", "--set", "slope.bed=quick.toml"], "slope.bed"),
    (["run", "quick.toml", "--set", "column.start=0.55"], "column"),
    (["run", "absent.toml"], "absent.toml"),
    (["run", "quick.toml", "-o", "absent/out.h5"], "cannot write absent/out.h5"),
    (["run", "quick.toml", "-o", "."], "it is a folder"),
    (["run", "quick.toml", "--device", "cuda:7"], "'cuda:7' is not on this machine; there is: cpu"),
    (["run", "quick.toml", "--device", "tpu"], "'tpu' is not on this machine; there is: cpu"),
    (["run", "quick.toml", "--engine", "numpy", "--precision", "float32"], "numpy computes"),
    (["run", "quick.toml", "--precision", "float16"], "float16"),
    (["check", "absent.toml"], "absent.toml"),
    (["plot", "absent.h5"], "there is no such file"),
    (["plot", "quick.toml"], "not an HDF5 file"),
    (["animate", "absent.h5"], "there is no such file"),
]


@pytest.mark.parametrize(("arguments", "words"), BAD, ids=[" ".join(arguments) for arguments, _ in BAD])
def test_bad_input_is_refused_in_a_line(folder: Path, arguments: list[str], words: str) -> None:
    result = warpgran(*arguments)
    assert result.exit_code == 2
    assert words in result.stderr
    assert "Traceback" not in result.output
    assert isinstance(result.exception, SystemExit)
    assert names(folder) == ["quick.toml"]


def test_all_errors_are_told_at_once(folder: Path) -> None:
    result = warpgran("run", "quick.toml", "--set", "slope.angel=3", "--set", "time.end=-1", "--set", "grid.cells=0.5")
    lines = result.stderr.splitlines()
    assert len(lines) == 3
    assert all(line.startswith("warpgran: ") for line in lines)


@pytest.mark.parametrize(
    ("change", "words"), [("run=3", "run 3"), ("suffix", "must end in .png"), ("few", "time.snapshots={every=")]
)
def test_a_picture_that_cannot_be_made(folder: Path, change: str, words: str) -> None:
    warpgran("run", "quick.toml", "--no-picture", "--set", "time.snapshots=[0.2]")
    arguments = {
        "run=3": ("plot", "quick.h5", "--run", "3"),
        "suffix": ("plot", "quick.h5", "-o", "quick.doc"),
        "few": ("animate", "quick.h5"),
    }[change]
    result = warpgran(*arguments)
    assert result.exit_code == 2
    assert words in result.stderr
    assert names(folder) == ["quick.h5", "quick.toml"]


KINDS = [getattr(wg, name) for name in wg.__all__ if isinstance(getattr(wg, name), type)]
CAUSED_BY_A_USER = {
    **{kind.__name__: kind.__new__(kind, "wrong") for kind in KINDS if issubclass(kind, wg.WarpgranError)},
    "MemoryError": MemoryError("wrong"),
}


@pytest.mark.parametrize("error", CAUSED_BY_A_USER.values(), ids=CAUSED_BY_A_USER.keys())
def test_what_a_user_can_cause_is_reported_in_a_line(
    folder: Path, monkeypatch: pytest.MonkeyPatch, error: Exception
) -> None:
    monkeypatch.setattr(read_study, "read_study", raising(error))
    result = warpgran("check", "quick.toml")
    assert (result.exit_code, result.output) == (2, "warpgran: wrong\n")


@pytest.mark.parametrize(
    ("error", "words"),
    [(MemoryError(), "out of memory"), (OSError(5, "it is broken", "disk"), "cannot use disk: it is broken")],
)
def test_so_is_what_the_system_refuses(
    folder: Path, monkeypatch: pytest.MonkeyPatch, error: Exception, words: str
) -> None:
    monkeypatch.setattr(read_study, "read_study", raising(error))
    result = warpgran("check", "quick.toml")
    assert (result.exit_code, result.output) == (2, f"warpgran: {words}\n")


def raising(error: Exception) -> Callable[..., None]:
    def raise_(*arguments: object, **options: object) -> None:
        raise error

    return raise_


@pytest.mark.parametrize("error", [ValueError("ours"), KeyError("ours"), OSError("no file named")])
def test_a_defect_keeps_its_traceback(folder: Path, monkeypatch: pytest.MonkeyPatch, error: Exception) -> None:
    monkeypatch.setattr(read_study, "read_study", raising(error))
    result = warpgran("check", "quick.toml")
    assert (result.exit_code, result.exception, result.output) == (1, error, "")


def test_python_prints_that_traceback(folder: Path) -> None:
    code = (
        "from warpgran.case import read_study\n"
        "def read(*arguments, **options): raise ValueError('ours')\n"
        "read_study.read_study = read\n"
        "from warpgran.cli.app import main\n"
        "main()\n"
    )
    failed = subprocess.run([sys.executable, "-c", code, "check", "quick.toml"], capture_output=True, text=True)
    assert failed.returncode == 1
    assert failed.stderr.startswith("Traceback")
    assert failed.stderr.endswith("ValueError: ours\n")


def test_debug_shows_the_traceback(folder: Path) -> None:
    assert isinstance(warpgran("--debug", "run", "absent.toml").exception, wg.CaseError)


LONG = QUICK.replace("end = 0.2", "end = 100000.0").replace("every = 0.05 }", "every = 1.0 }\nseries = []")


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="sends a POSIX signal")
def test_an_interrupted_run_keeps_what_it_had(folder: Path) -> None:
    (folder / "long.toml").write_text(LONG)
    command = [sys.executable, "-c", "from warpgran.cli.app import main; main()", "run", "long.toml", "--no-picture"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        while not (folder / "long.h5.part").exists():
            time.sleep(0.05)
        time.sleep(3.0)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=30)
    assert process.returncode == 130, errors
    assert "interrupted at t = " in errors
    assert re.search(r"interrupted; the run is kept as of t = .* s: go on with --resume", errors)
    assert names(folder) == ["long.h5", "long.toml", "quick.toml"]
    data = wg.open_dataset("long.h5")
    assert int(data["status"][0]) == Status.INTERRUPTED
    reached = float(data["end_time"][0])
    stored = data["time"][data["h"][0].notnull().all("x")]
    assert 10.0 < reached < 100_000.0
    assert reached - 2.0 < float(stored[-1]) <= reached


def test_nothing_is_overwritten_unasked(folder: Path) -> None:
    os.mkfifo("fifo")
    (folder / "quick.png").write_text("a holiday")
    for arguments, words in (
        (["-o", "x.png"], "allowed: a name such as out.h5"),
        (["-o", "quick.toml", "--force"], "cannot write quick.toml"),
        (["-o", "/dev/null"], "it is a device"),
        (["-o", "fifo"], "it is a FIFO"),
        (["-o", "absent/deep/out.h5"], "there is no folder absent"),
        ([], "cannot write quick.png: what is there was not written by warpgran"),
    ):
        result = warpgran("run", "quick.toml", *arguments)
        assert result.exit_code == 2
        assert words in result.stderr
        assert len(result.stderr.splitlines()) == 1
    assert names(folder) == ["fifo", "quick.png", "quick.toml"]
    assert (folder / "quick.png").read_text() == "a holiday"


def test_run_twice_and_another_study_by_force(folder: Path) -> None:
    for _ in range(2):
        assert warpgran("run", "quick.toml").exit_code == 0
    other = ["run", "quick.toml", "--set", "slope.angle=5"]
    refused = warpgran(*other)
    assert refused.exit_code == 2
    assert re.search(r"differs in slope.angle \(22.0 there, 5.0 here\).*; --force replaces it", refused.stderr)
    assert warpgran(*other, "--force").exit_code == 0
    assert "angle = 5.0" in wg.open_dataset("quick.h5").attrs["case_toml"]


def test_only_files_are_read(folder: Path) -> None:
    os.mkfifo("fifo")
    for command in ("run", "check", "plot", "animate", "summary"):
        for path in ("fifo", "/dev/zero"):
            result = warpgran(command, path)
            assert result.exit_code == 2
            assert re.search("it is a (FIFO|device), not a file", result.stderr)
