"""A result as a table with a row a run, to analyse, to store as CSV and to print."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from warpgran.analysis.caveats import caveats
from warpgran.analysis.run_columns import RunColumns
from warpgran.analysis.run_values import last
from warpgran.arrays import Array
from warpgran.files import replacing

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr


def summary(data: xr.Dataset | RunColumns) -> pd.DataFrame:
    """The results of each run in a row.

    Args:
        data: A result, with all its runs or some (`data.isel(run=[0, 3])`).

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
        ResultError: A selection without the dimension `run`.
    """
    import pandas as pd

    return pd.DataFrame(summary_columns(RunColumns.of(data)))


def summary_columns(data: RunColumns) -> dict[str, Array]:
    """The columns of `summary`, each (runs,)."""
    values = data.values
    return {
        "run": data.run,
        **data.swept,
        "status": data.status,
        "end_time": values["end_time"],
        "steps": values["steps"],
        "run_out": values["run_out"],
        "front": last(np.asarray(data.series["front"])),
        "h_max": values["h_max_final"],
        "dilation_max": values["dilation_max"],
        "volume_change": last(np.asarray(data.series["volume_change"])),
        "stop_time": values["stop_time"],
        **caveats(data),
    }


def write_csv(frame: pd.DataFrame, path: str | Path) -> Path:
    """Write a summary as CSV, whole or not at all; NaN is an empty field.

    Returns:
        The path of the file.

    Raises:
        StorageError: The file cannot be written, or one is there that is no earlier summary.
    """
    path = Path(path)
    with replacing(path, ours=b",status,end_time,") as part:
        frame.to_csv(part, index=False, lineterminator="\n", encoding="utf-8")
    return path
