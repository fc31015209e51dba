"""What was measured in the laboratory, to lay over the figures. None of it ships: the measurements are not public.

A folder with any of three CSV files:

profiles.csv  angle [degrees], t [s], x [m], h [m]    thickness profiles
front.csv     angle [degrees], t [s], x [m]           position of the front
volume.csv    angle [degrees], t [s], change [-]      volume over the initial one, less 1

x from the gate, downhill, as in the run files; h normal to the slope.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from warpgran.arrays import Array
from warpgran.case.tables import TableError, read_columns

COLUMNS = {
    "profiles": ("angle", "t", "x", "h"),
    "front": ("angle", "t", "x"),
    "volume": ("angle", "t", "change"),
}
RANGES = {"angle": (-80.0, 80.0), "t": (0.0, np.inf), "h": (0.0, np.inf), "change": (-1.0, np.inf)}
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

    def front(self, ax: Axes, angle: float, label: bool = True) -> None:
        """Draw the position of the front [m] against time."""
        rows = self._rows("front", angle)
        if rows:
            ax.plot(rows["t"], rows["x"], label="laboratory" if label else None, **MARKS)

    def front_speed(self, ax: Axes, angle: float, label: bool = True) -> None:
        """Draw the speed of the front [m/s]: second-order differences of its positions."""
        rows = self._rows("front", angle)
        if rows and rows["t"].size > 2:
            speed = np.gradient(rows["x"], rows["t"])
            ax.plot(rows["t"], speed, label="laboratory" if label else None, **MARKS)

    def volume(self, ax: Axes, angle: float, label: bool = True) -> None:
        """Draw the change of the volume [%] against time."""
        rows = self._rows("volume", angle)
        if rows:
            ax.plot(rows["t"], 100 * rows["change"], label="laboratory" if label else None, **MARKS)

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
        TableError: With all that is wrong: no such folder, none of the files, unknown columns, what is no number, a
            value out of range, or times of a front that do not increase.
    """
    if not folder.is_dir():
        raise TableError([f"{folder}: is not a folder of measurements"])
    found = {name: folder / f"{name}.csv" for name in COLUMNS if (folder / f"{name}.csv").exists()}
    if not found:
        allowed = ", ".join(f"{name}.csv" for name in COLUMNS)
        raise TableError([f"{folder}: holds no measurements; allowed: {allowed}"])
    tables: dict[str, Mapping[str, Array]] = {}
    messages: list[str] = []
    for name, path in found.items():
        try:
            columns, places = read_columns(path, COLUMNS[name])
        except TableError as error:
            messages += error.messages
            continue
        messages += _faults(name, columns, places)
        tables[name] = columns
    if messages:
        raise TableError(messages)
    return Laboratory(tables)


def _faults(name: str, columns: Mapping[str, Array], places: list[str]) -> list[str]:
    """What is wrong with the values, in the order of the rows."""
    messages = []
    last: dict[float, float] = {}
    for i, place in enumerate(places):
        row = {column: float(values[i]) for column, values in columns.items()}
        for column, value in row.items():
            low, high = RANGES.get(column, (-np.inf, np.inf))
            if not np.isfinite(value):
                messages.append(f"{place}: {column} = {value} is not a finite number")
            elif not low <= value <= high:
                allowed = f">= {low:g}" if high == np.inf else f">= {low:g} and <= {high:g}"
                messages.append(f"{place}: {column} = {value} is out of range; allowed: {allowed}")
        if name != "profiles":
            if row["t"] <= last.get(row["angle"], -np.inf):
                before = last[row["angle"]]
                messages.append(f"{place}: t = {row['t']} after {before}; allowed: increasing for each angle")
            last[row["angle"]] = row["t"]
    return messages
