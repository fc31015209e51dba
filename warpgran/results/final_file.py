"""The finished result file: all runs of a part file, the profiles compressed and in chunks of a run."""

from __future__ import annotations

import math
from typing import Any

import h5py
import numpy as np

from warpgran.arrays import Array
from warpgran.results.datasets import bytes_of_shared, describe, write_shared
from warpgran.results.layout import Layout, status_attributes
from warpgran.results.reserving import Reserve, bytes_of
from warpgran.schema import Status

CHUNK = 2**20
"""Most bytes of a chunk, about."""


def write_compressed(
    source: h5py.File, target: h5py.File, layout: Layout, status: Array, reserve: Reserve = lambda size: None
) -> None:
    """Copy all runs; what was not computed becomes NaN. Space is reserved for each piece before it is written."""
    reserve(bytes_of_shared(layout))
    write_shared(target, layout)
    done = status != Status.PENDING
    for name, column in layout.columns.items():
        shape = (layout.runs.size, *column.shape)
        if name == "failure":
            reserve(2 * source[name].nbytes)
            words = np.where(done, source[name][:], b"").astype(str).astype(object)
            data = target.create_dataset(name, data=words, dtype=h5py.string_dtype())
        elif column.shape and np.prod(shape) > 0:
            # A series is read by run as it is; it would shrink by a fifth and take as much time as all profiles.
            packing = _packing(column.shape) if len(column.shape) > 1 else {}
            data = target.create_dataset(name, shape, column.dtype, **packing)
            _copy_runs(source[name], data, done, reserve)
        else:
            reserve(source[name].nbytes)
            values = source[name][:]
            if column.dtype.kind == "f":
                values = np.where(done.reshape(-1, *[1] * len(column.shape)), values, np.nan)
            data = target.create_dataset(name, data=values, dtype=column.dtype)
        describe(data, column.schema, layout.coordinates(name))
    target["status"].attrs.update(status_attributes())


def _copy_runs(source: h5py.Dataset, target: h5py.Dataset, done: Array, reserve: Reserve) -> None:
    """Copy run by run in pieces of some megabytes, so that memory stays bounded."""
    step = max(1, 2**25 // max(1, source.dtype.itemsize * int(np.prod(source.shape[1:]))))
    for first in range(0, source.shape[0], step):
        values = source[first : first + step]
        values[~done[first : first + step]] = np.nan
        reserve(bytes_of(target, len(values)))
        target[first : first + step] = values


def _packing(shape: tuple[int, ...]) -> dict[str, Any]:
    """Compression of profiles, in chunks of one run, or of a part of it where a run is large."""
    rest = [int(n) for n in shape]
    while 8 * math.prod(rest) > CHUNK and max(rest) > 1:
        longest = rest.index(max(rest)) if rest[0] == 1 else 0  # snapshots apart before cells apart
        rest[longest] = -(-rest[longest] // 2)
    chunks = (1, *(max(1, n) for n in rest))
    return {"chunks": chunks, "compression": "gzip", "compression_opts": 1, "shuffle": True}
