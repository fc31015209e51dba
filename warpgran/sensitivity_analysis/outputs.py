"""What is asked about: results of each run, and series."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from warpgran.arrays import Array
from warpgran.case.sensitivity_section import SINGLE, asked_problem, sample_of
from warpgran.errors import ResultError
from warpgran.schema import PER_RUN, SERIES

WORDS = {
    "run_out": "run-out",
    "h_max_final": "final max. thickness",
    "dilation_max": "maximum dilation",
    "stop_time": "stop time",
    "front": "front",
    "v_flow": "largest speed",
    "volume_change": "volume change",
    "mass": "volume of solid",
    "energy": "energy",
    "outflow": "solid that has left",
}
"""What figures call results and series; other series are called by their long names."""


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
    found = []
    for name in dict.fromkeys(of):
        series = name.partition("@")[0]
        if name in SINGLE:
            found.append(Output(name, _rows(data[name]), None, PER_RUN[name].units, WORDS[name]))
            continue
        units, words = SERIES[series].units, WORDS.get(series, SERIES[series].long_name.partition(",")[0])
        if "@" not in name:
            found.append(Output(name, _rows(data[series]), times, units, words))
            continue
        at = sample_of(name, times.tolist())
        if isinstance(at, str):
            raise ResultError(at)
        found.append(Output(name, _rows(data[series])[:, at], None, units, f"{words} at {times[at]:g} s"))
    return found


def _rows(series: xr.DataArray) -> Array:
    """Values with the runs first."""
    return np.asarray(series.transpose("run", ...).values, dtype=float)
