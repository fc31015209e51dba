"""A quantity on finer and finer grids: observed order, Richardson's limit, errors, cells that an error needs."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from warpgran.arrays import Array

SETTLED = 1e-3
"""A relative change from one grid to the next below which the finest value is taken for the limit."""
ORDERS = (0.4, 2.5)
"""Range of observed orders from which to extrapolate; the schemes are of order 1 and 2."""


@dataclass(frozen=True)
class Refined:
    """One quantity on grids of which each has twice the cells of the one before.

    Attributes:
        name: What it is.
        cells: Of each grid, three or more.
        values: On each grid.
        offset: Added to a value for relative errors: 1 makes those of a volume change errors of the volume.
    """

    name: str
    cells: tuple[int, ...]
    values: tuple[float, ...]
    offset: float = 0.0

    @property
    def changes(self) -> Array:
        """From each grid to the next, relative to the finest value."""
        return np.asarray(np.diff(self.values) / (abs(self.values[-1] + self.offset) or 1.0))

    @property
    def order(self) -> float:
        """Order observed on the three finest grids; NaN unless it is one from which to extrapolate."""
        before, last = self.changes[-2:].tolist()
        order = math.log2(before / last) if before * last > 0.0 else math.nan
        return order if ORDERS[0] <= order <= ORDERS[1] else math.nan

    @property
    def limit(self) -> float:
        """Richardson's estimate; the finest value if it has settled, NaN if these grids show no limit."""
        finest = self.values[-1]
        if math.isfinite(self.order):
            return finest + (finest - self.values[-2]) / (2.0**self.order - 1.0)
        return finest if abs(float(self.changes[-1])) < SETTLED else math.nan

    @property
    def errors(self) -> Array:
        """Distance from the limit on each grid, relative to the limit."""
        scale = abs(self.limit + self.offset) or 1.0
        return np.abs(np.array(self.values) - self.limit) / scale

    def enough(self, wanted: float = 0.01) -> int | None:
        """Cells from which on all computed grids are within an error; None if the finest is not known to be."""
        good = self.errors <= wanted
        first = len(good) - int(np.argmin(good[::-1])) if not good.all() else 0
        return self.cells[first] if good[-1] else None

    def needed(self, wanted: float = 0.01) -> int | None:
        """Cells for an error, extrapolated by the observed order where no computed grid has them; None if not known."""
        computed = self.enough(wanted)
        if computed or not math.isfinite(self.order):
            return computed
        cells = self.cells[-1] * (float(self.errors[-1]) / wanted) ** (1.0 / self.order)
        return math.ceil(float(f"{cells:.2g}"))
