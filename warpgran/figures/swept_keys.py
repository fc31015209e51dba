"""The keys of the run file in figures: what they are called, how the runs differ in them, and in what colours.

Beside them the rank correlation that says which of them matter.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba_array

from warpgran.analysis.correlation import rank_correlation
from warpgran.analysis.run_columns import RunColumns
from warpgran.arrays import Array
from warpgran.case.defaults import FOLLOWS, default
from warpgran.figures.names import named
from warpgran.figures.style import COLOURS

if TYPE_CHECKING:
    import xarray as xr

FEW = 6  # values of a key that colours can tell apart


class Key:
    """A swept key.

    Attributes:
        name: dotted.
        words: what it is called.
        numeric: whether its values are numbers, not choices.
        levels: its different values, in order.
        level: which of them each run has, shape (run,).
        places: where the levels lie on the axis of the key, in the unit of its label: the values, or 0, 1, ...
        at: where each run lies there, shape (run,).
    """

    def __init__(self, name: str, values: np.ndarray) -> None:
        self.name = name
        self.numeric = all(isinstance(v, int | float) and not isinstance(v, bool) for v in values.tolist())
        self.words = named(name, values.astype(float) if self.numeric else None)
        self.levels, self.level = np.unique(values if self.numeric else values.astype(str), return_inverse=True)
        count = self.levels.size
        self.places = self.words.factor * self.levels.astype(float) if self.numeric else np.arange(count, dtype=float)
        self.at = self.places[self.level]

    @property
    def few(self) -> bool:
        """Whether colours can tell the values apart."""
        return self.levels.size <= FEW

    @cached_property
    def colours(self) -> np.ndarray:
        """A colour for each level."""
        if not self.numeric:
            return to_rgba_array([COLOURS[n % len(COLOURS)] for n in range(self.levels.size)])
        even = self.few or self.places.size == 1
        along = np.arange(self.levels.size) if even else np.log(self.places) if self.logarithmic else self.places
        return np.asarray(colormaps["viridis"](0.87 * (along - along[0]) / (along[-1] - along[0] or 1.0)))

    @property
    def logarithmic(self) -> bool:
        """Whether its values lie evenly on a logarithmic axis rather than on a linear one."""
        low, middle, high = self.places[0], np.median(self.places), self.places[-1]
        return self.numeric and bool(0.0 < 30.0 * low <= high and middle < 0.3 * high)

    @property
    def edges(self) -> Array:
        """Edges of cells around the places, half-way between them on the axis."""
        at = np.log(self.places) if self.logarithmic else self.places
        middle = (at[1:] + at[:-1]) / 2
        edges = np.r_[2 * at[0] - middle[0], middle, 2 * at[-1] - middle[-1]]
        return np.exp(edges) if self.logarithmic else edges

    def label(self, level: int) -> str | None:
        """What the legend calls a level; of many, only the first and the last are named."""
        if not self.few and 0 < level < self.levels.size - 1:
            return None
        return self.words.value(self._level(level))

    def span(self) -> str:
        """The key and its values, short."""
        if not self.numeric:
            return self.words.value(", ".join(self.levels.tolist()))
        low, high = (self.words.value(self._level(n)) for n in (0, self.levels.size - 1))
        return low.removesuffix(self.words.unit) + " to" + high.partition("=")[2]

    def _level(self, level: int) -> Any:
        """A level, with three digits where it is one of many that were drawn at random or evenly."""
        value = self.levels[level].item()
        return float(f"{value:.3g}") if isinstance(value, float) and not self.few else value

    def label_axis(self, ax: Axes, lines: int, horizontal: bool = True) -> None:
        """Name the key on an axis, in one line or two, and its choices at the ticks."""
        axis, label = (ax.xaxis if horizontal else ax.yaxis), self.words.label
        axis.set_label_text(label if lines == 1 else label.replace(f" {self.words.symbol}", f"\n{self.words.symbol}"))
        if self.logarithmic:
            (ax.set_xscale if horizontal else ax.set_yscale)("log")
        elif self.numeric:
            steps = [1, 2, 5, 10]  # fewer digits than with 2.5
            ax.locator_params(axis="x" if horizontal else "y", nbins=7 if lines == 1 else 4, steps=steps)
        else:
            axis.set_ticks(self.places, self.levels.tolist())
            (ax.set_xlim if horizontal else ax.set_ylim)(-0.5, self.levels.size - 0.5)

    def correlation(self, values: Array) -> float:
        """Rank correlation of the key with a value of each run; choices count in the order of their means."""
        if self.numeric:
            return rank_correlation(self.at, values)
        known = np.isfinite(values)
        counts = np.bincount(self.level[known], minlength=self.levels.size)
        mean = np.bincount(self.level[known], values[known], self.levels.size) / np.maximum(counts, 1)
        return rank_correlation(mean[self.level], values)


def varied_keys(data: xr.Dataset | RunColumns) -> list[Key]:
    """The keys in which the runs differ, without those that took their values from another, as their default."""
    columns = RunColumns.of(data)
    found = columns.swept

    def value(key: str) -> Array:
        return np.asarray(columns.parameter(key, np.nan), dtype=float)

    defaults = {name: default(name, value) for name in found if name in FOLLOWS}
    followers = [name for name in defaults if np.allclose(found[name], defaults[name], rtol=1e-12, atol=0.0)]
    keys = [Key(name, values) for name, values in found.items() if name not in followers]
    return [key for key in keys if key.levels.size > 1]


def runs_along(key: Key, keys: Sequence[Key]) -> list[np.ndarray]:
    """Runs that differ in one key alone: groups of their numbers, each in the order of that key."""
    others = [other.level for other in keys if other is not key]
    _, group = np.unique(np.stack([*others, np.zeros_like(key.level)]), axis=1, return_inverse=True)
    order = np.lexsort((key.at, group.ravel()))
    return np.split(order, np.flatnonzero(np.diff(group.ravel()[order])) + 1)
