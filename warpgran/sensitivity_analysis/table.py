"""Indices as a table with a row for each output and parameter, to print, and for CSV at every time of a series too."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pandas as pd
import xarray as xr

from warpgran.files import StorageError, replacing
from warpgran.sensitivity_analysis.indices import OVER_TIME

COLUMNS = {
    "sobol": ("first_order", "first_order_low", "first_order_high",
              "total_order", "total_order_low", "total_order_high"),
    "morris": ("mu_star", "mu_star_low", "mu_star_high", "mu", "sigma"),
}  # fmt: skip
"""What a row holds, by method."""
HEADING = "output,units,time,mean,sd,parameter,"
"""Beginning of the CSV file."""
SHOWN_TIMES = 2
"""Rows of a series that is printed, at equal distances in time."""


def table(found: xr.Dataset) -> pd.DataFrame:
    """A row for each output, time of a series, and parameter.

    Args:
        found: What `indices` returns.

    Returns:
        Columns: output, units, time (s, NaN of a single result), mean and sd of the output, parameter, and the indices
        with the ends of their intervals.
    """
    parts = []
    for dim, suffix in (("output", ""), ("series", OVER_TIME)):
        if dim not in found.dims:
            continue
        names = [name for name in ("mean", "sd", *COLUMNS[found.attrs["method"]])]
        part = xr.Dataset({name: found[name + suffix] for name in names}).drop_vars("distribution")
        part = part.rename({dim: "output", f"{dim}_units": "units"}).drop_vars(f"{dim}_words")
        dims = [name for name in ("output", "series_time", "parameter") if name in part.dims]
        rows = part.to_dataframe(dim_order=dims).reset_index()
        parts.append(rows.rename(columns={"series_time": "time"}))
    whole = pd.concat(parts, ignore_index=True)
    if "time" not in whole:
        whole["time"] = np.nan
    return whole[["output", "units", "time", "mean", "sd", "parameter", *COLUMNS[found.attrs["method"]]]]


def write_table(found: xr.Dataset, path: Path) -> Path:
    """Write the table as CSV, whole or not at all; NaN is an empty field.

    Raises:
        StorageError: It cannot be written, or a file is there that warpgran did not write.
    """
    with replacing(path, ours=HEADING.encode()) as part:
        table(found).to_csv(part, index=False, lineterminator="\n", encoding="utf-8")
    return path


def write_dataset(found: xr.Dataset, path: Path) -> Path:
    """Write the indices as netCDF, whole or not at all.

    Raises:
        StorageError: It cannot be written, or a file is there that warpgran did not write.
    """
    if path.exists() and not _ours(path):
        raise StorageError(f"cannot write {path}: what is there was not written by warpgran; remove it first")
    with replacing(path) as part:
        found.to_netcdf(part, engine="h5netcdf")
    return path


def _ours(path: Path) -> bool:
    """Whether a file holds indices."""
    try:
        with h5py.File(path) as file:
            return {"method", "sensitivity"} <= file.attrs.keys()
    except OSError:
        return False


def shown_rows(found: xr.Dataset) -> pd.DataFrame:
    """The rows to print: all of single results, and of each series those at a few times, evenly spread."""
    whole = table(found)
    if "series_time" not in found.dims:
        return whole
    times = found["series_time"].values
    at = np.unique(np.linspace(0, times.size - 1, SHOWN_TIMES + 1).round().astype(int)[1:])
    return whole[whole["time"].isna() | whole["time"].isin(times[at])]
