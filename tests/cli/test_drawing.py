"""The picture of a run: drawn by a process of its own, and here where there is none or it fails."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from io import BytesIO
from pathlib import Path
from typing import Any

import pytest
from matplotlib import _mathtext
from PIL import Image
from typer.testing import CliRunner, Result

from warpgran.cli import drawing
from warpgran.cli.app import app
from warpgran.figures import plot
from warpgran.figures.style import Sheet

QUICK = "grid = { right = 0.3, cells = 100 }\ntime.end = 0.01\n"


@pytest.fixture
def processes(monkeypatch: pytest.MonkeyPatch) -> list[subprocess.Popen[bytes]]:
    """The processes that draw, which there are though what draws is imported here."""
    started: list[subprocess.Popen[bytes]] = []

    class Noted(subprocess.Popen):  # type: ignore[type-arg]
        def __init__(self, *arguments: Any, **options: Any) -> None:
            super().__init__(*arguments, **options)
            started.append(self)

    monkeypatch.setattr(drawing, "_gains", lambda: True)
    monkeypatch.setattr(subprocess, "Popen", Noted)
    return started


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "quick.toml").write_text(QUICK)
    return tmp_path


def run(*arguments: str) -> Result:
    return CliRunner().invoke(app, ["run", *arguments])


def no_drawing_here(*arguments: object, **options: object) -> None:
    pytest.fail("it is drawn here")


def test_another_process_draws(
    folder: Path, processes: list[subprocess.Popen[bytes]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(plot, "plot", no_drawing_here)
    (folder / "numpy.py").write_text("raise SystemExit")  # which it does not take for the library
    result = run("quick.toml")
    assert result.exit_code == 0, result.output
    assert result.stdout.splitlines()[-1] == "wrote quick.h5 and quick.png"
    with Image.open("quick.png") as picture:
        assert picture.text["Software"].startswith("warpgran ")  # type: ignore[attr-defined]
    (process,) = processes
    assert process.returncode == 0


@pytest.mark.parametrize("python", ["/bin/false", "/absent/python", ""])
def test_it_is_drawn_here_where_no_process_does(
    folder: Path, processes: list[subprocess.Popen[bytes]], monkeypatch: pytest.MonkeyPatch, python: str
) -> None:
    monkeypatch.setattr(sys, "executable", python)
    result = run("quick.toml")
    assert result.stdout.splitlines()[-1] == "wrote quick.h5 and quick.png"
    assert (folder / "quick.png").exists()
    assert len(processes) == (python == "/bin/false")


def test_why_there_is_no_picture_is_said_once(
    folder: Path, processes: list[subprocess.Popen[bytes]], capfd: pytest.CaptureFixture[str]
) -> None:
    result = run("quick.toml", "--set", "time.snapshots=[]", "--set", "time.series=[]")
    assert result.exit_code == 0
    assert [line for line in result.stderr.splitlines() if "no picture: " in line] == [
        "warpgran: no picture: run 0 has nothing to draw: it holds no snapshot and no sample of the series"
    ]
    assert capfd.readouterr().err == ""  # of the process
    assert processes[0].returncode == 1


def test_the_process_ends_with_a_run_that_fails(folder: Path, processes: list[subprocess.Popen[bytes]]) -> None:
    assert run("quick.toml", "--set", "time.end=-1").exit_code == 2
    assert processes[0].returncode == -signal.SIGKILL


def test_the_process_ends_with_a_run_that_is_killed() -> None:
    command = [sys.executable, "-c", "from warpgran.cli.drawing import main; main()"]
    ended = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, check=False)
    assert (ended.returncode, ended.stdout, ended.stderr) == (1, b"", b"")


def test_ctrl_c_ends_the_computation_and_not_what_draws(folder: Path, processes: list[subprocess.Popen[bytes]]) -> None:
    with drawing.Drawing():
        (process,) = processes
        assert os.getpgid(process.pid) == process.pid != os.getpgrp()


def test_what_is_drawn_to_warm_up_spares_formulas_of_the_page(monkeypatch: pytest.MonkeyPatch) -> None:
    parsed: list[str] = []
    parse = _mathtext.Parser.parse

    def noted(self: Any, formula: str, *arguments: Any) -> Any:
        parsed.append(formula)
        return parse(self, formula, *arguments)

    monkeypatch.setattr(_mathtext.Parser, "parse", noted)
    drawing._warm_up()
    parsed.clear()
    page = Sheet()
    for label in ("velocity $v$ (m/s)", "thickness $h$ (cm)", "$y$"):
        page.text(0.0, 0.0, label, fontsize=8)
    page.savefig(BytesIO(), format="png")
    assert parsed == ["$y$"]


@pytest.mark.parametrize(("cores", "imported"), [(1, False), (2, True)])
def test_no_process_where_it_gains_nothing(monkeypatch: pytest.MonkeyPatch, cores: int, imported: bool) -> None:
    monkeypatch.setattr(os, "cpu_count", lambda: cores)
    if not imported:
        monkeypatch.delitem(sys.modules, "warpgran.figures.plot")
    with drawing.Drawing() as here:
        assert here._process is None
