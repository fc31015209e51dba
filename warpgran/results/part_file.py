"""The result file of a running study, `NAME.part`.

It is HDF5 whose structure is complete before the first run, every array at its final size and place, in space that the
disk has given. Runs then only write their numbers into those places, past the HDF5 library, then a checksum, and their
status last; nothing else of the file is ever touched. Killed at any moment, it is therefore a sound file, which
`--resume` completes. Once all runs are stored it is copied to the final name.

What a disk or a copy has spoiled is found by checksums: one a run, in the group CHECKS with the time that has been
spent, and one of everything that is not a run's, the seal behind the end. The finished file keeps those of the runs
where some are still to be computed. A run that is the only one of its file is kept there while it is under way, see
kept_run.py.
"""

from __future__ import annotations

import fcntl
import os
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from hashlib import blake2b
from pathlib import Path
from typing import Any, NamedTuple

import h5py
import numpy as np

from warpgran.arrays import Array
from warpgran.files import StorageError, check_place, check_writable, replacing
from warpgran.results.datasets import bytes_of_shared, describe, write_shared
from warpgran.results.final_file import write_compressed
from warpgran.results.kept_run import KeptRun, arrays_of
from warpgran.results.layout import Layout, status_attributes
from warpgran.results.reading import pending, reading
from warpgran.results.reserving import reserving
from warpgran.results.seal import seal
from warpgran.schema import Status

CHECKS = "checks"
"""Group with what belongs to no result."""
ROWS, SPENT = f"{CHECKS}/rows", f"{CHECKS}/spent"


class Spent(NamedTuple):
    """What the computation of a file has taken, in all its sessions: attributes of the result."""

    cell_steps: float = 0.0
    kernel_seconds: float = 0.0
    wall_seconds: float = 0.0

    def plus(self, other: Spent) -> Spent:
        """The sum."""
        return Spent(*(a + b for a, b in zip(self, other, strict=True)))


def part_of(path: Path) -> Path:
    """The file that a study writes to while it runs.

    Raises:
        StorageError: No file can be written at `path`.
    """
    check_place(path)
    return path.with_name(path.name + ".part")


class PartFile:
    """The file of a running study. A context manager: it holds a lock, so that two processes do not write one file.

    Attributes:
        path: Of the file.
        layout: Of the result.
        status: Codes of schema.Status in the file, shape (runs,).
        before: Spent by earlier sessions.
        spoiled: Number of runs whose numbers were not what was written; they are pending again.
        keeper: Of the run, where it is the only one, None for several.
    """

    def __init__(self, path: Path, layout: Layout, attributes: Mapping[str, Any] | None = None) -> None:
        """Open a part file; with attributes, create it.

        Raises:
            StorageError: It cannot be written, is damaged, or another process is writing it.
        """
        self.path, self.layout = path, layout
        self._new = path.with_name(f".{path.name}.new")  # one name: what a killed start leaves, the next writes over
        if attributes is not None:
            check_writable(path, self._new)
        self._lock = _Lock(path)
        try:
            if attributes is not None:
                with replacing(path, self._new), _naming(path):
                    _create(self._new, layout, attributes)
            self._fd = os.open(path, os.O_RDWR)
        except BaseException:
            self._lock.release()
            raise
        try:
            self._open()
        except BaseException:
            self.close()
            raise

    def _open(self) -> None:
        """Find the places of all arrays, and check what is there."""
        self._began, self._spent, self.spoiled = time.perf_counter(), Spent(), 0
        self.keeper = KeptRun(self.layout, self._write) if self.layout.runs.size == 1 else None
        with reading(self.path) as file:
            self._offset = _places(file, self.layout)
            self.status: Array = file["status"][:]
            self.before = Spent(*file[SPENT][:].tolist())
            rows = file[ROWS][:]
            if self.keeper:
                self.keeper.read(file)
                self.spoiled += self.keeper.spoiled
                # A session that was killed within the run told no more.
                if pending(self.status).any() and (kept := self.keeper.kept):
                    wall = max(self.before.wall_seconds, kept.numbers["seconds"])
                    self.before = Spent(kept.cell_steps, kept.numbers["seconds"], wall)
        for place in np.flatnonzero(~pending(self.status)).tolist():
            self.check(place, rows[place])

    def __enter__(self) -> PartFile:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    @property
    def is_empty(self) -> bool:
        """Whether there is nothing of any run to go on with."""
        return bool(pending(self.status).all()) and not (self.keeper and self.keeper.kept)

    def close(self) -> None:
        """Close the file and release its lock."""
        os.close(self._fd)
        self._lock.release()

    def put(self, at: Sequence[int], rows: Mapping[str, Array]) -> None:
        """Store what `Layout.rows` returns of the runs at these places; the status last, which makes them count.

        Raises:
            StorageError: The disk is full, for instance. What was stored before is sound.
        """
        names = _in_order(self.layout)
        columns = [np.ascontiguousarray(rows[name], dtype=self.layout.columns[name].dtype) for name in names]
        for n, place in enumerate(at):
            row = [values[n : n + 1].tobytes() for values in columns]
            for name, data in zip(names[:-1], row[:-1], strict=True):
                self._write(name, place, data)
            self._write(ROWS, place, np.uint64(_row_sum(place, row)).tobytes())
            self._write("status", place, row[-1])
            self.status[place] = rows["status"][n]

    def check(self, place: int, checksum: int) -> None:
        """Make a run pending again whose numbers in the file are not those of this checksum."""
        if self._sum_there(place) != checksum:
            self.spoiled += 1
            self.status[place] = Status.PENDING
            self._write("status", place, np.int8(Status.PENDING).tobytes())

    def spend(self, cell_steps: int, kernel_seconds: float) -> None:
        """Add to what the runs of this session have taken."""
        self._spent = self._spent.plus(Spent(cell_steps, kernel_seconds))
        wall = time.perf_counter() - self._began
        self._write(SPENT, 0, np.array(self.before.plus(self._spent._replace(wall_seconds=wall))).tobytes())

    def finish(self, path: Path, attributes: Mapping[str, Any]) -> None:
        """Copy to the finished file, compressed and in chunks of a run, and remove this one.

        Args:
            path: Of the finished file.
            attributes: Of this session; what was spent is that of all sessions in the file.

        Raises:
            StorageError: The disk is full, for instance. This file is still there then.
        """
        here = Spent(*(attributes[name] for name in Spent._fields))
        spent = self.before.plus(here)._asdict()
        with replacing(path, self._new) as final, _naming(path):
            with reading(self.path) as source, reserving(final) as (target, reserve):
                write_compressed(source, target, self.layout, self.status, reserve)
                if pending(self.status).any():
                    reserve(source[ROWS].nbytes)
                    target[ROWS] = source[ROWS][:]
                    if self.keeper and self.status[0] == Status.INTERRUPTED:
                        self.keeper.give(source, target, reserve)
                facts = {**attributes, **spent, "cell_steps": int(spent["cell_steps"])}
                target.attrs.update({**source.attrs, **facts})
        self.path.unlink()

    def _write(self, name: str, place: int, data: bytes) -> None:
        """Write an element of an array, such as the row of a run."""
        if data:
            with _naming(self.path):
                _write_all(self._fd, data, self._offset[name] + place * len(data))

    def _sum_there(self, place: int) -> int:
        """The checksum of the run that is in the file."""
        runs = self.layout.runs.size
        each = {name: size // runs for name, size in _sizes(self.layout).items()}
        places = [(each[name], self._offset[name] + place * each[name]) for name in _in_order(self.layout)]
        return _row_sum(place, [os.pread(self._fd, size, offset) if size else b"" for size, offset in places])


def copy_done(path: Path, part: PartFile) -> None:
    """Copy those runs of a finished file that need not be computed again, and what they took; not what is damaged.

    A single run that was interrupted is copied as it was kept.
    """
    with reading(path) as file:
        status = file["status"][:]
        checksums = file[ROWS][:] if ROWS in file else None
        for place in np.flatnonzero(~pending(status)).tolist():
            try:
                rows = {name: np.asarray(file[name][place])[None] for name in part.layout.columns}
            except OSError:
                part.spoiled += 1
                continue
            part.put([place], rows)
            if checksums is not None:
                part.check(place, checksums[place])
        if part.keeper:
            part.keeper.take(file)
            part.spoiled += part.keeper.spoiled
        part.before = Spent(*(float(file.attrs[name]) for name in Spent._fields))
    part.spend(0, 0.0)


class _Lock:
    """Held by the process that writes a file: a lock on a file of its own, as HDF5 locks the file itself to read it."""

    def __init__(self, path: Path) -> None:
        self._path = path.with_name(path.name + ".lock")
        try:
            self._fd = os.open(self._path, os.O_RDWR | os.O_CREAT)
        except OSError as error:
            raise StorageError(f"cannot write {path}: {error.strerror}") from None
        try:
            fcntl.flock(self._fd, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            os.close(self._fd)
            raise StorageError(f"cannot write {path}: another process is writing it") from None

    def release(self) -> None:
        self._path.unlink(missing_ok=True)
        os.close(self._fd)


def check_unlocked(path: Path) -> None:
    """Check that no process is writing a part file.

    Raises:
        StorageError: One is.
    """
    _Lock(path).release()


def _create(path: Path, layout: Layout, attributes: Mapping[str, Any]) -> None:
    with reserving(path) as (file, reserve):
        reserve(sum(_sizes(layout).values()) + bytes_of_shared(layout))
        file.attrs.update(attributes)
        write_shared(file, layout)
        for name, column in layout.columns.items():
            data = _reserved(file, name, (layout.runs.size, *column.shape), column.dtype)
            describe(data, column.schema, layout.coordinates(name))
        file["status"][:] = np.full(layout.runs.size, Status.PENDING, dtype=np.int8)
        file["status"].attrs.update(status_attributes())
        file.create_group(CHECKS)
        _reserved(file, ROWS, (layout.runs.size,), np.dtype(np.uint64))
        _reserved(file, SPENT, (len(Spent._fields),), np.dtype(np.float64))[:] = Spent()
        for name, (shape, dtype) in arrays_of(layout).items():
            _reserved(file, name, shape, dtype)[:] = 0
        offset = _places(file, layout)
    seal(path, sorted((offset[name], offset[name] + size) for name, size in _sizes(layout).items() if size))


def _reserved(file: h5py.File, name: str, shape: tuple[int, ...], dtype: Any) -> h5py.Dataset:
    """A dataset in one piece, whose place in the file is settled now and whose numbers are not written."""
    how = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    how.set_layout(h5py.h5d.CONTIGUOUS)
    how.set_alloc_time(h5py.h5d.ALLOC_TIME_EARLY)
    how.set_fill_time(h5py.h5d.FILL_TIME_NEVER)
    kind, size = h5py.h5t.py_create(dtype, logical=True), h5py.h5s.create_simple(shape)
    return h5py.Dataset(h5py.h5d.create(file.id, name.encode(), kind, size, how))


def _in_order(layout: Layout) -> list[str]:
    """The columns in the order in which they are written: the status last."""
    return sorted(layout.columns, key=lambda name: name == "status")


def _sizes(layout: Layout) -> dict[str, int]:
    """Bytes of every array that runs write into."""
    runs = layout.runs.size
    columns = {name: runs * c.dtype.itemsize * int(np.prod(c.shape)) for name, c in layout.columns.items()}
    kept = {name: dtype.itemsize * int(np.prod(shape)) for name, (shape, dtype) in arrays_of(layout).items()}
    return columns | {ROWS: 8 * runs, SPENT: 8 * len(Spent._fields)} | kept


def _places(file: h5py.File, layout: Layout) -> dict[str, int]:
    """Where in the file each array begins.

    Raises:
        StorageError: It is not as `_create` makes it.
    """
    offsets = {}
    for name, size in _sizes(layout).items():
        data = file.get(name)
        there = data.id.get_storage_size() if isinstance(data, h5py.Dataset) else -1
        if there != size or (size and data.id.get_offset() is None):
            raise StorageError(f"cannot go on with {file.filename}: it is damaged; --force starts anew")
        offsets[name] = data.id.get_offset() or 0
    return offsets


def _row_sum(place: int, row: Sequence[bytes]) -> int:
    """A checksum of the numbers of a run, status included."""
    total = blake2b(place.to_bytes(8, "little"), digest_size=8)
    for data in row:
        total.update(data)
    return int.from_bytes(total.digest(), "little")


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
