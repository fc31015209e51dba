"""`warpgran compare` as a user meets it: its tables and its exit status."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from warpgran.cli.app import app

QUICK = """
[slope]
angle = 22.0
[grid]
right = 0.4
cells = 150
[time]
end = 0.05
"""


def warpgran(*arguments: str) -> Result:
    return CliRunner().invoke(app, arguments)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The working folder, with a result a.h5 in it."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "quick.toml").write_text(QUICK)
    computed("a.h5")
    return tmp_path


def computed(name: str, *options: str) -> None:
    result = warpgran("run", "quick.toml", "--no-picture", "-o", name, *options)
    assert result.exit_code == 0, result.output


def cells(result: Result, first: str) -> list[str]:
    """The words of the one line that begins so."""
    [line] = [line for line in result.stdout.splitlines() if line.split()[:1] == [first]]
    return line.split()


def test_identical_results_exit_with_0(folder: Path) -> None:
    shutil.copy("a.h5", "b.h5")
    result = warpgran("compare", "a.h5", "b.h5")
    assert result.exit_code == 0
    assert result.stdout.splitlines()[-1] == "the results are identical, bit for bit"
    assert "largest difference" not in result.stdout
    computed("b.h5", "--threads", "1")
    assert warpgran("compare", "a.h5", "b.h5").exit_code == 0


def test_another_angle_exits_with_1_and_is_named(folder: Path) -> None:
    computed("b.h5", "--set", "slope.angle=16")
    result = warpgran("compare", "a.h5", "b.h5")
    assert result.exit_code == 1
    assert cells(result, "slope.angle")[1:] == ["22", "16"]
    _, unit, a, b, difference, *_ = cells(result, "run_out")
    assert unit == "cm"
    assert float(b) - float(a) == pytest.approx(float(difference), abs=1e-3)
    assert float(difference) != 0.0
    assert cells(result, "phi")[-1] != "-"
    told = result.stderr.splitlines()
    assert [line.split()[1] for line in told] == ["a.h5:", "b.h5:"]  # that neither had stopped


def test_another_grid_is_said_to_be_interpolated(folder: Path) -> None:
    computed("b.h5", "--set", "grid.cells=300")
    result = warpgran("compare", "a.h5", "b.h5")
    assert result.exit_code == 1
    assert "the grids differ: h, v and phi are interpolated linearly onto the coarser" in result.stdout
    assert cells(result, "grid.cells")[1:] == ["150", "300"]


def test_another_precision_is_a_fact_and_a_small_difference(folder: Path) -> None:
    computed("b.h5", "--precision", "float32")
    result = warpgran("compare", "a.h5", "b.h5")
    assert result.exit_code == 1
    assert cells(result, "precision")[1:] == ["float64", "float32"]
    assert 0.0 < abs(float(cells(result, "h")[4])) < 1e-3


def test_sweeps_are_compared_run_by_run(folder: Path) -> None:
    angles = ["--set", "sweep.over.slope.angle=[0, 10, 22]"]
    computed("b.h5", *angles)
    computed("c.h5", "--set", "sweep.over.slope.angle=[10, 22, 0]", "--set", "rheology.K=1")
    result = warpgran("compare", "b.h5", "c.h5")
    assert result.exit_code == 1
    assert "3 pairs of runs, matched by slope.angle" in result.stdout
    assert cells(result, "rheology.K")[1:] == ["4.09", "1"]
    assert "median" in result.stdout
    assert max(map(len, result.stdout.splitlines())) <= 100
    result = warpgran("compare", "a.h5", "b.h5")
    assert result.exit_code == 1  # two runs of b stand alone
    assert "2 runs of b have no counterpart" in result.stdout
    assert result.stdout.splitlines()[-1] == "what could be compared is identical, bit for bit"


@pytest.mark.parametrize("other", ["absent.h5", "quick.toml", "half.h5"])
def test_what_cannot_be_compared_exits_with_2(folder: Path, other: str) -> None:
    (folder / "half.h5").write_bytes((folder / "a.h5").read_bytes()[:5000])
    for files in (("a.h5", other), (other, "a.h5")):
        result = warpgran("compare", *files)
        assert result.exit_code == 2
        assert other in result.stderr
        assert not result.stdout
