"""What is asked about: results of each run, and series."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from warpgran.analysis.summary import summary
from warpgran.arrays import Array
from warpgran.case.sensitivity_section import SINGLE, asked_problem, sample_of
from warpgran.errors import ResultError
from warpgran.schema import SERIES

COLUMNS = {"run_out": "run_out", "h_max_final": "h_max", "dilation_max": "dilation_max", "stop_time": "stop_time"}
"""Columns of the summary by the names of `SINGLE`."""
UNITS = {"run_out": "m", "h_max_final": "m", "dilation_max": "1", "stop_time": "s"}
WORDS = {
    "run_out": "run-out",
    "h_max_final": "final maximum thickness",
    "dilation_max": "maximum dilation",
    "stop_time": "stop time",
}


@dataclass(frozen=True)
class Output:
    """What is asked about.

    Attributes:
        name: As it was asked for: run_out, front, front@0.5.
        values: By run, shape (runs,), or (runs, times) of a series.
        times: Of a series [s]; None of a single result.
        units: Of the values.
        words: What figures call it.
    """

    name: str
    values: Array
    times: Array | None
    units: str
    words: str


def outputs_of(data: xr.Dataset, of: Sequence[str]) -> list[Output]:
    """The results that are asked for.

    Args:
        data: A result with a dimension `run`.
        of: Names: those of `SINGLE`, series, and series at a time, as front@0.5.

    Raises:
        ResultError: A name is not known, or a series has no sample at that time.
    """
    problems = [problem for name in of if (problem := asked_problem(name))]
    if problems or not of:
        raise ResultError("; ".join(problems) or "of: asks for nothing; allowed: results of a run, and series")
    times = data["series_time"].values
    table = summary(data) if set(of) & set(SINGLE) else None
    found = []
    for name in dict.fromkeys(of):
        series = name.partition("@")[0]
        if table is not None and name in SINGLE:
            values = table[COLUMNS[name]].to_numpy(dtype=float)
            found.append(Output(name, values, None, UNITS[name], WORDS[name]))
            continue
        units, words = SERIES[series].units, SERIES[series].long_name.partition(",")[0]
        if "@" not in name:
            found.append(Output(name, _rows(data[series]), times, units, words))
            continue
        at = sample_of(name, times.tolist())
        if isinstance(at, str):
            raise ResultError(at)
        found.append(Output(name, _rows(data[series])[:, at], None, units, f"{words} at {times[at]:g} s"))
    return found


def _rows(series: xr.DataArray) -> Array:
    """A series, shape (runs, times)."""
    return np.asarray(series.transpose("run", ...).values, dtype=float)
