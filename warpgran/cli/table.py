"""A summary as a table on the terminal."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.cells import cell_len
from rich.table import Table

from warpgran.analysis.units import LengthUnit, typical, unit_of
from warpgran.arrays import Array
from warpgran.case.defaults import FOLLOWS
from warpgran.printable import printable

if TYPE_CHECKING:
    import pandas as pd

GAP = 2  # between columns, characters
PRINTED = {  # columns with a unit: heading, SI unit; fractions are printed in %
    "end_time": ("end", "s"),
    "run_out": ("run-out", "m"),
    "front": ("front", "m"),
    "h_max": ("max h", "m"),
    "dilation_max": ("dilation", "%"),
    "volume_change": ("volume", "%"),
    "stop_time": ("stop", "s"),
}
MARKS = {  # of run-out and front, by the caveat of the run; the first that it has
    "left_grid": (">", "> a lower bound: solid has left the grid"),
    "moving": ("~", "~ not final: the flow had not stopped"),
}
MARKED = ("run_out", "front")


DIGITS = {"km": ".3f", "m": ".3f", "cm": ".2f", "mm": ".2f", "%": "+z.2f"}


def rich_table(frame: pd.DataFrame | Mapping[str, Any], limit: int = 40, *, width: int = 100) -> Table:
    """A summary for the terminal: lengths in km, m, cm or mm by their size, one unit a column.

    Args:
        frame: what `summary` or `summary_columns` returns.
        limit: most runs shown, the first and the last; how many are left out is said below.
        width: room in characters. What does not fit is left out and named below: end, steps and run-out first, then the
            last of the swept keys.

    Returns:
        A table for `rich.console.Console.print`.
    """
    values = {str(name): np.asarray(frame[name]) for name in frame}
    runs = values["run"].size
    head, tail = (runs, 0) if runs <= limit else (limit - limit // 2, limit // 2)
    shown = np.r_[0:head, runs - tail : runs]
    printed = [name for name in values if name not in MARKS]
    along = typical(np.concatenate([values["run_out"], values["front"]]))
    units = {"run_out": unit_of(along), "front": unit_of(along), "h_max": unit_of(typical(values["h_max"]))}
    columns = {name: _column(name, values[name][shown], units.get(name)) for name in printed}
    _mark(columns, {name: column[shown] for name, column in values.items()})
    left_out = _too_wide(columns, width)
    columns = {name: lines for name, lines in columns.items() if name not in left_out}
    table = Table(box=None, padding=(0, GAP, 0, 0), pad_edge=False, header_style="bold")
    for heading, _ in columns.values():
        table.add_column(heading, justify="right", no_wrap=True)
    for n in range(shown.size):
        if n == head:
            table.add_row(*["..."] * len(columns))
        table.add_row(*(cells[n] for _, cells in columns.values()))
    counts = Counter(values["status"].tolist()).most_common()
    notes = [f"{runs - shown.size} of {runs} runs are left out"] if shown.size < runs else []
    notes += [", ".join(f"{count} {word}" for word, count in counts)] if len(counts) > 1 else []
    notes += [note for caveat, (_, note) in MARKS.items() if values[caveat][shown].any()]
    notes += [f"without {printable(', '.join(left_out))}, for want of room"] if left_out else []
    table.caption, table.caption_justify = "\n".join(notes) or None, "left"
    return table


def _column(name: str, values: np.ndarray, length: LengthUnit | None) -> tuple[str, list[str]]:
    """Heading, in two lines, and cells of a printed column; the unit of one that is of lengths is given."""
    section, _, key = name.rpartition(".")
    title, unit = PRINTED.get(name, (key, ""))
    unit, factor = length or (unit, 100.0 if unit == "%" else 1.0)
    section, title = printable(section), printable(title)
    heading = f"{section}.\n{title}" if section else f"{title}\n({unit})" if unit else f"{title}\n"
    return heading, [_cell(value, factor, DIGITS.get(unit, ".4g")) for value in values.tolist()]


def _mark(columns: dict[str, tuple[str, list[str]]], shown: Mapping[str, Array]) -> None:
    """Put a mark before what holds only with reservations, and the word where a flow had not stopped."""
    for n in range(shown["run"].size):
        marks = [mark for caveat, (mark, _) in MARKS.items() if shown[caveat][n]]
        for name in MARKED if marks else ():
            columns[name][1][n] = marks[0] + columns[name][1][n]
        if shown["moving"][n]:
            columns["stop_time"][1][n] = "moving"


def _cell(value: Any, factor: float, form: str) -> str:
    """A value as it is printed."""
    if not isinstance(value, float):
        return printable(str(value))
    if math.isnan(value):
        return "-"
    return format(factor * value, form if abs(factor * value) < 1e5 else ".3g")


def _too_wide(columns: dict[str, tuple[str, list[str]]], room: int) -> list[str]:
    """Columns to leave out for the rest to fit, in characters.

    First the keys whose values follow others by default, then what says least, then the last of the swept keys.
    """
    widths = {name: GAP + max(map(cell_len, [*head.split("\n"), *cells])) for name, (head, cells) in columns.items()}
    keys = [name for name in columns if "." in name]
    follow = [name for name in keys if name in FOLLOWS and len(keys) > 1]
    spare = [*follow, "end_time", "steps", "run_out", *reversed([name for name in keys if name not in follow])]
    left_out: list[str] = []
    while spare and sum(widths.values()) - GAP > room:
        left_out.append(spare.pop(0))
        del widths[left_out[-1]]
    return left_out
