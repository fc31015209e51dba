"""A full disk ends in an error with the file's name, at every size of the disk, and nothing that was stored is lost."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from helpers.cases import small
from helpers.small_disk import small_disk

import warpgran as wg
from warpgran.case.study import Study
from warpgran.files import StorageError
from warpgran.results.merging import merge
from warpgran.results.reserving import reserving
from warpgran.run.options import Options
from warpgran.run.to_file import run_to_file

QUICK = {"grid.cells": 40, "time.end": 0.02, "time.snapshots": [0.01, 0.02], "time.series": [0.0, 0.02]}


def study() -> Study:
    return small(**QUICK).sweep({"slope.angle": [0.0, 10.0, 20.0, 25.0]})


def full_after(monkeypatch: pytest.MonkeyPatch, calls: int) -> None:
    """A disk that gives space so many times."""
    given, allocate = [0], os.posix_fallocate

    def on_a_small_disk(descriptor: int, offset: int, size: int) -> None:
        given[0] += 1
        if given[0] > calls:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        allocate(descriptor, offset, size)

    monkeypatch.setattr(os, "posix_fallocate", on_a_small_disk)


def test_what_was_reserved_is_given_back(tmp_path: Path) -> None:
    numbers = np.arange(10**4)
    with reserving(tmp_path / "a.h5") as (file, reserve):
        reserve(10**7)
        assert (tmp_path / "a.h5").stat().st_size > 10**7
        file["a"] = numbers
    assert (tmp_path / "a.h5").stat().st_size < numbers.nbytes + 4096
    with h5py.File(tmp_path / "a.h5") as file:
        np.testing.assert_array_equal(file["a"], numbers)


def test_a_disk_without_room_for_the_study_is_told_before_computing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    full_after(monkeypatch, 1)

    def never(sink: Any, options: Options, runs: Any, progress: Any) -> Any:
        raise AssertionError

    with pytest.raises(StorageError, match=r"cannot write .*out\.h5\.part: No space left on device"):
        run_to_file(study(), tmp_path / "out.h5", Options(), compute=never)
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
@pytest.mark.parametrize("calls", [2, 3])
def test_a_disk_that_is_full_at_the_end_costs_no_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, calls: int
) -> None:
    path = tmp_path / "out.h5"
    monkeypatch.setattr("warpgran.results.reserving.SLACK", 1000)
    full_after(monkeypatch, calls)
    with pytest.raises(StorageError, match=r"cannot write .*out\.h5: No space left on device"):
        run_to_file(study(), path, Options())
    monkeypatch.undo()
    assert [file.name for file in tmp_path.iterdir()] == ["out.h5.part"]
    outcome = run_to_file(study(), path, Options(), resume=True)
    assert outcome.cell_steps == 0
    for name, values in wg.simulate(study()).data_vars.items():
        np.testing.assert_array_equal(wg.open_dataset(path)[name], values)


def test_a_merge_on_a_full_disk_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shards = [tmp_path / "a.h5", tmp_path / "b.h5"]
    for n, path in enumerate(shards):
        run_to_file(study(), path, Options(), runs=[n, n + 2])
    full_after(monkeypatch, 1)
    monkeypatch.setattr("warpgran.results.reserving.SLACK", 1000)
    with pytest.raises(StorageError, match=r"cannot write .*out\.h5: No space left on device"):
        merge(shards, tmp_path / "out.h5")
    assert sorted(tmp_path.iterdir()) == shards


WRITE = """
import sys, numpy as np
from pathlib import Path
from warpgran.results.reserving import bytes_of, reserving
try:
    with reserving(Path(sys.argv[1])) as (file, reserve):
        reserve(0)
        data = file.create_dataset("a", (64, 4, 512), "f8", chunks=(1, 4, 512), compression="gzip", shuffle=True)
        for row in range(64):
            reserve(bytes_of(data, 1))
            data[row] = np.random.default_rng(row).standard_normal((4, 512))
except OSError as error:
    sys.exit(error.errno)
"""


@pytest.mark.parametrize("size", [2**12, 2**17, 2**18, 5 * 2**16, 2**19, 2**20, 2**21])
def test_no_size_of_the_disk_ends_the_process(tmp_path: Path, size: int) -> None:
    try:
        with small_disk(tmp_path / "disk", size) as disk:
            ended = subprocess.run([sys.executable, "-c", WRITE, str(disk / "a.h5")], check=False).returncode
            sound = ended == 0 and h5py.is_hdf5(disk / "a.h5")
    except OSError:
        pytest.skip("no small disk can be mounted here")
    assert ended == (0 if size == 2**21 else errno.ENOSPC)
    assert sound == (ended == 0)
