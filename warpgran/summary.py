"""A result in one row a run: a table to analyse, to store as CSV and to print."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from rich.cells import cell_len
from rich.table import Table

from warpgran.storage import replacing

FloatArray = np.ndarray[Any, np.dtype[np.float64]]

WIDTH = 100  # of the printed table where none is asked for, characters
GAP = 2  # between its columns, characters
PRINTED = {  # columns with a unit: heading, SI unit; fractions are printed in %
    "end_time": ("end", "s"),
    "run_out": ("run-out", "m"),
    "front": ("front", "m"),
    "h_max": ("max h", "m"),
    "dilation_max": ("dilation", "%"),
    "volume_change": ("volume", "%"),
    "stop_time": ("stop", "s"),
}


def summary(data: xr.Dataset) -> pd.DataFrame:
    """What came of each run.

    Args:
        data: a result, with all its runs or some (`data.isel(run=[0, 3])`).

    Returns:
        A row a run. What a run does not have is NaN: it diverged or was interrupted before, or never came to rest. The
        values of a run that ended early are the last that it reached.

        - run: its number in the result
        - the keys in which the runs differ ("slope.angle"): their values, in the units of the run file
        - status: ok, at_rest, diverged, step_limit, interrupted or pending
        - end_time: time reached, s
        - steps: time steps taken
        - run_out: way of the front from the first sample to the last, m
        - front: last position of the front, m
        - h_max: largest thickness at the last sample, m
        - dilation_max: largest relative change of the volume over time, 1
        - volume_change: last relative change of the volume, 1
        - stop_time: first sample after which the mass stays at rest, s

    Raises:
        ValueError: a selection without the dimension `run`.
    """
    if "run" not in data.dims:
        raise ValueError("a summary needs the dimension `run`: select one run with data.isel(run=[0])")
    front, change = _finite(data, "front"), _finite(data, "volume_change")
    start = front[:, 0] if front.shape[1] else np.nan
    columns = {
        "run": data["run"].values,
        **{key: data[key].values for key in swept(data)},
        "status": status_words(data),
        "end_time": data["end_time"].values,
        "steps": data["steps"].values,
        "run_out": _last(front) - start,
        "front": _last(front),
        "h_max": _last(_finite(data, "h_max")),
        "dilation_max": np.fmax.reduce(change, axis=1, initial=np.nan),
        "volume_change": _last(change),
        "stop_time": data["stop_time"].values,
    }
    return pd.DataFrame(columns)


def swept(data: xr.Dataset) -> list[str]:
    """The dotted keys in which the runs differ: coordinates of `run`."""
    return [str(name) for name in data.coords if "." in str(name) and data[name].dims == ("run",)]


def status_words(data: xr.Dataset) -> np.ndarray:
    """How each run ended, as words, also where the result gives numbers and a list of meanings."""
    status = data["status"]
    meanings = str(status.attrs.get("flag_meanings", "")).split()
    flags = np.atleast_1d(status.attrs.get("flag_values", []))
    words: dict[Any, str] = dict(zip(flags.tolist(), meanings, strict=False))
    found = [words.get(value, str(value)) for value in status.values.ravel().tolist()]
    return np.array(found, dtype=object).reshape(status.shape)


def write_csv(frame: pd.DataFrame, path: str | Path) -> Path:
    """Write a summary as CSV, whole or not at all; NaN is an empty field.

    Returns:
        The path of the file.

    Raises:
        StorageError: the folder is missing or not writable, or `path` is a folder.
    """
    path = Path(path)
    with replacing(path) as part:
        frame.to_csv(part, index=False, lineterminator="\n", encoding="utf-8")
    return path


def rich_table(frame: pd.DataFrame, limit: int = 40, *, width: int = WIDTH) -> Table:
    """A summary for the terminal: lengths in cm where they are below 1 m.

    Args:
        frame: what `summary` returns.
        limit: most runs shown, the first and the last; how many are left out is said below.
        width: room in characters. What does not fit is left out and named below: end, steps and run-out first, then the
            last of the swept keys.

    Returns:
        A table for `rich.console.Console.print`.
    """
    runs = len(frame)
    head, tail = (runs, 0) if runs <= limit else (limit - limit // 2, limit // 2)
    shown = np.r_[0:head, runs - tail : runs]
    columns = {str(name): _column(str(name), frame[name].to_numpy(), shown) for name in frame.columns}
    left_out = _too_wide(columns, width)
    columns = {name: lines for name, lines in columns.items() if name not in left_out}
    table = Table(box=None, padding=(0, GAP, 0, 0), pad_edge=False, header_style="bold")
    for heading, _ in columns.values():
        table.add_column(heading, justify="right", no_wrap=True)
    for n in range(shown.size):
        if n == head:
            table.add_row(*["..."] * len(columns))
        table.add_row(*(cells[n] for _, cells in columns.values()))
    counts = frame["status"].value_counts()
    notes = [f"{runs - shown.size} of {runs} runs are left out"] if shown.size < runs else []
    notes += [", ".join(f"{count} {word}" for word, count in counts.items())] if len(counts) > 1 else []
    notes += [f"without {', '.join(left_out)}, for want of room"] if left_out else []
    table.caption, table.caption_justify = "\n".join(notes) or None, "left"
    return table


def _finite(data: xr.Dataset, name: str) -> FloatArray:
    """A series (run, sample) with NaN for all that is not finite."""
    values = data[name].transpose("run", "sample").values
    return np.where(np.isfinite(values), values, np.nan)


def _last(values: FloatArray) -> FloatArray:
    """The last value of each row that is not NaN; NaN if there is none."""
    values = np.pad(values, ((0, 0), (1, 0)), constant_values=np.nan)
    last = np.where(np.isnan(values), 0, np.arange(values.shape[1])).max(axis=1)
    return np.asarray(values[np.arange(values.shape[0]), last])


def _column(name: str, values: np.ndarray, shown: np.ndarray) -> tuple[str, list[str]]:
    """Heading, in two lines, and cells of a printed column."""
    section, _, key = name.rpartition(".")
    title, unit = PRINTED.get(name, (key, ""))
    factor, form = {"m": (1.0, ".3f"), "%": (100.0, "+.2f")}.get(unit, (1.0, ".4g"))
    if unit == "m" and _typical(values) < 1.0:
        unit, factor, form = "cm", 100.0, ".2f"
    heading = f"{section}.\n{title}" if section else f"{title}\n({unit})" if unit else f"{title}\n"
    return heading, [_cell(value, factor, form) for value in values[shown].tolist()]


def _typical(values: FloatArray) -> float:
    """Median of the amounts: a run that blew up does not decide the unit."""
    finite = abs(values[np.isfinite(values)])
    return float(np.median(finite)) if finite.size else 0.0


def _cell(value: Any, factor: float, form: str) -> str:
    """A value as it is printed."""
    if not isinstance(value, float):
        return str(value)
    if math.isnan(value):
        return "-"
    return format(factor * value, form if abs(factor * value) < 1e5 else ".3g")


def _too_wide(columns: dict[str, tuple[str, list[str]]], room: int) -> list[str]:
    """Columns to leave out for the rest to fit, in characters: first what says least, then the last swept keys."""
    widths = {name: GAP + max(map(cell_len, [*head.split("\n"), *cells])) for name, (head, cells) in columns.items()}
    spare = ["end_time", "steps", "run_out", *reversed([name for name in columns if "." in name])]
    left_out: list[str] = []
    while spare and sum(widths.values()) - GAP > room:
        left_out.append(spare.pop(0))
        del widths[left_out[-1]]
    return left_out
