"""Parts of a result that figures draw: one run, the snapshots that it reached, the cells that the mass covers."""

from __future__ import annotations

import numpy as np
import xarray as xr

from warpgran.analysis.front import thick
from warpgran.errors import ResultError


def one_run(data: xr.Dataset, run: int) -> xr.Dataset:
    """One run, without the cells that only pad its grid."""
    runs = data.sizes["run"]
    if not 0 <= run < runs:
        raise ResultError(f"there is no run {run}: the result holds {runs}, counted from 0")
    one = data.isel(run=run).assign_attrs(run=run, runs=runs)
    return one.isel(cell=np.flatnonzero(np.isfinite(one["x"].values)))


def computed_snapshots(one: xr.Dataset) -> xr.Dataset:
    """Only the snapshots that the run reached."""
    return one.isel(time=np.flatnonzero(np.isfinite(one["h"].values).any(axis=-1)))


def wet_range(one: xr.Dataset) -> slice:
    """The cells between the first and the last that is ever thicker than h_front [m], and a margin of 4 %."""
    cells = np.flatnonzero(thick(one).values.any(axis=0))
    if cells.size == 0:
        return slice(0, one.sizes["cell"])
    margin = max(2, round(0.04 * (cells[-1] - cells[0])))
    return slice(max(0, int(cells[0]) - margin), int(cells[-1]) + margin + 1)
