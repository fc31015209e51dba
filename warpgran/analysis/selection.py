"""Parts of a result."""

from __future__ import annotations

import numpy as np
import xarray as xr


def one_run(data: xr.Dataset, run: int) -> xr.Dataset:
    """One run over x, also of a batch whose grids differ: without the cells that only pad its grid.

    Args:
        data: a result.
        run: its place in the result, counted from 0.
    """
    one = data.isel(run=run)
    if "cell" in one.dims:
        one = one.isel(cell=np.flatnonzero(np.isfinite(one["x"].values))).swap_dims(cell="x").drop_vars("cell")
    return one


def along(data: xr.Dataset | xr.DataArray) -> str:
    """The dimension along the slope: x, or cell where the grids of a batch differ."""
    return "x" if "x" in data.dims else "cell"
