"""A result as a table with a row a run, to analyse, to store as CSV and to print."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
import xarray as xr

from warpgran.analysis.caveats import caveats
from warpgran.analysis.run_values import last
from warpgran.analysis.runs import status_words, swept
from warpgran.errors import ResultError
from warpgran.files import replacing


def summary(data: xr.Dataset) -> pd.DataFrame:
    """The results of each run in a row.

    Args:
        data: a result, with all its runs or some (`data.isel(run=[0, 3])`).

    Returns:
        A row a run. NaN where the run diverged or was interrupted before, or never came to rest. The values of a run
        that ended early are the last that it reached.

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
        - left_grid, moving: whether run_out and front are lower bounds, or not final; see `caveats`

    Raises:
        ResultError: a selection without the dimension `run`.
    """
    if "run" not in data.dims:
        raise ResultError("a summary needs the dimension `run`: select one run with data.isel(run=[0])")
    front, change = (last(data[name].transpose("run", "series_time").values) for name in ("front", "volume_change"))
    columns = {
        "run": data["run"].values,
        **{key: data[key].values for key in swept(data)},
        "status": status_words(data),
        "end_time": data["end_time"].values,
        "steps": data["steps"].values,
        "run_out": data["run_out"].values,
        "front": front,
        "h_max": data["h_max_final"].values,
        "dilation_max": data["dilation_max"].values,
        "volume_change": change,
        "stop_time": data["stop_time"].values,
        **caveats(data),
    }
    return pd.DataFrame(columns)


def write_csv(frame: pd.DataFrame, path: str | Path) -> Path:
    """Write a summary as CSV, whole or not at all; NaN is an empty field.

    Returns:
        The path of the file.

    Raises:
        StorageError: the file cannot be written, or one is there that is no earlier summary.
    """
    path = Path(path)
    with replacing(path, ours=b",status,end_time,") as part:
        frame.to_csv(part, index=False, lineterminator="\n", encoding="utf-8")
    return path
