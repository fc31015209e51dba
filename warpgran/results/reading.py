"""Reading result files."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import h5py
import numpy as np

from warpgran.arrays import Array
from warpgran.files import StorageError, check_readable
from warpgran.results.heaps import check_heaps
from warpgran.results.numbers import Numbers
from warpgran.results.seal import check_seal
from warpgran.results.soundness import check_sound
from warpgran.schema import Status

if TYPE_CHECKING:
    import xarray as xr


def open_dataset(path: str | os.PathLike[str]) -> xr.Dataset:
    """A result file as the Dataset that `simulate` returns; arrays are read when they are used, and judged then.

    Args:
        path: A finished file of `warpgran run`, or one of a running or killed study (`.part`), where runs that are not
            computed yet are NaN.

    Raises:
        StorageError: There is no such file, or it is not one of warpgran's, or malformed, or of another version; and,
            where an array is used, its numbers cannot be read, or no flow has such numbers.
    """
    path = Path(path)
    with reading(path):
        pass
    try:
        return _labelled(path)
    except StorageError:
        raise
    except Exception as error:  # whatever HDF5 makes of bytes that a disk has spoiled
        raise StorageError(f"cannot read {path}: it is malformed ({' '.join(str(error).split())})") from error


def _labelled(path: Path) -> xr.Dataset:
    """The Dataset of a sound file."""
    import xarray as xr

    from warpgran.results.lazy_numbers import judged

    file = xr.open_dataset(path, engine="h5netcdf", cache=False)  # what judges its numbers keeps them
    for values in file.variables.values():
        if values.size == 0:  # HDF5 cannot select some of no numbers
            values.load()
    runs, waiting = file["run"].values, file["status"].values == Status.PENDING
    found = {name: values for name, values in file.variables.items() if values.ndim and name not in file.indexes}
    over = {name: (runs, waiting) if values.dims[0] == "run" else () for name, values in found.items()}
    data = file.assign({name: judged(found[name], Numbers(path, str(name), *over[name])) for name in found})
    data["failure"] = data["failure"].astype(str)
    data = data.assign_coords(case_toml=("run", np.full(runs.size, data.attrs["case_toml"], dtype=object)))
    data.set_close(file.close)
    return data


def load_dataset(path: Path) -> xr.Dataset:
    """`open_dataset` with all numbers in memory, so that the file is closed again.

    Raises:
        StorageError: The file cannot be read, or some of its numbers.
    """
    with open_dataset(path) as data:
        return data.load()


@contextmanager
def reading(path: Path) -> Iterator[h5py.File]:
    """A result file open for reading.

    Raises:
        StorageError: It is not there, not a sound result, or another process holds it.
    """
    check_readable(path)
    check_seal(path)
    if path.suffix != ".part":  # which has a seal
        check_heaps(path)
    with _open(path) as file:
        check_sound(file, path)
        yield file


def _open(path: Path) -> h5py.File:
    try:
        return h5py.File(path, "r")
    except BlockingIOError:
        raise StorageError(f"cannot read {path}: it is locked, since another process is writing it") from None
    except (OSError, RuntimeError) as error:
        said = " ".join(str(error).split())
    if "No locks available" in said or "unable to lock" in said:  # a file system without locks
        return h5py.File(path, "r", locking=False)
    if "truncated" in said:
        raise StorageError(f"cannot read {path}: it is truncated")
    raise StorageError(f"cannot read {path}: it is not an HDF5 file ({said})")


def pending(status: Array) -> Array:
    """Which runs are still to be computed: not begun, or interrupted."""
    return np.isin(status, (Status.PENDING, Status.INTERRUPTED))
