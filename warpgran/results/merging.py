"""Shards of a study merged into one result file."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import NamedTuple

import h5py
import numpy as np

from warpgran.arrays import Array
from warpgran.files import StorageError, replacing
from warpgran.results.datasets import describe_as
from warpgran.results.layout import FAILURE, now
from warpgran.results.numbers import unspoiled
from warpgran.results.output import result_path
from warpgran.results.part_file import CHECKS, SPENT, Spent
from warpgran.results.reading import pending, reading
from warpgran.results.reserving import Reserve, bytes_of, reserving

SAME = (
    "identity", "precision", "engine", "warpgran_version", "warp_version", "schema_version", "run_file", "sensitivity",
)  # fmt: skip
"""Attributes that files of one study share; no file has "sensitivity" where they are no design."""


class Merged(NamedTuple):
    """What a merge made.

    Attributes:
        runs: In the file.
        missing: Numbers of the runs of the study that are not in it, or not computed.
    """

    runs: int
    missing: list[int]


def merge(shards: Sequence[Path], path: Path, *, force: bool = False) -> Merged:
    """Merge result files of one study, in the order of their runs.

    Args:
        shards: Files that `warpgran run --shard` wrote.
        path: The file to write. One that is there is replaced if it is of the same study and has no other run.
        force: Replace whatever is there, but no shard.

    Raises:
        StorageError: They are not of one study, share a run, or cannot be read; or the file cannot be written.
    """
    target = result_path(path, shards)
    with ExitStack() as stack, replacing(target) as part:
        files = [stack.enter_context(reading(shard)) for shard in shards]
        for shard, file in zip(shards, files, strict=True):
            if SPENT in file:
                raise StorageError(f"cannot merge {shard}: its runs are still being computed; go on with --resume")
            _check_same(shard, file, files[0], shards[0])
        runs = np.concatenate([file["run"][:] for file in files])
        if np.unique(runs).size != runs.size:
            raise StorageError(f"run {int(np.bincount(runs).argmax())} is in more than one file")
        if not force:
            _check_contained(target, files[0], runs)
        order = np.argsort(runs)
        status = np.concatenate([file["status"][:] for file in files])
        whole = int(files[0].attrs["study_runs"])
        with reserving(part) as (merged, reserve):
            _join(files, merged, reserve, order)
    return Merged(int(runs.size), sorted({*range(whole)} - {*runs[~pending(status)].tolist()}))


def _check_same(path: Path, file: h5py.File, other: h5py.File, name: Path) -> None:
    differs = [name for name in SAME if file.attrs.get(name) != other.attrs.get(name)]
    if differs:
        raise StorageError(f"{path} is not of the same study as {name}: {', '.join(differs)} differ")


def _check_contained(path: Path, file: h5py.File, runs: Array) -> None:
    """Check that a file that exists is of the same study as another, and that its runs are all among those given."""
    if not path.exists() or path.stat().st_size == 0:
        return
    try:
        with reading(path) as old:
            lost = np.setdiff1d(old["run"][:][~pending(old["status"][:])], runs).size
            _check_same(path, old, file, path)
    except StorageError:
        raise StorageError(
            f"cannot write {path}: it is there and is no result of this study; --force replaces it"
        ) from None
    if lost:
        raise StorageError(f"cannot write {path}: it has {lost} runs that these files have not; --force replaces it")


def _join(files: Sequence[h5py.File], target: h5py.File, reserve: Reserve, order: Array) -> None:
    """Copy all datasets, their attributes and scales; order: of the runs of all files, one file after another."""
    first = files[0]
    with unspoiled(Path(first.filename)):
        for data in first.values():
            dict(data.attrs)
    target.attrs.update(first.attrs)
    for name in Spent._fields:
        target.attrs[name] = sum(file.attrs[name] for file in files)
    target.attrs["history"] = f"{first.attrs['history']}\n{now()} merged from {len(files)} files by warpgran merge"
    for name in sorted({*first} - {CHECKS}, key=lambda name: (not first[name].is_scale, name)):
        describe_as(_joined(name, files, target, reserve, order), first[name])


def _joined(name: str, files: Sequence[h5py.File], target: h5py.File, reserve: Reserve, order: Array) -> h5py.Dataset:
    """A copy of a dataset of the first file, or of those of all files where it has a dimension of runs."""
    source = files[0][name]
    by_run = name == "run" or (not source.is_scale and source.dims[0][0].name == "/run")
    if not by_run:
        reserve(source.nbytes)
        return target.create_dataset(name, data=source[:])
    options = {key: getattr(source, key) for key in ("chunks", "compression", "compression_opts", "shuffle")}
    if source.chunks is None:  # given its place at once
        reserve(order.size * (bytes_of(source, 1) + FAILURE.itemsize))
    data = target.create_dataset(name, (order.size, *source.shape[1:]), source.dtype, **options)
    place = np.empty_like(order)
    place[order] = np.arange(order.size)
    at = 0
    for file in files:
        for row in range(file[name].shape[0]):
            with unspoiled(Path(file.filename)):
                values = file[name][row]
            if data.chunks is not None:
                reserve(bytes_of(data, 1))
            data[place[at]] = values
            at += 1
    return data
