"""`warpgran sensitivity`: a design computed, resumed, sharded and read again, and what is refused."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from typer.testing import CliRunner, Result

import warpgran as wg
from warpgran.cli.app import app

TEXT = """
title = "Small design"
[column]
height = 0.1
length = 0.1
[grid]
right = 0.6
cells = 160
[time]
end = 0.3
series = { every = 0.05 }
[sensitivity]
samples = 8
of = ["front@0.3", "h_max"]
[sensitivity.over]
rheology.K = { low = 0.0, high = 8.0 }
"slope.angle" = { low = 0.0, high = 20.0 }
"""
RUNS = 8 * 4


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which the design is computed."""
    folder = tmp_path_factory.mktemp("made")
    (folder / "a.toml").write_text(TEXT)
    assert warpgran("run", str(folder / "a.toml"), "-o", str(folder / "a.h5"), "--no-picture").exit_code == 0
    return folder


@pytest.fixture
def folder(made: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The working folder, with the run file and its result."""
    for name in ("a.toml", "a.h5"):
        shutil.copy(made / name, tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def warpgran(*arguments: str) -> Result:
    return CliRunner().invoke(app, arguments)


def names(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


def same_bits(path: str, other: str) -> None:
    a, b = wg.open_dataset(path), wg.open_dataset(other)
    for name in ("front", "h_max", "energy", "steps", "run", "rheology.K"):
        np.testing.assert_array_equal(a[name], b[name])


def test_a_design_is_computed_and_judged(folder: Path) -> None:
    result = warpgran("sensitivity", "a.toml", "-o", "b.h5")
    assert result.exit_code == 0, result.output
    made = {"b_indices.nc", "b_indices.csv", "b_indices.png", "b_main_effects.png", "b_over_time.png"}
    assert names(folder) == {"a.toml", "a.h5", "b.h5"} | made
    assert result.stderr == ""
    for words in ("Small design", "million cell-steps", "wrote b.h5", "front@0.3", "h_max, 0.3 s", "slope.angle",
                  "8 base samples, 32 runs", "0 to 20"):  # fmt: skip
        assert words in result.stdout
    assert all(name in result.stdout.splitlines()[-1] for name in made)
    same_bits("a.h5", "b.h5")
    data = wg.open_dataset("b.h5")
    assert data.sizes["run"] == RUNS
    assert data.sizes["time"] == 0
    with xr.open_dataset("b_indices.nc", engine="h5netcdf") as found:
        wanted = wg.indices(data)
        np.testing.assert_array_equal(found["total_order"], wanted["total_order"])
        assert f"{float(wanted['total_order'].sel(output='front@0.3', parameter='slope.angle')):.3f} [" in result.stdout


def test_a_result_is_judged_without_computing(folder: Path) -> None:
    before = (folder / "a.h5").read_bytes()
    result = warpgran("sensitivity", "a.h5", "--of", "v_flow,front@0.15", "--of", "h_max@0.3", "--format", "pdf")
    assert result.exit_code == 0, result.output
    assert (folder / "a.h5").read_bytes() == before
    assert "million" not in result.stdout
    assert "front@0.15" in result.stdout
    assert {"a_indices.pdf", "a_main_effects.pdf", "a_over_time.pdf"} <= names(folder)
    result = warpgran("sensitivity", "a.h5", "--no-picture")
    assert result.stdout.splitlines()[-1] == "wrote a_indices.nc and a_indices.csv"


def test_morris(folder: Path) -> None:
    result = warpgran("sensitivity", "a.toml", "--set", "sensitivity.method=morris", "-o", "m.h5")
    assert result.exit_code == 0, result.output
    assert "8 trajectories, 24 runs" in result.stdout
    assert "mu*" in result.stdout
    assert {"m_plane.png", "m_over_time.png", "m_indices.csv"} <= names(folder)


def test_shards_are_merged_to_the_same_bits(folder: Path) -> None:
    for shard in ("1/3", "2/3", "3/3"):
        result = warpgran("sensitivity", "a.toml", "--shard", shard)
        assert result.exit_code == 0, result.output
        assert "merge all shards" in result.stdout
    shards = [f"a.{n}-of-3.h5" for n in (1, 2, 3)]
    result = warpgran("sensitivity", shards[0])
    assert result.exit_code == 2
    assert "has 11 of the 32 runs of its design; allowed: all, so merge its shards" in result.stderr
    assert warpgran("merge", "merged.h5", *shards).exit_code == 0
    same_bits("merged.h5", "a.h5")
    assert warpgran("sensitivity", "merged.h5", "--no-picture").exit_code == 0
    assert warpgran("sensitivity", "a.h5", "--no-picture").exit_code == 0
    assert (folder / "merged_indices.csv").read_bytes() == (folder / "a_indices.csv").read_bytes()


@pytest.mark.slow
def test_a_cluster_computes_the_same_bits(folder: Path) -> None:
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(n_workers=1, threads_per_worker=1, host="127.0.0.1", dashboard_address=":0") as local:
        result = warpgran("sensitivity", "a.toml", "-o", "b.h5", "--cluster", local.scheduler_address, "--no-picture")
    assert result.exit_code == 0, result.output
    same_bits("a.h5", "b.h5")


def test_shards_of_other_designs_are_not_merged(folder: Path) -> None:
    for shard, change in (("1/2", "seed=1"), ("2/2", "seed=2")):
        warpgran("sensitivity", "a.toml", "--shard", shard, "--set", f"sensitivity.{change}")
    result = warpgran("merge", "merged.h5", "a.1-of-2.h5", "a.2-of-2.h5")
    assert result.exit_code == 2
    assert "sensitivity" in result.stderr


def test_a_killed_study_is_resumed_to_the_same_bits(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from warpgran.results.part_file import PartFile

    put, calls = PartFile.put, iter(range(10**6))

    def dying(self: PartFile, *arguments: object) -> None:
        if next(calls) == 1:
            raise KeyboardInterrupt  # as if killed between two blocks
        put(self, *arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(PartFile, "put", dying)
    options = ("sensitivity", "a.toml", "-o", "b.h5", "--threads", "4")
    assert warpgran(*options).exit_code != 0
    monkeypatch.undo()
    monkeypatch.chdir(folder)
    assert "b.h5.part" in names(folder)
    result = warpgran("sensitivity", "b.h5.part")
    assert result.exit_code == 2
    assert warpgran(*options, "--resume").exit_code == 0
    same_bits("a.h5", "b.h5")


def test_files_of_others_are_kept(folder: Path) -> None:
    for name in ("a_indices.nc", "a_indices.csv", "a_over_time.png"):
        other = folder / name
        other.write_text("mine")
        result = warpgran("sensitivity", "a.h5")
        assert result.exit_code == 2
        assert f"cannot write {name}: what is there was not written by warpgran" in result.stderr
        assert other.read_text() == "mine"
        other.unlink()
    assert warpgran("sensitivity", "a.h5").exit_code == 0
    assert warpgran("sensitivity", "a.h5").exit_code == 0  # over its own
    (folder / "b_plane.png").write_text("mine")
    result = warpgran("sensitivity", "a.toml", "-o", "b.h5")  # before anything is computed
    assert result.exit_code == 2
    assert "b.h5" not in names(folder)


def test_overrides_go_with_the_file(folder: Path) -> None:
    result = warpgran("sensitivity", "a.toml", "--set", "sensitivity.samples=4", "--set", "sensitivity.of=['front']",
                      "-o", "b.h5", "--no-picture")  # fmt: skip
    assert result.exit_code == 0, result.output
    result = warpgran("sensitivity", "b.h5", "--no-picture")
    assert result.exit_code == 0, result.output
    assert "4 base samples, 16 runs" in result.stdout


def test_runs_that_cannot_be_used(folder: Path) -> None:
    asked = ("sensitivity", "a.toml", "-o", "b.h5", "--set", "grid.right=0.02", "--no-picture")
    result = warpgran(*asked)
    assert result.exit_code == 2
    assert "wrote b.h5" in result.stdout
    assert "of 32 runs cannot be used, which concerns" in result.stderr
    assert "lost solid through an end of the grid (make it longer): " in result.stderr
    assert "--drop-failed" in result.stderr


def test_check_says_how_many_runs_a_design_has(folder: Path) -> None:
    result = warpgran("check", "a.toml")
    assert "32 runs over rheology.K, slope.angle" in result.stdout
    assert "0 snapshots" in result.stdout


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("absent.toml",), "absent.toml"),
        (("absent.h5",), "there is no such file"),
        (("plain.toml",), "plain.toml: has no section [sensitivity]; allowed: a run file that has, or its result"),
        (("a.h5", "--set", "slope.angle=3"), "--set: has no part with a result file"),
        (("a.h5", "--resume"), "--resume: has no part with a result file"),
        (("a.h5", "--shard", "1/2"), "--shard: has no part with a result file"),
        (("a.h5", "--threads", "2"), "--threads: has no part with a result file"),
        (("a.h5", "--precision", "float32"), "--precision: has no part with a result file"),
        (("a.h5", "--of", ","), "of: asks for nothing"),
        (("a.h5", "--of", "runout"), "did you mean run_out?"),
        (("a.h5", "--of", "front@0.17"), "the nearest are 0.15 and 0.2"),
        (("a.h5", "--of", "run_out"), "had not stopped: no run_out yet (make time.end later"),
        (("a.toml", "--set", "sensitivity.samples=7"), "7 is no power of 2"),
        (("a.toml", "--set", "slope.angle=7"), "the design varies it"),
        (("a.toml", "--device", "cuda:7"), "is not on this machine"),
        (("a.toml", "--shard", "9/2"), "'9/2' is not a shard"),
    ],
)
def test_bad_input_is_refused_in_a_line(folder: Path, arguments: tuple[str, ...], words: str) -> None:
    (folder / "plain.toml").write_text("")
    before = names(folder)
    result = warpgran("sensitivity", *arguments)
    assert result.exit_code == 2, result.output
    assert words in result.stderr
    assert names(folder) == before
