"""Whether an HDF5 file is a sound result: it may come from anywhere, and is checked before anything of it is used."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from warpgran.arrays import Array
from warpgran.files import StorageError
from warpgran.results.numbers import absurd
from warpgran.schema import COORDINATES, FIELDS, GRID, PER_RUN, SCHEMA_VERSION, SERIES, Status, Variable, is_key

TEXTS = (
    "title", "run_file", "case_toml", "identity", "precision", "engine", "device", "history", "warpgran_version",
    "warp_version",
)  # fmt: skip
NUMBERS = ("study_runs", "cell_steps", "kernel_seconds", "wall_seconds")
_MOST_PACKED = 2000
"""Most bytes of numbers that a byte of a file can hold, about: what deflate does at best, twice over."""
_COUNTS = ("run", "cell", "steps", "status")
"""Variables that are whole numbers; failure is text, all others are real numbers."""


def check_sound(file: h5py.File, path: Path) -> None:
    """Check that a file is a result of this schema: its links, variables, dimensions, attributes, statuses and times.

    Raises:
        StorageError: It is not.
    """
    try:
        check_schema(file.attrs.get("schema_version"), path)
        if wrong := _fault(file, path.stat().st_size):
            raise StorageError(f"cannot read {path}: it is malformed: {wrong}")
    except StorageError:
        raise
    except Exception as error:  # whatever HDF5 and NumPy make of bytes that nobody has written
        raise StorageError(f"cannot read {path}: it is malformed ({_line(error)})") from error


def check_schema(found: Any, path: Path) -> None:
    """Check the attribute `schema_version` of a file.

    Raises:
        StorageError: It is not that of this schema.
    """
    if not isinstance(found, int | np.integer):
        raise StorageError(f"cannot read {path}: it is not a warpgran result")
    if found != SCHEMA_VERSION:
        what = "compute it again" if found < SCHEMA_VERSION else "update warpgran"
        raise StorageError(
            f"cannot read {path}: its schema is version {found}, this warpgran reads version {SCHEMA_VERSION}; {what}"
        )


def _line(error: Exception) -> str:
    """What an error says, on one line."""
    return " ".join(str(error).split()) or type(error).__name__


def _fault(file: h5py.File, size: int) -> str:
    """What is wrong with a file of so many bytes, "" if nothing is."""
    if wrong := _elsewhere(file, size):
        return wrong
    for name in (*TEXTS, *(["sensitivity"] if "sensitivity" in file.attrs else [])):
        if not isinstance(file.attrs.get(name), str):
            return f"the attribute {name} is not text"
    for name in NUMBERS:
        if not isinstance(file.attrs.get(name), int | float | np.integer | np.floating):
            return f"the attribute {name} is not a number"
    tomllib.loads(file.attrs["case_toml"])
    along = "x" if "cell" not in file else "cell"
    dimensions = {name: COORDINATES[name] for name in ("run", "time", "series_time", along)}
    variables = {**dimensions, **GRID, **FIELDS, **SERIES, **PER_RUN}
    found = {name: file[name] for name in file}  # once, since HDF5 takes long to look for a name
    for item in (file, *(data for name, data in found.items() if name == "status" or is_key(name))):
        dict(item.attrs)  # which are used without xarray, and HDF5 cannot read where its structure is spoiled
    variables |= {name: Variable(("run",), "", "") for name in found if is_key(name)}
    for name, variable in variables.items():
        padded = along == "cell" and name not in dimensions
        if wrong := _wrong(found, name, variable.padded if padded else variable):
            return wrong
    return _wrong_checks(file, size) or _wrong_values(file, along)


def _elsewhere(group: h5py.Group, size: int) -> str:
    """What in a group lies outside the file, or is more than so many bytes of it can hold; "" if nothing."""
    for name in group:
        if not isinstance(group.get(name, getlink=True), h5py.HardLink):
            return f"{name} is a link to another place"
        item = group[name]
        if isinstance(item, h5py.Dataset) and (item.external or item.is_virtual):
            return f"{name} is stored in another place"
        if isinstance(item, h5py.Dataset) and item.size and item.nbytes > _MOST_PACKED * size:
            return f"{name} is larger than the file can hold"
    return ""


def _wrong_checks(file: h5py.File, size: int) -> str:
    """What is wrong with the checksums of runs and a run kept, which stand in files with runs to be computed alone."""
    checks = file.get("checks")
    if checks is None:
        return ""
    if not isinstance(checks, h5py.Group):
        return "checks is no group"
    if wrong := _elsewhere(checks, size):
        return wrong
    rows = checks.get("rows")
    if not _has_form(rows, np.uint64) or rows.shape != file["run"].shape:
        return "checks/rows has not a number a run"
    kept, sums = checks.get("run"), checks.get("run_sums")
    if kept is None and sums is None:
        return ""
    good = _has_form(kept, np.float64, 2) and _has_form(sums, np.uint64, 2) and sums.shape == (kept.shape[0], 2)
    return "" if good else "checks/run and checks/run_sums are not of as many checkpoints"


def _has_form(data: Any, dtype: type[np.generic], dimensions: int = 1) -> bool:
    return isinstance(data, h5py.Dataset) and data.dtype == dtype and len(data.shape or ()) == dimensions


def _wrong(found: Mapping[str, Any], name: str, variable: Variable) -> str:
    """What is wrong with the form of a variable, among what the file holds."""
    data = found.get(name)
    if not isinstance(data, h5py.Dataset):
        return f"{name} is missing"
    if data.shape is None or len(data.shape) != len(variable.dims):
        return f"{name} has not the dimensions {', '.join(variable.dims)}"
    if data.shape != tuple(found[dim].size for dim in variable.dims):
        return f"{name} has another length than {', '.join(variable.dims)}"
    kinds = "iu" if name in _COUNTS else "fiubOS" if is_key(name) else "OS" if name == "failure" else "f"
    if data.dtype.kind not in kinds or (data.dtype.kind == "O" and h5py.check_string_dtype(data.dtype) is None):
        return f"{name} has the type {data.dtype}"
    if name in variable.dims:
        return "" if data.is_scale else f"{name} is no dimension scale"
    for axis, dim in zip(data.dims, variable.dims, strict=True):
        if [scale.name for scale in axis.values()] != [f"/{dim}"]:
            return f"{name} has not the dimensions {', '.join(variable.dims)}"
    return ""


def _wrong_values(file: h5py.File, along: str) -> str:
    """What is wrong with the statuses or the coordinates."""
    in_part = "checks/spent" in file  # where each run has a checksum, and one that is spoiled is computed again
    if not in_part and not np.isin(file["status"][:], [int(status) for status in Status]).all():
        return "status has an unknown code"
    increasing = ["run", "time", "series_time", *(["x"] if along == "x" else [])]
    for name in increasing:
        values = file[name][:]
        if not _increases(values):
            return f"{name} does not increase"
        if wrong := absurd(name, values):
            return wrong
    return "" if file["run"].size and file[along].size else "it has no runs or no cells"


def _increases(values: Array) -> bool:
    return bool(np.isfinite(values).all() and (np.diff(values) > 0).all())
