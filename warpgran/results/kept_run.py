"""The checkpoints of a file with a single run, from which a later session goes on.

The snapshots so far stand where they will stand in the end, for they do not change any more. All else that a checkpoint
has is a row of numbers, for which a part file has two places, written in turn and the checksums last, so that one is
whole when a write is cut off. The file of an interrupted run has one.
"""

from __future__ import annotations

from collections.abc import Callable
from hashlib import blake2b
from typing import Any

import h5py
import numpy as np

from warpgran.arrays import Array
from warpgran.results.layout import Layout
from warpgran.results.reserving import Reserve
from warpgran.schema import FIELDS
from warpgran.solve.checkpoint import NUMBERS, Checkpoint
from warpgran.solve.finished import SCALARS

PLACES = 2
KEPT, SUMS = "checks/run", "checks/run_sums"
"""Arrays of the file, a row a place: NUMBERS, U and scalars of a checkpoint; checksums of that row and of snapshots."""

Write = Callable[[str, int, bytes], None]
"""Writes an element of an array of the file: its name, the element's place, its bytes."""


def arrays_of(layout: Layout) -> dict[str, tuple[tuple[int, int], np.dtype[Any]]]:
    """Shape and type of these arrays in a part file of a layout: none unless it has a single run."""
    if layout.runs.size != 1:
        return {}
    numbers = len(NUMBERS) + 3 * layout.cells + layout.outputs.samples * len(SCALARS)
    return {KEPT: ((PLACES, numbers), np.dtype(np.float64)), SUMS: ((PLACES, 2), np.dtype(np.uint64))}


def kept_until(file: h5py.File) -> float | None:
    """Time [s] of the last checkpoint of a file, None if it has none; its snapshots are not looked at."""
    rows = _whole_rows(file)
    return float(rows[0][1][NUMBERS.index("t")]) if rows else None


class KeptRun:
    """Keeps the run of a part file, see `solve.checkpoint.Keeper`.

    Attributes:
        kept: The last checkpoint, None if there is none.
        spoiled: Whether a file that was read has checkpoints, but none is as it was written.
    """

    def __init__(self, layout: Layout, write: Write) -> None:
        self._layout, self._write = layout, write
        self.kept: Checkpoint | None = None
        self.spoiled = False
        self._place = PLACES - 1
        self._snapshots, self._seen = 0, _Sum()  # those that the part file has

    def keep(self, checkpoint: Checkpoint) -> None:
        """Write a checkpoint, not over the last one.

        Raises:
            StorageError: It cannot be written. The last one is as it was.
        """
        for k in range(self._snapshots, self._recorded(checkpoint.numbers["output"])):
            for name, profile in zip(FIELDS, checkpoint.profiles, strict=True):
                snapshot = profile[k].astype(np.float64)
                self._write(name, k, snapshot.tobytes())
                self._seen.add(snapshot)
            self._snapshots = k + 1
        numbers = [checkpoint.numbers[name] for name in NUMBERS]
        row = np.concatenate([numbers, checkpoint.U.ravel(), checkpoint.scalars.ravel()])
        place = (self._place + 1) % PLACES
        self._write(KEPT, place, row.tobytes())
        self._write(SUMS, place, np.array([_Sum(row).value, self._seen.value]).tobytes())
        self.kept, self._place = checkpoint, place

    def read(self, file: h5py.File) -> None:
        """Read the last checkpoint of the part file itself."""
        for place, row in _whole_rows(file):
            if self._read(file, place, row):
                return
        self.spoiled = SUMS in file and bool(file[SUMS][:].any())

    def take(self, file: h5py.File) -> None:
        """Take over what the file of an interrupted run has, of the same layout."""
        self.read(file)
        self._snapshots, self._seen = 0, _Sum()
        if self.kept:
            self.keep(self.kept)

    def give(self, source: h5py.File, target: h5py.File, reserve: Reserve) -> None:
        """Copy the last checkpoint from the part file into that of the interrupted run, which has the snapshots."""
        if self.kept:
            for name in (KEPT, SUMS):
                reserve(source[name].nbytes)
                target[name] = source[name][self._place : self._place + 1]

    def _read(self, file: h5py.File, place: int, row: Array) -> bool:
        """Read the checkpoint at a place, with its snapshots; whether these are as they were written."""
        numbers = dict(zip(NUMBERS, row.tolist(), strict=False))
        cells, snapshots = self._layout.cells, self._layout.outputs.snapshots
        profiles = tuple(np.full((snapshots, cells), np.nan) for _ in FIELDS)
        seen, recorded = _Sum(), self._recorded(numbers["output"])
        try:
            for k in range(recorded):
                for name, profile in zip(FIELDS, profiles, strict=True):
                    profile[k] = file[name][0, k]
                    seen.add(profile[k])
        except OSError:  # what was compressed is damaged
            return False
        if seen.value != file[SUMS][place, 1]:
            return False
        U, scalars = np.split(row[len(NUMBERS) :], [3 * cells])
        self.kept = Checkpoint(U.reshape(3, cells), scalars.reshape(-1, len(SCALARS)), profiles, numbers)
        self._place, self._snapshots, self._seen = place, recorded, seen
        return True

    def _recorded(self, output: float) -> int:
        """Snapshots that have been recorded, given the number of the next output."""
        return int((self._layout.outputs.snapshot_at[: int(output)] >= 0).sum())


class _Sum:
    """A checksum of arrays, one after another; its value is never 0, which stands where nothing was written."""

    def __init__(self, *arrays: Array) -> None:
        self._hash = blake2b(digest_size=8)
        for array in arrays:
            self.add(array)

    def add(self, array: Array) -> None:
        self._hash.update(array.tobytes())

    @property
    def value(self) -> np.uint64:
        return np.frombuffer(self._hash.digest(), dtype=np.uint64)[0] | np.uint64(1)


def _whole_rows(file: h5py.File) -> list[tuple[int, Array]]:
    """The places of checkpoints that are as they were written, and their rows; the last one first."""
    rows = enumerate(file[KEPT]) if KEPT in file else ()
    whole = [(place, row) for place, row in rows if _Sum(row).value == file[SUMS][place, 0]]
    return sorted(whole, key=lambda each: -each[1][NUMBERS.index("steps")])
