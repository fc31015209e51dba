"""Result files: HDF5 with dimension scales, so that h5py, xarray, netCDF4 and MATLAB read them."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import h5py
import numpy as np

from warpgran.results import Results, status_attributes
from warpgran.schema import COORDINATES, PARAMETERS, SCHEMA_VERSION, SERIES, Status

if TYPE_CHECKING:
    import xarray as xr


class StorageError(Exception):
    """A result file cannot be written or read; the message names it and says why."""


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A temporary file beside `path` that takes its place when the block ends well, and vanishes when it does not.

    Entering it finds out whether `path` can be written, before anything is computed.

    Raises:
        StorageError: The folder is missing or not writable, or `path` is a folder.
    """
    if path.is_dir():
        raise StorageError(f"cannot write {path}: it is a folder")
    part = path.with_name(f"{path.name}.{os.getpid()}.part")
    try:
        part.touch()
    except OSError as error:
        raise StorageError(f"cannot write {path}: {error.strerror}") from None
    try:
        yield part
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)


def write(results: Results, path: Path) -> None:
    """Write finished results to a new file.

    Raises:
        StorageError: The disk is full, for instance.
    """
    try:
        with h5py.File(path, "w") as file:
            _write(results, file)
    except OSError as error:
        raise StorageError(f"cannot write the results: {error}") from None


def _write(results: Results, file: h5py.File) -> None:
    file.attrs.update(results.attributes)
    for name, length in results.sizes.items():
        file.create_dataset(name, data=np.arange(length)).make_scale(name)
    variables = results.variables()
    for name in sorted(variables, key=lambda name: name != "time"):  # a scale comes before what is attached to it
        schema, value = variables[name]
        dtype = h5py.enum_dtype({s.word: int(s) for s in Status}, basetype="i1") if name == "status" else value.dtype
        options = {"compression": "gzip", "shuffle": True} if value.ndim == 3 and value.size else {}
        data = file.create_dataset(f"series/{name}" if name in SERIES else name, data=value, dtype=dtype, **options)
        data.attrs.update(units=schema.units, long_name=schema.long_name)
        if name == "time":
            data.make_scale(name)
        else:
            for axis, dim in zip(data.dims, schema.dims, strict=True):
                axis.attach_scale(file[dim])
        if "cell" in schema.dims and name != "x":
            data.attrs["coordinates"] = "x"
    file["status"].attrs.update(status_attributes())
    group = file.create_group(PARAMETERS)
    for key, values in results.parameters.items():
        group.create_dataset(key, data=values).dims[0].attach_scale(file["run"])


def open_dataset(path: str | os.PathLike[str]) -> xr.Dataset:
    """A result file as the Dataset that `simulate` returns; arrays are read when they are used.

    Args:
        path: A file that `warpgran run` wrote.

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
    merged = root.merge(series).assign_coords({str(key): ("run", params[key].values) for key in params})
    return merged.set_coords([name for name in COORDINATES if name in merged])
