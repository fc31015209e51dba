"""The front of a thickness profile, and the mass behind it."""

from __future__ import annotations

import numpy as np
import xarray as xr

from warpgran.analysis import derived
from warpgran.analysis.fields import field
from warpgran.arrays import Array


def thick(data: xr.Dataset) -> xr.DataArray:
    """Where there is more than h_front: what counts as the mass, and what velocity and phi are shown of."""
    return field(data, derived.thick)


def compacted(data: xr.Dataset) -> xr.DataArray:
    """Compacted thickness phi h/phi_stat [m]: what the solid of a cell would be thick at phi_stat."""
    return field(data, derived.compacted)


def front(x: Array, h: Array, level: float) -> float:
    """Largest x [m] where h falls through a level, linear between cell centres, as the series `front`.

    Args:
        x: cell centres, m, shape (cells,).
        h: thickness, m, shape (cells,).
        level: m.

    Returns:
        The position; the last centre if h is above the level there, NaN if it is nowhere.
    """
    thick = np.flatnonzero(h > level)
    if thick.size == 0:
        return float("nan")
    i = thick[-1]
    if i == h.size - 1:
        return float(x[i])
    return float(x[i] + (h[i] - level) / (h[i] - h[i + 1]) * (x[i + 1] - x[i]))
