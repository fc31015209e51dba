"""The result file of a running study, `NAME.part`.

It is HDF5 whose structure is complete before the first run, every array at its final size and place. Runs then only
write their numbers into those places, past the HDF5 library, and their status last; nothing else of the file is ever
touched. Killed at any moment, it is therefore a sound file, which `--resume` completes. Once all runs are stored it is
copied to the final name.
"""

from __future__ import annotations

import fcntl
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from warpgran.arrays import Array
from warpgran.files import StorageError, check_writable, replacing
from warpgran.results.datasets import STATUS_TYPE, describe, write_shared
from warpgran.results.final_file import write_compressed
from warpgran.results.layout import Layout, status_attributes
from warpgran.results.reading import pending, reading
from warpgran.schema import Status


def part_of(path: Path) -> Path:
    """The file that a study writes to while it runs.

    Raises:
        StorageError: `path` is a folder.
    """
    if path.is_dir():
        raise StorageError(f"cannot write {path}: it is a folder")
    return path.with_name(path.name + ".part")


class PartFile:
    """The file of a running study. A context manager: it holds a lock, so that two processes do not write one file.

    Attributes:
        path: Of the file.
        layout: Of the result.
        status: Codes of schema.Status in the file, shape (runs,).
    """

    def __init__(self, path: Path, layout: Layout, attributes: Mapping[str, Any] | None = None) -> None:
        """Open a part file; with attributes, create it.

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
                with replacing(path, self._new), _naming(path):
                    _create(self._new, layout, attributes)
            except StorageError:
                self._lock.release()
                raise
        self._fd = os.open(path, os.O_RDWR)
        with reading(path) as file:
            self._offset = {name: file[name].id.get_offset() for name in layout.columns}
            self.status: Array = file["status"][:]

    def __enter__(self) -> PartFile:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the file and release its lock."""
        os.close(self._fd)
        self._lock.release()

    def put(self, at: Sequence[int], rows: Mapping[str, Array]) -> None:
        """Store what `Layout.rows` returns of the runs at these places; the status last, which makes them count.

        Raises:
            StorageError: The disk is full, for instance. What was stored before is sound.
        """
        names = sorted(self.layout.columns, key=lambda name: name == "status")
        columns = [np.ascontiguousarray(rows[name], dtype=self.layout.columns[name].dtype) for name in names]
        with _naming(self.path):
            for n, place in enumerate(at):
                for name, values in zip(names, columns, strict=True):
                    row = values[n : n + 1]
                    if row.nbytes:
                        _write_all(self._fd, row.tobytes(), self._offset[name] + place * row.nbytes)
                self.status[place] = rows["status"][n]

    def finish(self, path: Path, attributes: Mapping[str, Any]) -> None:
        """Copy to the finished file, compressed and in chunks of a run, and remove this one.

        Raises:
            StorageError: The disk is full, for instance. This file is still there then.
        """
        with replacing(path, self._new) as final, _naming(path):
            with reading(self.path) as source, h5py.File(final, "w") as target:
                write_compressed(source, target, self.layout, self.status)
                target.attrs.update({**source.attrs, **attributes})
        self.path.unlink()


def copy_done(path: Path, part: PartFile) -> None:
    """Copy those runs of a finished file that need not be computed again."""
    with _naming(part.path), reading(path) as file:
        status = file["status"][:]
        for place in np.flatnonzero(~pending(status)):
            rows = {name: file[name][place] for name in part.layout.columns}
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
        write_shared(file, layout)
        for name, column in layout.columns.items():
            shape, dtype = (layout.runs.size, *column.shape), STATUS_TYPE if name == "status" else column.dtype
            describe(_reserved(file, name, shape, dtype), column.schema, layout.coordinates(name))
        file["status"][:] = np.full(layout.runs.size, Status.PENDING, dtype=np.int8)
        file["status"].attrs.update(status_attributes())


def _reserved(file: h5py.File, name: str, shape: tuple[int, ...], dtype: Any) -> h5py.Dataset:
    """A dataset in one piece, whose place in the file is settled now and whose numbers are not written."""
    how = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    how.set_layout(h5py.h5d.CONTIGUOUS)
    how.set_alloc_time(h5py.h5d.ALLOC_TIME_EARLY)
    how.set_fill_time(h5py.h5d.FILL_TIME_NEVER)
    kind, size = h5py.h5t.py_create(dtype, logical=True), h5py.h5s.create_simple(shape)
    return h5py.Dataset(h5py.h5d.create(file.id, name.encode(), kind, size, how))


def _write_all(fd: int, data: bytes, offset: int) -> None:
    while data:
        written = os.pwrite(fd, data, offset)
        data, offset = data[written:], offset + written


@contextmanager
def _naming(path: Path) -> Iterator[None]:
    """Raise a StorageError that names the file where the system does not."""
    try:
        yield
    except OSError as error:
        raise StorageError(f"cannot write {path}: {error.strerror or error}") from None
