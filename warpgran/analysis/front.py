"""Where the front of a thickness profile is."""

from __future__ import annotations

import numpy as np

from warpgran.arrays import Array


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
