"""Numbers of a result as they are read: NaN in runs that are not computed yet, and none that no flow has.

A result may come from anywhere, and what follows from its numbers multiplies several of them, which overflows where
they are absurd. They are judged here, where all are read, and only those that are: a slice of a large file stays one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from warpgran.arrays import Array
from warpgran.files import StorageError

MOST = 1e40
"""Largest amount in SI units; that of a key of a run file is 1e30."""
FACTORS = {"mass": 2, "energy": 3}
"""How many such amounts a variable is the product of, if not one."""


class Numbers:
    """What is read of a variable of a file."""

    def __init__(self, path: Path, name: str, runs: Array | None = None, waiting: Array | None = None) -> None:
        """Say what is read.

        Args:
            path: The file.
            name: The variable.
            runs: Numbers of the runs, which are its first dimension; None if it has no such dimension.
            waiting: Which of the runs are not computed yet: their places hold no numbers.
        """
        self._path, self._name, self._runs, self._waiting = path, name, runs, waiting

    def read(self, values: Callable[[], Array], rows: Any = slice(None)) -> Array:
        """The numbers of some rows.

        Args:
            values: Reads them.
            rows: What they are indexed by, in the first dimension.

        Raises:
            StorageError: They cannot be read, or one is infinite or absurd.
        """
        with unspoiled(self._path):
            found = values()
        if found.dtype.kind != "f":
            return found
        if self._waiting is not None and np.any(waiting := self._waiting[rows]):
            found = np.array(found)
            found[waiting] = np.nan
        if said := absurd(self._name, found, None if self._runs is None else self._runs[rows]):
            raise StorageError(f"cannot read {self._path}: it is malformed: {said}")
        return found


@contextmanager
def unspoiled(path: Path) -> Iterator[None]:
    """For a block that reads numbers of a file: what cannot be read is reported with the name of the file.

    Raises:
        StorageError: HDF5 cannot make sense of what is there.
    """
    try:
        yield
    except MemoryError:
        raise
    except Exception as error:  # whatever HDF5 and NumPy make of bytes that nobody has written
        raise StorageError(f"cannot read {path}: it is damaged ({' '.join(str(error).split())})") from error


def absurd(name: str, values: Array, runs: Array | None = None) -> str:
    """What is absurd among the numbers of a variable, "" if nothing is; NaN is not.

    Args:
        name: The variable.
        values: Of floating point.
        runs: Numbers of the runs of its first dimension, if it has one; of a single run a number.
    """
    bad = np.abs(values) > MOST ** FACTORS.get(name, 1)
    if not bad.any():
        return ""
    place = np.argwhere(bad)[0] if bad.ndim else np.zeros(0, int)
    where = "" if runs is None else f" of run {runs[place[0]] if np.ndim(runs) else runs}"
    return f"{name}{where} holds {values[tuple(place)]:g}"
