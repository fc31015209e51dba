"""Parts of a result that figures draw: one run, the snapshots that it reached, the cells that the mass covers."""

from __future__ import annotations

import numpy as np
import xarray as xr

from warpgran.analysis import selection
from warpgran.analysis.front import thick
from warpgran.errors import ResultError


def one_run(data: xr.Dataset, run: int) -> xr.Dataset:
    """One run over x, which knows its number and how many there are."""
    runs = data.sizes["run"]
    if not 0 <= run < runs:
        raise ResultError(f"there is no run {run}: the result holds {runs}, counted from 0")
    return selection.one_run(data, run).assign_attrs(run=run, runs=runs)


def computed_snapshots(one: xr.Dataset) -> xr.Dataset:
    """Only the snapshots that the run reached."""
    if not one.sizes["time"]:  # of a file no numbers can be read where there are none
        return one
    return one.isel(time=np.flatnonzero(np.isfinite(one["h"].values).any(axis=-1)))


def wet_range(one: xr.Dataset) -> slice:
    """The cells between the first and the last that is ever thicker than h_front [m], and a margin of 4 %."""
    cells = np.flatnonzero(thick(one).values.any(axis=0))
    if cells.size == 0:
        return slice(0, one.sizes["x"])
    margin = max(2, round(0.04 * (cells[-1] - cells[0])))
    return slice(max(0, int(cells[0]) - margin), int(cells[-1]) + margin + 1)
