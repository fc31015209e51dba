"""Nothing that is not this study's is overwritten unasked, and nothing of it is lost."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from helpers.cases import small
from typer.testing import CliRunner

import warpgran as wg
from warpgran.case.read_study import read_study
from warpgran.case.study import Study
from warpgran.cli.app import app
from warpgran.files import StorageError
from warpgran.results.layout import Layout
from warpgran.results.merging import merge
from warpgran.results.part_file import part_of
from warpgran.run import threads
from warpgran.run.options import Options
from warpgran.run.outcome import Outcome, attributes
from warpgran.run.resume import check_same
from warpgran.run.to_file import bring_up_to_date, run_to_file
from warpgran.schema import Status

QUICK = {"grid.cells": 40, "time.end": 0.02, "time.snapshots": [0.02], "time.series": [0.0, 0.02]}


def study(**changes: Any) -> Study:
    """Four runs of a moment."""
    return small(**{**QUICK, **changes}).sweep({"slope.angle": [0.0, 10.0, 20.0, 25.0]})


def killed(sink: Any, options: Options, runs: Any, progress: Any) -> Outcome:
    """threads.compute that ends in a defect after three runs."""
    threads.compute(sink, options, runs[:3], progress)
    raise RuntimeError


def interrupted(sink: Any, options: Options, runs: Any, progress: Any) -> Outcome:
    """threads.compute, interrupted after three runs."""
    outcome = threads.compute(sink, options, runs[:3], progress)
    outcome.interrupted = True
    return outcome


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "out.h5"


def test_the_same_study_is_computed_again(path: Path) -> None:
    run_to_file(study(), path, Options())
    computed: list[int] = []

    def compute(sink: Any, options: Options, runs: Any, progress: Any) -> Outcome:
        computed.extend(runs)
        return threads.compute(sink, options, runs, progress)

    run_to_file(study(), path, Options(), compute=compute)
    assert computed == [0, 1, 2, 3]


@pytest.mark.parametrize(
    ("changes", "options", "words"),
    [
        ({"rheology.mu1": 0.4}, {}, r"differs in rheology.mu1 \(0.48 there, 0.4 here\); --force replaces it"),
        ({}, {"precision": "float32"}, r"precision \(float64 there, float32 here\)"),
    ],
)
def test_another_result_is_replaced_when_asked(path: Path, changes: Any, options: Any, words: str) -> None:
    run_to_file(study(), path, Options())
    before = path.read_bytes()
    with pytest.raises(StorageError, match=words):
        run_to_file(study(**changes), path, Options(**options))
    assert path.read_bytes() == before
    assert [file.name for file in path.parent.iterdir()] == ["out.h5"]
    run_to_file(study(**changes), path, Options(**options), force=True)
    data = wg.open_dataset(path)
    assert data.attrs["precision"] == options.get("precision", "float64")
    assert ("mu1 = 0.4\n" in data.attrs["case_toml"]) == ("rheology.mu1" in changes)


@pytest.mark.parametrize(
    ("there", "here", "same"), [("cpu", "cpu,cpu", True), ("cuda:1", "cuda:0,cuda:1", True), ("cpu", "cuda:0", False)]
)
def test_a_study_goes_on_where_the_device_is_of_the_same_kind(path: Path, there: str, here: str, same: bool) -> None:
    run_to_file(study(), path, Options())
    with h5py.File(path, "r+") as file:
        file.attrs["device"] = there
    layout = Layout(study())
    facts = layout.attributes(**attributes(Options(), Outcome()) | {"device": here})
    if same:
        check_same(path, layout, facts)
    else:
        with pytest.raises(StorageError, match=r"differs in device \(cpu there, cuda:0 here\)"):
            check_same(path, layout, facts)


def test_what_is_no_result_is_replaced_when_asked(path: Path) -> None:
    path.write_text("a thesis")
    for compute in (run_to_file, bring_up_to_date):
        with pytest.raises(StorageError, match=r"out\.h5 is damaged, or no result"):
            compute(study(), path, Options())
    assert path.read_text() == "a thesis"
    run_to_file(study(), path, Options(), force=True)
    assert len(wg.open_dataset(path)["run"]) == 4


def test_an_empty_file_holds_nothing_to_lose(path: Path) -> None:
    path.touch()
    run_to_file(study(), path, Options())
    assert len(wg.open_dataset(path)["run"]) == 4


def test_an_interrupted_study_is_not_begun_anew_unasked(path: Path) -> None:
    run_to_file(study(), path, Options(), compute=interrupted)
    with pytest.raises(StorageError, match=r"holds 3 of 4 runs .*: --resume computes the others, --force all"):
        run_to_file(study(), path, Options())
    run_to_file(study(), path, Options(), force=True)
    assert (wg.open_dataset(path)["status"] == Status.OK).all()


def test_a_killed_study_is_not_begun_anew_unasked(path: Path) -> None:
    with pytest.raises(RuntimeError):
        run_to_file(study(), path, Options(), compute=killed)
    with pytest.raises(StorageError, match=r"out\.h5\.part holds 3 of 4 runs"):
        run_to_file(study(), path, Options())
    with pytest.raises(StorageError, match=r"out\.h5\.part is of another study"):
        run_to_file(study(**{"rheology.mu1": 0.4}), path, Options())
    run_to_file(study(), path, Options(), force=True)
    assert not part_of(path).exists()


def test_an_interruption_leaves_a_complete_file(path: Path) -> None:
    run_to_file(study(), path, Options())
    before = path.read_bytes()
    assert run_to_file(study(), path, Options(), compute=interrupted).interrupted
    assert path.read_bytes() == before
    assert [file.name for file in path.parent.iterdir()] == ["out.h5"]


def test_force_and_resume_exclude_each_other(path: Path) -> None:
    with pytest.raises(wg.OptionError, match="force"):
        run_to_file(study(), path, Options(), force=True, resume=True)


@pytest.mark.parametrize("name", ["out.png", "out.PDF", "out.svg", "out.gif", "out.toml", "out.csv"])
def test_the_suffix_of_something_else(tmp_path: Path, name: str) -> None:
    with pytest.raises(StorageError, match=r"allowed: a name such as out\.h5"):
        run_to_file(study(), tmp_path / name, Options(), force=True)
    assert not list(tmp_path.iterdir())


def test_what_the_study_reads_is_never_replaced(tmp_path: Path) -> None:
    (tmp_path / "run").write_text('[slope]\nbed = "bed"\n[sweep]\nfrom = "samples"\n')
    (tmp_path / "bed").write_text("x,b\n0,0\n1,0.01\n")
    (tmp_path / "samples").write_text("slope.angle\n5\n6\n")
    (tmp_path / "link").symlink_to("bed")
    read = read_study(tmp_path / "run")
    for name in ("run", "bed", "samples", "link"):
        with pytest.raises(StorageError, match="it is read to compute the result"):
            run_to_file(read, tmp_path / name, Options(), force=True)


def test_a_link_is_followed_and_what_it_leads_to_replaced(tmp_path: Path) -> None:
    (tmp_path / "there").mkdir()
    (tmp_path / "out.h5").symlink_to(tmp_path / "there" / "data.h5")
    for _ in range(2):
        run_to_file(study(), tmp_path / "out.h5", Options())
    assert (tmp_path / "out.h5").is_symlink()
    assert [file.name for file in (tmp_path / "there").iterdir()] == ["data.h5"]
    assert len(wg.open_dataset(tmp_path / "out.h5")["run"]) == 4


def sums(path: Path) -> dict[str, float]:
    with h5py.File(path) as file:
        return {name: file.attrs[name] for name in ("cell_steps", "kernel_seconds", "wall_seconds")}


@pytest.mark.parametrize("first", [interrupted, killed])
def test_what_was_spent_is_that_of_all_sessions(path: Path, first: Any) -> None:
    run_to_file(study(), path, Options(threads=1))
    whole = sums(path)
    path.unlink()
    try:
        run_to_file(study(), path, Options(threads=1), compute=first)
    except RuntimeError:
        with h5py.File(part_of(path)) as file:
            before = dict(zip(whole, file["checks/spent"][:], strict=True))
    else:
        before = sums(path)
    assert 0 < before["cell_steps"] < whole["cell_steps"]
    assert 0.0 < before["kernel_seconds"] <= before["wall_seconds"]
    outcome = run_to_file(study(), path, Options(threads=1), resume=True)
    after = sums(path)
    assert after["cell_steps"] == whole["cell_steps"] == before["cell_steps"] + outcome.cell_steps
    assert after["kernel_seconds"] == before["kernel_seconds"] + outcome.kernel_seconds
    assert after["wall_seconds"] == before["wall_seconds"] + outcome.wall_seconds


def column(path: Path, name: str) -> tuple[int, int]:
    """Where in the file an array begins, and the bytes of a run."""
    with h5py.File(path) as file:
        data = file[name]
        return data.id.get_offset(), data.dtype.itemsize * int(np.prod(data.shape[1:]))


@pytest.mark.parametrize("name", ["h", "steps", "checks/rows", "status"])
def test_runs_that_are_spoiled_are_computed_again(path: Path, name: str) -> None:
    run_to_file(study(), path, Options(threads=1))
    whole = wg.open_dataset(path).load()
    path.unlink()
    with pytest.raises(RuntimeError):
        run_to_file(study(), path, Options(threads=1), compute=killed)
    offset, size = column(part_of(path), name)
    data = bytearray(part_of(path).read_bytes())
    data[offset + size] ^= 4  # in the row of run 1; the status becomes step_limit's successor, an unknown one
    part_of(path).write_bytes(data)
    outcome = run_to_file(study(), path, Options(threads=1), resume=True)
    assert outcome.spoiled == 1
    resumed = wg.open_dataset(path).load()
    for variable in whole.data_vars:
        np.testing.assert_array_equal(resumed[variable], whole[variable])


@pytest.mark.parametrize("name", ["front", "steps", "status", "checks/rows"])
def test_runs_that_are_spoiled_in_an_interrupted_file_are_computed_again(path: Path, name: str) -> None:
    run_to_file(study(), path, Options(threads=1))
    whole = wg.open_dataset(path).load()
    path.unlink()
    run_to_file(study(), path, Options(threads=1), compute=interrupted)
    with h5py.File(path) as file:
        offset, size = file[name].id.get_offset(), file[name].nbytes // 4
    data = bytearray(path.read_bytes())
    data[offset + size] ^= 2  # in the row of run 1; the status becomes step_limit
    path.write_bytes(data)
    outcome = run_to_file(study(), path, Options(threads=1), resume=True)
    assert outcome.spoiled == 1
    resumed = wg.open_dataset(path).load()
    for variable in whole.data_vars:
        np.testing.assert_array_equal(resumed[variable], whole[variable])
    with h5py.File(path) as file:
        assert "checks" not in file


def test_a_structure_that_is_spoiled_is_refused(path: Path) -> None:
    with pytest.raises(RuntimeError):
        run_to_file(study(), path, Options(), compute=killed)
    part = part_of(path)
    data = part.read_bytes()
    at = data.index(b"distance along the slope")
    part.write_bytes(data[:at] + b"D" + data[at + 1 :])
    with pytest.raises(StorageError, match=r"cannot go on with .*out\.h5\.part: it is damaged"):
        run_to_file(study(), path, Options(), resume=True)
    run_to_file(study(), path, Options(), force=True)


def test_a_merge_says_which_runs_are_missing_and_replaces_what_it_holds(tmp_path: Path) -> None:
    shards = [tmp_path / f"{n}.h5" for n in range(4)]
    for n, shard in enumerate(shards):
        run_to_file(study(), shard, Options(), runs=[n])
    out = tmp_path / "out.h5"
    assert merge([shards[0], shards[2]], out) == (2, [1, 3])
    assert merge(shards, out) == (4, [])
    with pytest.raises(StorageError, match="it has 3 runs that these files have not; --force replaces it"):
        merge(shards[:1], out)
    assert merge(shards[:1], out, force=True) == (1, [1, 2, 3])
    with pytest.raises(StorageError, match="it is read to compute the result"):
        merge(shards, shards[0], force=True)
    with pytest.raises(StorageError, match="it has 1 runs that these files have not"):
        merge(shards[1:], shards[0])  # the output was forgotten
    (tmp_path / "note").write_text("a note")
    with pytest.raises(StorageError, match="is no result of this study"):
        merge(shards, tmp_path / "note")


def test_the_command_merge_exits_with_1_where_runs_are_missing(tmp_path: Path) -> None:
    shard, out = tmp_path / "a.h5", tmp_path / "out.h5"
    run_to_file(study(), shard, Options(), runs=[0, 1], compute=interrupted_at_once)
    result = CliRunner().invoke(app, ["merge", str(out), str(shard)])
    assert result.exit_code == 1
    assert "3 runs of the study are missing: 1, 2, 3" in result.stderr


def interrupted_at_once(sink: Any, options: Options, runs: Any, progress: Any) -> Outcome:
    """threads.compute, interrupted after a run."""
    outcome = threads.compute(sink, options, runs[:1], progress)
    outcome.interrupted = True
    return outcome
