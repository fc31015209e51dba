"""The two tables that a case may name: the bed's elevation and the column's profile.

A table is a CSV file with a header. Columns may stand in any order; spaces around names and numbers, a byte order mark,
empty lines and lines that start with `#` are ignored. All lengths are in m.
"""

from __future__ import annotations

import csv
import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from warpgran.arrays import Array
from warpgran.errors import WarpgranError
from warpgran.files import read_text

_MOST_MESSAGES = 10
SEPARATORS = {";": "semicolons", "\t": "tabs"}
"""Of spreadsheets, which separate columns by what the language of the machine has."""


class TableError(WarpgranError, ValueError):
    """A table that cannot be used.

    Attributes:
        messages: The problems with file and line, at most ten and a count of the rest.
    """

    def __init__(self, messages: Sequence[str]) -> None:
        self.messages = list(messages[:_MOST_MESSAGES])
        if len(messages) > _MOST_MESSAGES:
            self.messages.append(f"and {len(messages) - _MOST_MESSAGES} more of this table")
        super().__init__("\n".join(self.messages))


@dataclass(frozen=True, eq=False)
class Table:
    """Columns over x: float64 arrays of one length >= 2, read-only.

    Attributes:
        path: The file as it was named, None for a table given as arrays.
        x: Positions along the slope, m, shape (rows,), strictly increasing.
    """

    path: str | None
    x: Array

    def __post_init__(self) -> None:
        for values in self.columns().values():
            values.setflags(write=False)

    def columns(self) -> dict[str, Array]:
        """The arrays by name."""
        return {name: values for name, values in vars(self).items() if isinstance(values, np.ndarray)}

    def plain(self) -> str | dict[str, list[float]]:
        """This table as a run file names it: its path, or else its columns."""
        return self.path if self.path is not None else {name: v.tolist() for name, v in self.columns().items()}

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Table):
            return NotImplemented
        mine, others = self.columns(), other.columns()
        same = mine.keys() == others.keys() and all(np.array_equal(mine[name], others[name]) for name in mine)
        return same and self.path == other.path

    def __hash__(self) -> int:
        return hash((self.path, self.x.tobytes()))


@dataclass(frozen=True, eq=False)
class BedTable(Table):
    """Bed elevation over x.

    Attributes:
        b: Elevation normal to the plane, m, shape (rows,).
    """

    b: Array


@dataclass(frozen=True, eq=False)
class ProfileTable(Table):
    """Initial state over x.

    Attributes:
        h: Thickness, m, shape (rows,), >= 0 and somewhere > 0.
        phi: Solid volume fraction, shape (rows,), between 0 and 1; None if the table has none.
        v: Velocity, m/s, shape (rows,); None if the table has none, for a mass at rest.
    """

    h: Array
    phi: Array | None = None
    v: Array | None = None


Source = str | os.PathLike[str] | Mapping[str, Any]


def read_bed(source: Source, folder: str | os.PathLike[str] = ".") -> BedTable:
    """Read a bed: columns x and b, in m.

    Args:
        source: A CSV file, or a mapping of names to sequences of numbers.
        folder: What a relative path starts from.

    Raises:
        TableError: Lists everything that is wrong.
    """
    return BedTable(**_read(source, folder, ("x", "b"), ()))


def read_profile(source: Source, folder: str | os.PathLike[str] = ".") -> ProfileTable:
    """Read an initial profile: columns x and h, in m, and optionally phi and v, in m/s.

    Args:
        source: A CSV file, or a mapping of names to sequences of numbers.
        folder: What a relative path starts from.

    Raises:
        TableError: Lists everything that is wrong.
    """
    return ProfileTable(**_read(source, folder, ("x", "h"), ("phi", "v")))


def _read(
    source: Source, folder: str | os.PathLike[str], needed: tuple[str, ...], optional: tuple[str, ...]
) -> dict[str, Any]:
    if isinstance(source, Mapping):
        columns, places = _from_mapping(source, needed, optional)
        path = None
    else:
        path = os.fspath(source)
        columns, places = read_columns(Path(folder) / path, needed, optional)
    messages = _faults(columns, places, "table" if path is None else str(Path(folder) / path))
    if messages:
        raise TableError(messages)
    return {"path": path, **columns}


def _check_names(names: Sequence[str], needed: tuple[str, ...], optional: tuple[str, ...], place: str) -> None:
    if len(set(names)) != len(names) or not set(needed) <= set(names) <= {*needed, *optional}:
        allowed = ",".join(needed) + (f" and optionally {','.join(optional)}" if optional else "")
        found = ",".join(names)
        raise TableError([f'{place}: the columns are "{found[:60]}"; allowed: {allowed}, in any order'])


def _from_mapping(
    source: Mapping[str, Any], needed: tuple[str, ...], optional: tuple[str, ...]
) -> tuple[dict[str, Array], list[str]]:
    _check_names([str(name) for name in source], needed, optional, "table")
    columns: dict[str, Array] = {}
    messages = []
    for name in (name for name in (*needed, *optional) if name in source):
        try:
            values = np.asarray(source[name])
        except ValueError:  # rows of unequal length
            values = np.empty((0, 0))
        if values.ndim == 1 and (values.dtype.kind in "iuf" or values.size == 0):
            columns[name] = np.array(values, dtype=np.float64)
        else:
            messages.append(f"column {name} is not a list of numbers")
    if not messages and len({values.size for values in columns.values()}) > 1:
        messages.append("columns differ in length: " + ", ".join(f"{n} has {v.size}" for n, v in columns.items()))
    if messages:
        raise TableError([f"table: {message}" for message in messages])
    return columns, [f"table: row {i + 1}" for i in range(columns["x"].size)]


def lines_of(path: Path) -> list[tuple[int, str]]:
    """The lines of a text file with their numbers, without those that are empty or begin with `#`.

    Raises:
        TableError: It cannot be read.
    """
    try:
        text = read_text(path)
    except UnicodeDecodeError:
        raise TableError([f"{path}: is not UTF-8 text"]) from None
    except (OSError, ValueError) as error:  # ValueError: a null character in the name
        raise TableError([f"{path}: cannot be read: {getattr(error, 'strerror', None) or error}"]) from None
    return [(n, line) for n, line in enumerate(text.splitlines(), 1) if line.strip() and line.strip()[0] != "#"]


def read_columns(
    path: Path, needed: tuple[str, ...], optional: tuple[str, ...] = ()
) -> tuple[dict[str, Array], list[str]]:
    """The columns of a CSV file of numbers, and the place of each row as FILE:LINE.

    Raises:
        TableError: Lists everything that is wrong with the file; the numbers are for the caller to check.
    """
    lines = lines_of(path)
    if not lines:
        raise TableError([f"{path}: is empty; allowed: a header {','.join(needed)} and at least 2 rows"])
    # One line at a time: a quote left open then spoils its own line only and line numbers stay right.
    try:
        (first, header), *rows = [(number, next(csv.reader([line]))) for number, line in lines]
    except csv.Error as error:
        raise TableError([f"{path}: is not a CSV file: {error}"]) from None
    for mark, word in SEPARATORS.items():
        if mark in lines[0][1]:
            raise TableError([f"{path}:{first}: is separated by {word}; allowed: commas, and points in numbers"])
    names = [name.strip() for name in header]
    _check_names(names, needed, optional, f"{path}:{first}")
    messages = []
    values = []
    places = []
    for number, row in rows:
        place = f"{path}:{number}"
        if len(row) != len(names):
            commas = "; a decimal comma is none, write a point" if len(row) == 2 * len(names) else ""
            messages.append(f"{place}: has {len(row)} values; allowed: {len(names)} ({','.join(names)}){commas}")
            continue
        wrong = [cell for cell in row if not _is_number(cell)]
        messages += [f'{place}: "{cell.strip()[:60]}" is not a number{_point(cell)}' for cell in wrong]
        if not wrong:
            values.append([float(cell) for cell in row])
            places.append(place)
    if messages:
        raise TableError(messages)
    table = np.array(values, dtype=np.float64).reshape(-1, len(names))
    return {name: table[:, names.index(name)].copy() for name in (*needed, *optional) if name in names}, places


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return "_" not in cell  # float() takes 1_000


def _point(cell: str) -> str:
    """What is allowed in place of a decimal comma."""
    return f"; allowed: {cell.strip().replace(',', '.')}" if _is_number(cell.replace(",", ".")) else ""


def _faults(columns: Mapping[str, Array], places: Sequence[str], table: str) -> list[str]:
    """Problems of the values, in the order of the rows."""
    x = columns["x"]
    if x.size < 2:
        return [f"{table}: has {x.size} row{'' if x.size == 1 else 's'} of numbers; allowed: at least 2"]
    messages = []
    for i, place in enumerate(places):
        row = {name: float(values[i]) for name, values in columns.items()}
        messages += [f"{place}: {n} = {v} is not a finite number" for n, v in row.items() if not math.isfinite(v)]
        if i > 0 and row["x"] <= x[i - 1]:
            messages.append(f"{place}: x = {row['x']} after {float(x[i - 1])}; allowed: strictly increasing")
        if row.get("h", 0.0) < 0.0:
            messages.append(f"{place}: h = {row['h']} is out of range; allowed: >= 0, in m")
        if not 0.0 < row.get("phi", 0.5) < 1.0 and math.isfinite(row["phi"]):
            messages.append(f"{place}: phi = {row['phi']} is out of range; allowed: > 0 and < 1")
    if not messages and "h" in columns and not columns["h"].any():
        messages.append(f"{table}: h is 0 in every row; allowed: > 0 somewhere")
    return messages
