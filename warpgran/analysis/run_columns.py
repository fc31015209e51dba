"""What tables and caveats take of a result, as arrays over its runs: of a Dataset, or read without xarray."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from warpgran.arrays import Array
from warpgran.errors import ResultError
from warpgran.schema import PER_RUN, SERIES, Status

if TYPE_CHECKING:
    import xarray as xr

WAITING = (Status.PENDING.word, Status.INTERRUPTED.word)
"""Words of the runs that are still to be computed."""


@dataclass(frozen=True)
class RunColumns:
    """A result by its runs.

    Attributes:
        run: Their numbers, shape (runs,).
        swept: The keys in which the runs differ, each with its value in every run.
        status: How each ended, in words.
        values: Of schema.PER_RUN by name, without the status, each (runs,).
        series: Of schema.SERIES by name, each (runs, samples); of a file that is read lazily, what an index asks for.
        time, series_time: Of the snapshots and of the samples [s].
        rest_speed: Below which a run is at rest [m/s]; NaN where the result does not say. One for all runs, or of each.
        left: What the left end of the grid is; "" where the result does not say. One for all runs, or of each.
    """

    run: Array
    swept: Mapping[str, Array]
    status: Array
    values: Mapping[str, Array]
    series: Mapping[str, Any]
    time: Array
    series_time: Array
    rest_speed: Array
    left: Array

    @classmethod
    def of(cls, data: xr.Dataset | RunColumns) -> RunColumns:
        """Those of a result, with all its runs or some (`data.isel(run=[0, 3])`).

        Raises:
            ResultError: A selection without the dimension `run`.
        """
        if isinstance(data, RunColumns):
            return data
        from warpgran.analysis.fields import parameter
        from warpgran.analysis.runs import status_words, swept

        if "run" not in data.dims:
            raise ResultError("tables and caveats need the dimension `run`: select one run with data.isel(run=[0])")
        # A selection may have left either out.
        times = {name: data[name].values if name in data else np.zeros(0) for name in ("time", "series_time")}
        return cls(
            run=data["run"].values,
            swept={key: data[key].values for key in swept(data)},
            status=status_words(data),
            values={name: data[name].values for name in PER_RUN if name != "status" and name in data},
            series={name: data[name].transpose("run", ...) for name in SERIES if name in data},
            time=times["time"],
            series_time=times["series_time"],
            rest_speed=parameter(data, "time.rest_speed", np.nan).values,
            left=parameter(data, "scheme.left", "").values,
        )


def words_of(status: Array, attributes: Mapping[str, Any]) -> Array:
    """How each run ended, as words, also where the result gives numbers and a list of meanings."""
    meanings = str(attributes.get("flag_meanings", "")).split()
    flags = np.atleast_1d(attributes.get("flag_values", []))
    words: dict[Any, str] = dict(zip(flags.tolist(), meanings, strict=False))
    found = [words.get(value, str(value)) for value in status.ravel().tolist()]
    return np.array(found, dtype=object).reshape(status.shape)


def value_in(text: str, key: str) -> Any:
    """What the text of a run file says of a dotted key; None where nothing."""
    value: Any = _parsed(text)
    for name in key.split("."):
        value = value.get(name) if isinstance(value, dict) else None
    return value


@lru_cache(maxsize=1000)
def _parsed(text: str) -> dict[str, Any]:
    """A run file; parsed once, for every field and run asks for its keys."""
    return tomllib.loads(text)
