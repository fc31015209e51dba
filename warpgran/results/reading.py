"""Reading result files."""

from __future__ import annotations

import errno
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
from warpgran.results.seal import check_seal
from warpgran.results.soundness import check_sound
from warpgran.schema import Status

if TYPE_CHECKING:
    import xarray as xr


def open_dataset(path: str | os.PathLike[str]) -> xr.Dataset:
    """A result file as the Dataset that `simulate` returns; arrays are read when they are used.

    Args:
        path: A finished file of `warpgran run`, or one of a running or killed study (`.part`), where runs that are not
            computed yet are NaN.

    Raises:
        StorageError: There is no such file, or it is not one of warpgran's, or malformed, or of another version.
    """
    import xarray as xr

    path = Path(path)
    with reading(path):
        pass
    try:
        data = xr.open_dataset(path, engine="h5netcdf")
    except Exception as error:  # whatever HDF5 makes of attributes that a disk has spoiled
        raise StorageError(f"cannot read {path}: it is malformed ({' '.join(str(error).split())})") from error
    close = data.close  # which what is made of it below would forget
    for values in data.variables.values():
        if values.size == 0:  # HDF5 cannot select some of no numbers
            values.load()
    texts = np.full(data.sizes["run"], data.attrs["case_toml"], dtype=object)
    data = data.assign_coords(case_toml=("run", texts))
    data["failure"] = data["failure"].astype(str)
    waiting = data["status"].values == Status.PENDING
    if waiting.any():  # numbers not written yet read as 0
        from warpgran.results.pending_runs import without

        of_runs = (name for name, values in data.items() if values.dims[:1] == ("run",) and values.dtype.kind == "f")
        data = data.assign({name: without(data[name].variable, waiting) for name in of_runs})
    data.set_close(close)
    return data


@contextmanager
def opened(path: Path) -> Iterator[xr.Dataset]:
    """`open_dataset` for a block that uses the arrays: what cannot be read is reported with the name of the file.

    Raises:
        StorageError: The file cannot be read, or some of its numbers.
    """
    with open_dataset(path) as data, unspoiled(path):
        yield data


def load_dataset(path: Path) -> xr.Dataset:
    """`open_dataset` with all numbers in memory, so that the file is closed again.

    Raises:
        StorageError: The file cannot be read, or some of its numbers.
    """
    with opened(path) as data:
        return data.load()


@contextmanager
def unspoiled(*paths: Path) -> Iterator[None]:
    """For a block that reads numbers of one or several files: what cannot be read is reported with their names.

    Raises:
        StorageError: The library cannot make sense of what is there.
    """
    try:
        yield
    except OSError as error:
        if error.filename is not None or error.errno in (errno.EPIPE, errno.ENOSPC):  # of what the block writes
            raise
        raise StorageError(f"cannot read {' or '.join(map(str, paths))}: it is damaged ({error})") from error


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
    except OSError as error:
        said = str(error)
    if "No locks available" in said or "unable to lock" in said:  # a file system without locks
        return h5py.File(path, "r", locking=False)
    if "truncated" in said:
        raise StorageError(f"cannot read {path}: it is truncated")
    raise StorageError(f"cannot read {path}: it is not an HDF5 file ({said})")


def pending(status: Array) -> Array:
    """Which runs are still to be computed: not begun, or interrupted."""
    return np.isin(status, (Status.PENDING, Status.INTERRUPTED))
