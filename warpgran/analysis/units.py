"""Units in which lengths are shown, km, m, cm or mm: by their typical size, once for all that is shown together."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from warpgran.analysis.run_columns import RunColumns
from warpgran.arrays import Array

if TYPE_CHECKING:
    import xarray as xr


class LengthUnit(NamedTuple):
    """A unit of lengths.

    Attributes:
        name: its symbol.
        factor: from metres to this unit.
    """

    name: str
    factor: float

    def text(self, length: float) -> str:
        """A length [m] with four digits and the unit."""
        return f"{length * self.factor:.4g} {self.name}"


FROM = ((5000.0, LengthUnit("km", 1e-3)), (0.5, LengthUnit("m", 1.0)), (0.01, LengthUnit("cm", 100.0)))
"""The least typical length [m] for each unit but the smallest, mm."""
MILLIMETRE = LengthUnit("mm", 1000.0)


class Lengths(NamedTuple):
    """How the lengths of a result are shown, chosen from all its runs together.

    Attributes:
        along: typical distance along the slope, m.
        thick: typical thickness, m.
    """

    along: float
    thick: float

    @classmethod
    def of(cls, *results: xr.Dataset | RunColumns) -> Lengths:
        """Typical lengths of results: of each run the largest that it reaches, and of the runs the median."""
        every = [RunColumns.of(data) for data in results]
        return cls(*(typical(np.concatenate([reached(data) for data in every])) for reached in (_fronts, _heights)))


def unit_of(length: float) -> LengthUnit:
    """The unit for lengths of this typical size [m]; m where it is not known."""
    if not np.isfinite(length) or length == 0.0:
        return LengthUnit("m", 1.0)
    return next((unit for least, unit in FROM if length >= least), MILLIMETRE)


def typical(lengths: Array) -> float:
    """Median of the amounts that are finite, 0 if none is: a run that blew up does not decide the unit."""
    finite = np.abs(lengths[np.isfinite(lengths)])
    return float(np.median(finite)) if finite.size else 0.0


def _fronts(data: RunColumns) -> Array:
    """The farthest front of each run [m]; without series the farthest end of the grids."""
    fronts = _largest(data.series["front"])
    return fronts if np.isfinite(fronts).any() else np.ravel(np.nanmax(np.abs(data.x)))


def _heights(data: RunColumns) -> Array:
    """The greatest thickness of each run [m]; without series that of the first run's snapshots."""
    heights = _largest(data.series["h_max"])
    return heights if np.isfinite(heights).any() else _largest(data.fields["h"][:1])


def _largest(values: Any) -> Array:
    """The largest finite amount of each run, NaN where there is none."""
    amounts = np.abs(np.asarray(values))
    amounts = np.where(np.isfinite(amounts), amounts, np.nan)
    return np.fmax.reduce(amounts.reshape(len(amounts), -1), axis=1, initial=np.nan)
