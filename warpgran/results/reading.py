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
from warpgran.files import StorageError
from warpgran.schema import PARAMETERS, SCHEMA_VERSION, Status

if TYPE_CHECKING:
    import xarray as xr


def open_dataset(path: str | os.PathLike[str]) -> xr.Dataset:
    """A result file as the Dataset that `simulate` returns; arrays are read when they are used.

    Args:
        path: A finished file of `warpgran run`, or one of a running or killed study (`.part`), where runs that are not
            computed yet are NaN.

    Raises:
        StorageError: There is no such file, or it is not one of warpgran's, or of a newer version.
    """
    import xarray as xr

    path = Path(path)
    try:
        root = xr.open_dataset(path, engine="h5netcdf")
    except FileNotFoundError:
        raise StorageError(f"cannot read {path}: there is no such file") from None
    except (OSError, ValueError) as error:
        raise StorageError(f"cannot read {path}: it is not an HDF5 file ({error})") from None
    found = root.attrs.get("schema_version")
    if found is None:
        raise StorageError(f"cannot read {path}: it is not a warpgran result")
    if found > SCHEMA_VERSION:
        raise StorageError(f"cannot read {path}: its schema is version {found}, this warpgran knows {SCHEMA_VERSION}")
    series = xr.open_dataset(path, engine="h5netcdf", group="series")
    params = xr.open_dataset(path, engine="h5netcdf", group=PARAMETERS)
    by_run = {str(key): ("run", params[key].values) for key in params}
    by_run["case_toml"] = "run", np.full(root.sizes["run"], root.attrs["case_toml"], dtype=object)
    merged = root.merge(series).assign_coords(by_run)
    merged["failure"] = merged["failure"].astype(str)
    waiting = merged["status"] == Status.PENDING
    if waiting.any():  # numbers not written yet read as 0
        for name in merged.data_vars:
            if merged[name].dims[:1] == ("run",) and merged[name].dtype.kind == "f":
                merged[name] = merged[name].where(~waiting)
    return merged.set_coords([name for name in ("x", "time", "series_time") if name in merged])


@contextmanager
def reading(path: Path) -> Iterator[h5py.File]:
    """A file open for reading, even if this process is writing it."""
    try:
        file = h5py.File(path, "r")
    except OSError:
        file = h5py.File(path, "r", locking=False)
    with file:
        yield file


def pending(status: Array) -> Array:
    """Which runs are still to be computed: not begun, or interrupted."""
    return np.isin(status, (Status.PENDING, Status.INTERRUPTED))
