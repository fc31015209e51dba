"""Shards of a study merged into one result file."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

import h5py
import numpy as np

from warpgran.files import StorageError, check_readable, replacing
from warpgran.results.datasets import describe_as
from warpgran.results.layout import now
from warpgran.results.part_file import CHECKS, Spent
from warpgran.results.reading import check_schema

SAME = (
    "identity", "precision", "engine", "warpgran_version", "warp_version", "schema_version", "run_file", "sensitivity",
)  # fmt: skip
"""Attributes that files of one study share; no file has "sensitivity" where they are no design."""


def merge(shards: Sequence[Path], path: Path) -> int:
    """Merge result files of one study, in the order of their runs.

    Args:
        shards: Files that `warpgran run --shard` wrote.
        path: The file to write.

    Returns:
        The number of runs.

    Raises:
        StorageError: They are not of one study, share a run, or cannot be read; or the file cannot be written.
    """
    with ExitStack() as stack, replacing(path) as part:
        files = [stack.enter_context(_opened(shard)) for shard in shards]
        for shard, file in zip(shards[1:], files[1:], strict=True):
            differs = [name for name in SAME if file.attrs.get(name) != files[0].attrs.get(name)]
            if differs:
                raise StorageError(f"{shard} is not of the same study as {shards[0]}: {', '.join(differs)} differ")
        runs = np.concatenate([file["run"][:] for file in files])
        if np.unique(runs).size != runs.size:
            raise StorageError(f"run {int(np.bincount(runs).argmax())} is in more than one file")
        order = np.argsort(runs)
        with h5py.File(part, "w") as target:
            _join(files, target, order)
    return int(runs.size)


def _opened(path: Path) -> h5py.File:
    check_readable(path)
    try:
        file = h5py.File(path, "r")
    except OSError as error:
        raise StorageError(f"cannot read {path}: {error}") from None
    try:
        check_schema(path, file.attrs)
        if CHECKS in file:
            raise StorageError(f"cannot merge {path}: its runs are still being computed; go on with --resume")
    except StorageError:
        file.close()
        raise
    return file


def _join(files: Sequence[h5py.File], target: h5py.File, order: np.ndarray) -> None:
    """Copy all datasets, their attributes and scales; order: of the runs of all files, one file after another."""
    first = files[0]
    target.attrs.update(first.attrs)
    for name in Spent._fields:
        target.attrs[name] = sum(file.attrs[name] for file in files)
    target.attrs["history"] = f"{first.attrs['history']}\n{now()} merged from {len(files)} files by warpgran merge"
    for name in sorted(first, key=lambda name: not first[name].is_scale):
        describe_as(_joined(name, files, target, order), first[name])


def _joined(name: str, files: Sequence[h5py.File], target: h5py.File, order: np.ndarray) -> h5py.Dataset:
    """A copy of a dataset of the first file, or of those of all files where it has a dimension of runs."""
    source = files[0][name]
    by_run = name == "run" or (not source.is_scale and source.dims[0][0].name == "/run")
    if not by_run:
        return target.create_dataset(name, data=source[:])
    options = {key: getattr(source, key) for key in ("chunks", "compression", "compression_opts", "shuffle")}
    data = target.create_dataset(name, (order.size, *source.shape[1:]), source.dtype, **options)
    place = np.empty_like(order)
    place[order] = np.arange(order.size)
    at = 0
    for file in files:
        for row in range(file[name].shape[0]):
            data[place[at]] = file[name][row]
            at += 1
    return data
