"""A study computed into a file: killed, interrupted, resumed, in shards; nothing is lost, and no bit differs."""

from __future__ import annotations

import errno
import os
import random
import resource
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from helpers.cases import VIOLENT, small
from helpers.places import TESTS

import warpgran as wg
from warpgran.case.study import Study
from warpgran.files import StorageError
from warpgran.results.merging import merge
from warpgran.results.part_file import part_of
from warpgran.results.reading import reading
from warpgran.run import threads
from warpgran.run.options import Options
from warpgran.run.to_file import run_to_file
from warpgran.schema import Status

OVER = {"slope.angle": [0.0, 10.0, 20.0, 25.0], "column.phi": [0.55, 0.58, 0.62]}


def study(**changes: Any) -> Study:
    """Twelve runs."""
    return small(**{"time.series": {"every": 0.02}, **changes}).sweep(OVER)


def done(path: Path) -> xr.Dataset:
    """A result without what depends on when and how fast it was computed."""
    data = wg.open_dataset(path).load()
    for name in ("date", "history", "wall_seconds", "kernel_seconds", "threads", "run_file", "cell_steps"):
        data.attrs.pop(name)
    return data


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> xr.Dataset:
    path = tmp_path_factory.mktemp("whole") / "whole.h5"
    run_to_file(study(), path, Options(threads=1))
    return done(path)


@pytest.mark.slow
@pytest.mark.parametrize("threads", [1, 2, 5])
@pytest.mark.parametrize("cache", [1, 10**5, 10**9])
def test_blocks_and_threads_change_no_bit(
    tmp_path: Path, whole: xr.Dataset, monkeypatch: pytest.MonkeyPatch, threads: int, cache: int
) -> None:
    monkeypatch.setattr("warpgran.solve.blocks.CACHE", cache)
    run_to_file(study(), tmp_path / "out.h5", Options(threads=threads))
    xr.testing.assert_identical(done(tmp_path / "out.h5"), whole)


def test_the_order_of_runs_changes_no_bit(whole: xr.Dataset) -> None:
    order = [7, 2, 11, 0]
    shuffled = wg.simulate([study()[r] for r in order])
    for name in ("h", "v", "phi", "front", "energy", "steps"):
        np.testing.assert_array_equal(shuffled[name], whole[name][order])


def stopping_after(count: int) -> Any:
    """threads.compute, interrupted after so many runs."""

    def compute(sink: Any, options: Options, runs: Any, progress: Any) -> Any:
        outcome = threads.compute(sink, options, runs[:count], progress)
        outcome.interrupted = True
        return outcome

    return compute


def test_an_interrupted_study_goes_on(tmp_path: Path, whole: xr.Dataset) -> None:
    path = tmp_path / "out.h5"
    run_to_file(study(), path, Options(), compute=stopping_after(5))
    partial = wg.open_dataset(path)
    assert int((partial["status"] == Status.PENDING).sum()) == 7
    assert np.isnan(partial["h"][5:]).all()
    np.testing.assert_array_equal(partial["h"][:5], whole["h"][:5])
    computed: list[int] = []

    def counting(sink: Any, options: Options, runs: Any, progress: Any) -> Any:
        computed.extend(runs)
        return threads.compute(sink, options, runs, progress)

    run_to_file(study(), path, Options(), resume=True, compute=counting)
    assert computed == list(range(5, 12))
    xr.testing.assert_identical(done(path), whole)
    computed.clear()
    run_to_file(study(), path, Options(), resume=True, compute=counting)
    assert computed == []


RUN = """
import sys
import time
from contextlib import suppress
from pathlib import Path
sys.path.insert(0, {tests!r})
from run.test_to_file import Options, run_to_file, study
print("begins", flush=True)
run_to_file(study(**{changes!r}), Path({path!r}), Options(threads=2), resume=True)
"""
SLOW = {"grid.cells": 800}


def stored(path: Path) -> int:
    """Runs that are done in the part file; 0 where there is none (any more)."""
    with suppress(OSError, StorageError), reading(part_of(path)) as file:
        return int((file["status"][:] == Status.OK).sum())
    return 0


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="sends a POSIX signal")
def test_killed_again_and_again_it_loses_nothing(tmp_path: Path) -> None:
    path = tmp_path / "out.h5"
    run_to_file(study(**SLOW), tmp_path / "whole.h5", Options())
    code = RUN.format(tests=str(TESTS), changes=SLOW, path=str(path))
    rng = random.Random(3)
    counts: list[int] = []
    for attempt in range(6):
        enough = (counts[-1] if counts else 0) + rng.randrange(4)
        with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE) as process:
            assert process.stdout is not None and process.stdout.readline()
            while process.poll() is None and (attempt == 5 or stored(path) < enough):
                time.sleep(0.005)
            process.kill()
        code_ = process.returncode
        file = path if path.exists() else part_of(path)
        if not file.exists():
            continue  # killed before the file was made
        data = wg.open_dataset(file).load()  # readable at any moment
        counts.append(int((data["status"] == Status.OK).sum()))
        finished = data["h"].where(data["status"] == Status.OK, drop=True)
        assert np.isfinite(finished).all()
        if code_ == 0:
            break
    assert counts == sorted(counts)  # nothing is computed twice, nothing lost
    assert len(counts) > 1, counts
    xr.testing.assert_identical(done(path), done(tmp_path / "whole.h5"))
    assert sorted(file.name for file in tmp_path.iterdir()) == ["out.h5", "whole.h5"]


def test_an_earlier_start_is_not_thrown_away(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "out.h5"

    def failing(sink: Any, options: Options, runs: Any, progress: Any) -> Any:
        threads.compute(sink, options, runs[:3], progress)
        raise RuntimeError

    with pytest.raises(RuntimeError):
        run_to_file(study(), path, Options(), compute=failing)
    with pytest.raises(StorageError, match="holds 3 of 12 runs of an earlier start: --resume computes the others"):
        run_to_file(study(), path, Options())
    assert [file.name for file in tmp_path.iterdir()] == ["out.h5.part"]
    run_to_file(study(), path, Options(), resume=True)
    assert [file.name for file in tmp_path.iterdir()] == ["out.h5"]


@pytest.mark.parametrize(
    ("changes", "options", "words"),
    [
        ({"rheology.mu1": 0.4}, {}, r"rheology.mu1 \(0.48 there, 0.4 here\)"),
        ({"time.series": {"every": 0.01}}, {}, "time.series"),
        ({}, {"precision": "float32"}, r"precision \(float64 there, float32 here\)"),
        ({}, {"engine": "numpy"}, r"engine \(warp there, numpy here\)"),
        ({"slope.bed": {"x": [0, 1], "b": [0, 0.01]}}, {}, "slope.bed"),
    ],
)
def test_another_study_is_refused(tmp_path: Path, changes: Any, options: Any, words: str) -> None:
    path = tmp_path / "out.h5"
    run_to_file(study(), path, Options(), compute=stopping_after(2))
    before = path.read_bytes()
    with pytest.raises(StorageError, match=f"cannot go on with .*: it differs in .*{words}"):
        run_to_file(study(**changes), path, Options(**options), resume=True)
    assert path.read_bytes() == before
    assert [file.name for file in tmp_path.iterdir()] == ["out.h5"]


def test_other_values_of_the_sweep_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "out.h5"
    run_to_file(study(), path, Options(), compute=stopping_after(2))
    other = study().base.sweep({**OVER, "slope.angle": [0.0, 10.0, 20.0, 24.0]})
    with pytest.raises(StorageError, match=r"differs in slope\.angle"):
        run_to_file(other, path, Options(), resume=True)


def test_what_changes_no_result_does_not_matter(tmp_path: Path, whole: xr.Dataset) -> None:
    path = tmp_path / "out.h5"
    run_to_file(study(), path, Options(threads=1), compute=stopping_after(4))
    run_to_file(study(**{"scheme.window": False}), path, Options(threads=2), resume=True)
    np.testing.assert_array_equal(done(path)["h"], whole["h"])


def test_one_bad_run_in_the_middle(tmp_path: Path) -> None:
    cases = [small(), small(**VIOLENT), small(**{"slope.angle": 5.0})]
    outcome = run_to_file(Study.of(cases), tmp_path / "out.h5", Options())
    data = wg.open_dataset(tmp_path / "out.h5")
    assert list(data["status"]) == [Status.OK, Status.DIVERGED, Status.OK]
    assert list(outcome.failures) == [1]
    assert outcome.failures[1] == str(data["failure"][1].item())


def test_shards_merge_to_the_whole(tmp_path: Path, whole: xr.Dataset) -> None:
    shards = [tmp_path / f"{i}.h5" for i in range(3)]
    for i, path in enumerate(shards):
        run_to_file(study(), path, Options(), runs=list(range(i, 12, 3)))
    np.testing.assert_array_equal(wg.open_dataset(shards[1])["run"], [1, 4, 7, 10])
    assert merge(shards[::-1], tmp_path / "out.h5") == (12, [])
    merged = done(tmp_path / "out.h5")
    xr.testing.assert_identical(merged, whole)


def test_shards_of_other_studies_do_not_merge(tmp_path: Path) -> None:
    a, b = tmp_path / "a.h5", tmp_path / "b.h5"
    run_to_file(study(), a, Options(), runs=[0, 1])
    run_to_file(study(**{"rheology.mu1": 0.4}), b, Options(), runs=[2, 3])
    with pytest.raises(StorageError, match=r"b.h5 is not of the same study as .*a.h5: identity"):
        merge([a, b], tmp_path / "out.h5")
    with pytest.raises(StorageError, match="run 0 is in more than one file"):
        merge([a, a], tmp_path / "out.h5")
    assert not (tmp_path / "out.h5").exists()


def test_two_do_not_write_to_one_file(tmp_path: Path) -> None:
    def nested(sink: Any, options: Options, runs: Any, progress: Any) -> Any:
        with pytest.raises(StorageError, match="another process is writing it"):
            run_to_file(study(), tmp_path / "out.h5", Options(), resume=True)
        return threads.compute(sink, options, runs[:1], progress)

    run_to_file(study(), tmp_path / "out.h5", Options(), compute=nested)


def test_a_full_disk_is_told_and_the_file_can_go_on(
    tmp_path: Path, whole: xr.Dataset, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, left, pwrite = tmp_path / "out.h5", [60_000], os.pwrite

    def on_a_small_disk(fd: int, data: bytes, offset: int) -> int:
        if left[0] == 0:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        written = pwrite(fd, data[: left[0]], offset)
        left[0] -= written
        return written

    monkeypatch.setattr(os, "pwrite", on_a_small_disk)
    with pytest.raises(StorageError, match=r"cannot write .*out.h5.part: No space left on device"):
        run_to_file(study(), path, Options())
    assert [file.name for file in tmp_path.iterdir()] == ["out.h5.part"]
    some = int((wg.open_dataset(part_of(path)).load()["status"] == Status.OK).sum())
    assert 0 < some < 12
    monkeypatch.undo()
    run_to_file(study(), path, Options(), resume=True)
    xr.testing.assert_identical(done(path), whole)


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="limits the size of files by a POSIX call")
def test_no_room_to_begin_leaves_nothing(tmp_path: Path) -> None:
    code = RUN.format(tests=str(TESTS), changes={}, path=str(tmp_path / "out.h5"))

    def limited() -> None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))

    command = [sys.executable, "-c", code]
    failed = subprocess.run(command, capture_output=True, text=True, preexec_fn=limited, check=False)
    assert failed.returncode != 0
    assert "cannot write" in failed.stderr
    assert not list(tmp_path.iterdir())


def test_series_alone(tmp_path: Path, whole: xr.Dataset) -> None:
    path = tmp_path / "out.h5"
    run_to_file(study(**{"time.snapshots": []}), path, Options())
    data = wg.open_dataset(path)
    assert data.sizes["time"] == 0
    assert np.isfinite(data["front"]).all()


@pytest.mark.parametrize("memory", [1e4, 3e6])
def test_memory_bounds_what_is_computed_at_once(tmp_path: Path, whole: xr.Dataset, memory: float) -> None:
    if memory < 1e5:
        with pytest.raises(MemoryError, match=r"a run of .* cells, with its start on 4 times as many, takes"):
            run_to_file(study(), tmp_path / "out.h5", Options(memory=memory))
        assert not list(tmp_path.iterdir())
    else:
        run_to_file(study(), tmp_path / "out.h5", Options(memory=memory))
        xr.testing.assert_identical(done(tmp_path / "out.h5"), whole)
