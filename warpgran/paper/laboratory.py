"""What was measured in the laboratory, to lay over the figures. None of it ships: the measurements are not public.

The folder that is read is described in `warpgran.case.measurements`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from warpgran.arrays import Array
from warpgran.case.measurements import read_measurements

SAME_TIME = 0.005  # s
MARKS: dict[str, Any] = {
    "linestyle": "none", "marker": "o", "markersize": 2.6, "markerfacecolor": "white", "markeredgewidth": 0.7,
    "markeredgecolor": "0.25", "zorder": 4,
}  # fmt: skip


@dataclass(frozen=True)
class Laboratory:
    """Measurements by file name; empty where there are none.

    Attributes:
        tables: Columns by file and name, in SI units and degrees.
    """

    tables: Mapping[str, Mapping[str, Array]] = field(default_factory=dict)

    def profile(self, ax: Axes, angle: float, t: float) -> None:
        """Draw the thickness [cm] measured within 5 ms of an instant."""
        rows = self._rows("profiles", angle, t)
        if rows:
            ax.plot(rows["x"], 100 * rows["h"], label="laboratory", **MARKS)

    def front(self, ax: Axes, angle: float) -> None:
        """Draw the position of the front [m] against time."""
        rows = self._rows("front", angle)
        if rows:
            ax.plot(rows["t"], rows["x"], label="laboratory", **MARKS)

    def front_speed(self, ax: Axes, angle: float) -> None:
        """Draw the speed of the front [m/s]: second-order differences of its positions."""
        rows = self._rows("front", angle)
        if rows and rows["t"].size > 2:
            speed = np.gradient(rows["x"], rows["t"])
            ax.plot(rows["t"], speed, label="laboratory", **MARKS)

    def volume(self, ax: Axes, angle: float) -> None:
        """Draw the change of the volume [%] against time."""
        rows = self._rows("volume", angle)
        if rows:
            ax.plot(rows["t"], 100 * rows["change"], label="laboratory", **MARKS)

    def _rows(self, name: str, angle: float, t: float | None = None) -> dict[str, Array]:
        """Rows of one slope, and of one instant, in their order; nothing if there are none."""
        table = self.tables.get(name)
        if table is None:
            return {}
        chosen = abs(table["angle"] - angle) < 1e-6
        if t is not None:
            chosen &= abs(table["t"] - t) < SAME_TIME
        return {column: values[chosen] for column, values in table.items()} if chosen.any() else {}


def read_laboratory(folder: Path) -> Laboratory:
    """Read a folder of measurements.

    Raises:
        TableError: With all that is wrong, see `read_measurements`.
    """
    return Laboratory({name: table.columns for name, table in read_measurements(folder).items()})
