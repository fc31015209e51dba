"""Result files: HDF5 with dimension scales, so that h5py, xarray, netCDF4 and MATLAB read them.

While a study runs, its file is `NAME.part`: HDF5 whose structure is complete before the first run, every array at its
final size and place. Runs then only write their numbers into those places, past the HDF5 library, and their status
last; nothing else of the file is ever touched. Killed at any moment, it is therefore a sound file, which `--resume`
goes on with. Once all is there it is copied to the final name, the profiles compressed and in chunks of a run.
"""

from __future__ import annotations

import fcntl
import math
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from warpgran.arrays import Array
from warpgran.files import StorageError, check_writable, replacing
from warpgran.results.layout import Layout, status_attributes
from warpgran.results.reading import pending, reading
from warpgran.schema import PARAMETERS, SERIES, Status, Variable

STATUS_TYPE = h5py.enum_dtype({s.word: int(s) for s in Status}, basetype="i1")
CHUNK = 2**20
"""Most bytes of a chunk, about."""


def part_of(path: Path) -> Path:
    """The file that a study writes to while it runs.

    Raises:
        StorageError: `path` is a folder.
    """
    if path.is_dir():
        raise StorageError(f"cannot write {path}: it is a folder")
    return path.with_name(path.name + ".part")


class PartFile:
    """The file of a running study. A context manager: it holds a lock, so that two do not write to one file.

    Attributes:
        path: Where it is.
        status: Of each run, as in the file.
    """

    def __init__(self, path: Path, layout: Layout, attributes: Mapping[str, Any] | None = None) -> None:
        """Open a part file, or make it if there are attributes to make it with.

        Raises:
            StorageError: It cannot be written, or another process is writing it.
        """
        self.path, self.layout = path, layout
        self._new = path.with_name(f".{path.name}.new")  # one name: what a killed start leaves, the next writes over
        if attributes is not None:
            check_writable(path, self._new)
        self._lock = _Lock(path)
        if attributes is not None:
            try:
                with replacing(path, self._new), _telling(path):
                    _create(self._new, layout, attributes)
            except StorageError:
                self._lock.release()
                raise
        self._fd = os.open(path, os.O_RDWR)
        with reading(path) as file:
            self._offset = {name: file[_place(name)].id.get_offset() for name in layout.columns}
            self.status: Array = file["status"][:]

    def __enter__(self) -> PartFile:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def close(self) -> None:
        """Let go of the file."""
        os.close(self._fd)
        self._lock.release()

    def put(self, at: Sequence[int], rows: Mapping[str, Array]) -> None:
        """Store rows of `Layout.rows` at these places; the status last, which makes them count.

        Raises:
            StorageError: The disk is full, for instance. What was stored before is sound.
        """
        names = sorted(self.layout.columns, key=lambda name: name == "status")
        columns = [np.ascontiguousarray(rows[name], dtype=self.layout.columns[name].dtype) for name in names]
        with _telling(self.path):
            for n, place in enumerate(at):
                for name, values in zip(names, columns, strict=True):
                    row = values[n : n + 1]
                    if row.nbytes:
                        _write_all(self._fd, row.tobytes(), self._offset[name] + place * row.nbytes)
                self.status[place] = rows["status"][n]

    def finish(self, path: Path, attributes: Mapping[str, Any]) -> None:
        """Copy to the final file, compressed and in chunks of a run, and remove this one.

        Raises:
            StorageError: The disk is full, for instance. This file is still there then.
        """
        with replacing(path, self._new) as final, _telling(path):
            with reading(self.path) as source, h5py.File(final, "w") as target:
                _compressed(source, target, self.layout, self.status)
                target.attrs.update({**source.attrs, **attributes})
        self.path.unlink()


def copy_done(path: Path, part: PartFile) -> None:
    """Take over the runs of a finished file that need not be computed again."""
    with _telling(part.path), reading(path) as file:
        status = file["status"][:]
        for place in np.flatnonzero(~pending(status)):
            rows = {name: file[_place(name)][place] for name in part.layout.columns}
            part.put([int(place)], {name: np.asarray(value)[None] for name, value in rows.items()})


class _Lock:
    """Held by the process that writes a file: a lock on a file of its own, as HDF5 locks the file itself to read it."""

    def __init__(self, path: Path) -> None:
        self._path = path.with_name(path.name + ".lock")
        self._fd = os.open(self._path, os.O_RDWR | os.O_CREAT)
        try:
            fcntl.flock(self._fd, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            os.close(self._fd)
            raise StorageError(f"cannot write {path}: another process is writing it") from None

    def release(self) -> None:
        self._path.unlink(missing_ok=True)
        os.close(self._fd)


def _create(path: Path, layout: Layout, attributes: Mapping[str, Any]) -> None:
    with h5py.File(path, "w", locking=False) as file:
        file.attrs.update(attributes)
        _write_shared(file, layout)
        for name, column in layout.columns.items():
            shape, dtype = (layout.runs.size, *column.shape), STATUS_TYPE if name == "status" else column.dtype
            _describe(file, name, _reserved(file, _place(name), shape, dtype), column.schema)
        file["status"][:] = np.full(layout.runs.size, Status.PENDING, dtype=np.int8)
        file["status"].attrs.update(status_attributes())


def _reserved(file: h5py.File, name: str, shape: tuple[int, ...], dtype: Any) -> h5py.Dataset:
    """A dataset in one piece, whose place in the file is settled now and whose numbers are not written."""
    how = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    how.set_layout(h5py.h5d.CONTIGUOUS)
    how.set_alloc_time(h5py.h5d.ALLOC_TIME_EARLY)
    how.set_fill_time(h5py.h5d.FILL_TIME_NEVER)
    link = h5py.h5p.create(h5py.h5p.LINK_CREATE)
    link.set_create_intermediate_group(True)
    kind, size = h5py.h5t.py_create(dtype, logical=True), h5py.h5s.create_simple(shape)
    return h5py.Dataset(h5py.h5d.create(file.id, name.encode(), kind, size, how, link))


def _compressed(source: h5py.File, target: h5py.File, layout: Layout, status: Array) -> None:
    """Copy all runs; what was not computed becomes NaN."""
    _write_shared(target, layout)
    done = status != Status.PENDING
    for name, column in layout.columns.items():
        shape = (layout.runs.size, *column.shape)
        if name == "failure":
            words = np.where(done, source[name][:], b"").astype(str).astype(object)
            data = target.create_dataset(name, data=words, dtype=h5py.string_dtype())
        elif column.shape and np.prod(shape) > 0:
            # A series is read by run as it is; it would shrink by a fifth and take as much time as all profiles.
            packing = _packing(column.shape) if len(column.shape) > 1 else {}
            data = target.create_dataset(_place(name), shape, column.dtype, **packing)
            _copy_runs(source[_place(name)], data, done)
        else:
            values = source[_place(name)][:]
            if column.dtype.kind == "f":
                values = np.where(done.reshape(-1, *[1] * len(column.shape)), values, np.nan)
            dtype = STATUS_TYPE if name == "status" else column.dtype
            data = target.create_dataset(_place(name), data=values, dtype=dtype)
        _describe(target, name, data, column.schema)
    target["status"].attrs.update(status_attributes())


def _copy_runs(source: h5py.Dataset, target: h5py.Dataset, done: Array) -> None:
    """Copy run by run in pieces of some megabytes, so that memory stays bounded."""
    step = max(1, 2**25 // max(1, source.dtype.itemsize * int(np.prod(source.shape[1:]))))
    for first in range(0, source.shape[0], step):
        values = source[first : first + step]
        values[~done[first : first + step]] = np.nan
        target[first : first + step] = values


def _packing(shape: tuple[int, ...]) -> dict[str, Any]:
    """Compression of profiles, in chunks of one run, or less of it where that is much."""
    rest = [int(n) for n in shape]
    while 8 * math.prod(rest) > CHUNK and max(rest) > 1:
        longest = rest.index(max(rest)) if rest[0] == 1 else 0  # snapshots apart before cells apart
        rest[longest] = -(-rest[longest] // 2)
    chunks = (1, *(max(1, n) for n in rest))
    return {"chunks": chunks, "compression": "gzip", "compression_opts": 1, "shuffle": True}


def _write_shared(file: h5py.File, layout: Layout) -> None:
    """Dimensions, times, x and bed if there is one grid, and the keys in which the runs differ."""
    for name, values in layout.sizes().items():
        file.create_dataset(name, data=values).make_scale(name)
    shared = layout.shared()
    for name in sorted(shared, key=lambda name: name != "time"):
        schema, times = shared[name]
        data = file.create_dataset(name, data=times)
        if name == "time":
            data.make_scale(name)
        _describe(file, name, data, schema)
    group = file.create_group(PARAMETERS)
    for key, column in layout.parameters().items():
        group.create_dataset(key, data=column).dims[0].attach_scale(file["run"])


def _describe(file: h5py.File, name: str, data: h5py.Dataset, schema: Variable) -> None:
    data.attrs.update(units=schema.units, long_name=schema.long_name)
    for axis, dim in zip(data.dims, schema.dims, strict=True):
        if dim != name:
            axis.attach_scale(file[dim])
    if "cell" in schema.dims and name != "x":
        data.attrs["coordinates"] = "x"


def _place(name: str) -> str:
    return f"series/{name}" if name in SERIES else name


def _write_all(fd: int, data: bytes, offset: int) -> None:
    while data:
        written = os.pwrite(fd, data, offset)
        data, offset = data[written:], offset + written


@contextmanager
def _telling(path: Path) -> Iterator[None]:
    """Say what went wrong with which file."""
    try:
        yield
    except OSError as error:
        raise StorageError(f"cannot write {path}: {error.strerror or error}") from None
