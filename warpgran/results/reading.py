"""Reading result files."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

from warpgran.arrays import Array
from warpgran.files import StorageError, check_readable
from warpgran.schema import SCHEMA_VERSION, Status

if TYPE_CHECKING:
    import xarray as xr


def open_dataset(path: str | os.PathLike[str]) -> xr.Dataset:
    """A result file as the Dataset that `simulate` returns; arrays are read when they are used.

    Args:
        path: A finished file of `warpgran run`, or one of a running or killed study (`.part`), where runs that are not
            computed yet are NaN.

    Raises:
        StorageError: There is no such file, or it is not one of warpgran's, or of another version.
    """
    import xarray as xr

    path = Path(path)
    check_readable(path)
    try:
        data = xr.open_dataset(path, engine="h5netcdf")
    except FileNotFoundError:
        raise StorageError(f"cannot read {path}: there is no such file") from None
    except (OSError, ValueError) as error:
        raise StorageError(f"cannot read {path}: it is not an HDF5 file ({error})") from None
    check_schema(path, data.attrs)
    texts = np.full(data.sizes["run"], data.attrs["case_toml"], dtype=object)
    data = data.assign_coords(case_toml=("run", texts))
    data["failure"] = data["failure"].astype(str)
    waiting = data["status"].values == Status.PENDING
    if waiting.any():  # numbers not written yet read as 0
        from warpgran.results.pending_runs import without

        of_runs = (name for name, values in data.items() if values.dims[:1] == ("run",) and values.dtype.kind == "f")
        data = data.assign({name: without(data[name].variable, waiting) for name in of_runs})
    return data


def check_schema(path: Path, attributes: Mapping[str, Any]) -> None:
    """Check that a file is a result of this schema, by its attributes.

    Raises:
        StorageError: It is not.
    """
    found = attributes.get("schema_version")
    if not isinstance(found, int | np.integer):
        raise StorageError(f"cannot read {path}: it is not a warpgran result")
    if found != SCHEMA_VERSION:
        what = "compute it again" if found < SCHEMA_VERSION else "update warpgran"
        raise StorageError(
            f"cannot read {path}: its schema is version {found}, this warpgran reads version {SCHEMA_VERSION}; {what}"
        )


@contextmanager
def reading(path: Path) -> Iterator[h5py.File]:
    """A file open for reading, even if this process is writing it."""
    check_readable(path)
    try:
        file = h5py.File(path, "r")
    except OSError:
        file = h5py.File(path, "r", locking=False)
    with file:
        yield file


def pending(status: Array) -> Array:
    """Which runs are still to be computed: not begun, or interrupted."""
    return np.isin(status, (Status.PENDING, Status.INTERRUPTED))
