"""How the runs of a result differ, and how each of them ended."""

from __future__ import annotations

import numpy as np
import xarray as xr

from warpgran.analysis.fields import parameter
from warpgran.analysis.run_columns import words_of
from warpgran.errors import ResultError
from warpgran.schema import is_key


def swept(data: xr.Dataset) -> list[str]:
    """The dotted keys in which the runs differ: coordinates of `run`."""
    return [str(name) for name in data.coords if is_key(str(name)) and data[name].dims == ("run",)]


def with_keys(data: xr.Dataset, *keys: str) -> xr.Dataset:
    """The result with keys of the run file as coordinates of its runs, also those in which they do not differ.

    Results of different sweeps can then be joined along run by xr.concat, which asks for the same coordinates in each.

    Args:
        data: A result, with all its runs or some.
        keys: Dotted keys, e.g. "slope.angle".

    Raises:
        ResultError: A run has no such parameter, or a selection without the dimension `run`.
    """
    if "run" not in data.dims:
        raise ResultError("coordinates of runs need the dimension `run`: select one run with data.isel(run=[0])")
    values = {key: np.broadcast_to(parameter(data, key).values, data.sizes["run"]) for key in keys}
    return data.assign_coords({key: ("run", value.copy()) for key, value in values.items()})


def status_words(data: xr.Dataset) -> np.ndarray:
    """How each run ended, as words, also where the result gives numbers and a list of meanings."""
    return words_of(data["status"].values, data["status"].attrs)
