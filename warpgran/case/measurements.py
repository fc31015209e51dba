"""What was measured, as a folder with any of three CSV files.

profiles.csv  angle [degrees], t [s], x [m], h [m]    thickness profiles; t = inf for the deposit, when all is at rest
front.csv     angle [degrees], t [s], x [m]           position of the front
volume.csv    angle [degrees], t [s], change [-]      volume over the initial one, less 1

x from the gate, downhill, as in the run files; h normal to the slope. Each file may have a column sigma, the standard
deviation of its last quantity, in its unit; a thickness may then be as little below 0 as noise makes it. A file is read
as the tables of `warpgran.case.tables` are.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from warpgran.arrays import Array
from warpgran.case.tables import TableError, read_columns

COLUMNS = {
    "profiles": ("angle", "t", "x", "h"),
    "front": ("angle", "t", "x"),
    "volume": ("angle", "t", "change"),
}
"""Columns of each file; the last is what was measured."""
RANGES = {"angle": (-80.0, 80.0), "t": (0.0, np.inf), "h": (0.0, np.inf), "change": (-1.0, np.inf)}

BELOW = 5.0
"""How many sigma below 0 a thickness may lie, as noise makes it do where the flow is thin."""


@dataclass(frozen=True)
class MeasuredTable:
    """One file of measurements.

    Attributes:
        columns: By name, each (rows,), in SI units and degrees.
        places: FILE:LINE of each row.
    """

    columns: Mapping[str, Array]
    places: tuple[str, ...]


def read_measurements(folder: Path) -> dict[str, MeasuredTable]:
    """Read a folder of measurements: those of the three files that are there, by name without ".csv".

    Raises:
        TableError: With all that is wrong: no such folder, none of the files, unknown columns, what is no number, a
            value out of range, or times of a front or volume that do not increase.
    """
    if not folder.is_dir():
        raise TableError([f"{folder}: is not a folder of measurements"])
    found = {name: folder / f"{name}.csv" for name in COLUMNS if (folder / f"{name}.csv").exists()}
    if not found:
        allowed = ", ".join(f"{name}.csv" for name in COLUMNS)
        raise TableError([f"{folder}: holds no measurements; allowed: {allowed}"])
    tables: dict[str, MeasuredTable] = {}
    messages: list[str] = []
    for name, path in found.items():
        try:
            columns, places = read_columns(path, COLUMNS[name], ("sigma",))
        except TableError as error:
            messages += error.messages
            continue
        messages += _faults(name, columns, places)
        tables[name] = MeasuredTable(columns, tuple(places))
    if messages:
        raise TableError(messages)
    return tables


def _faults(name: str, columns: Mapping[str, Array], places: list[str]) -> list[str]:
    """What is wrong with the values, in the order of the rows."""
    messages = []
    last: dict[float, float] = {}
    for i, place in enumerate(places):
        row = {column: float(values[i]) for column, values in columns.items()}
        for column, value in row.items():
            low, high = RANGES.get(column, (-np.inf, np.inf))
            if column == "h" and "sigma" in row:
                low = -BELOW * row["sigma"]
            deposit = name == "profiles" and column == "t" and value == np.inf
            if not np.isfinite(value) and not deposit:
                messages.append(f"{place}: {column} = {value} is not a finite number")
            elif column == "sigma" and value <= 0:
                messages.append(f"{place}: sigma = {value} is out of range; allowed: > 0")
            elif not low <= value <= high:
                allowed = f">= {low:g}" if high == np.inf else f">= {low:g} and <= {high:g}"
                messages.append(f"{place}: {column} = {value} is out of range; allowed: {allowed}")
        if name != "profiles":
            if row["t"] <= last.get(row["angle"], -np.inf):
                before = last[row["angle"]]
                messages.append(f"{place}: t = {row['t']} after {before}; allowed: increasing for each angle")
            last[row["angle"]] = row["t"]
    return messages
