"""What tables, caveats and figures need of a result, as arrays over its runs, from a Dataset or without xarray."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from warpgran.arrays import Array
from warpgran.errors import ResultError
from warpgran.schema import FIELDS, PER_RUN, SERIES, Status

if TYPE_CHECKING:
    import xarray as xr

WAITING = (Status.PENDING.word, Status.INTERRUPTED.word)
"""Words of the runs that are still to be computed."""


@dataclass(frozen=True)
class RunColumns:
    """A result by its runs. What is large is read from a file when it is indexed.

    Attributes:
        run: Their numbers, shape (runs,).
        swept: The keys in which the runs differ, each with its value in every run.
        status: How each ended, in words.
        values: Of schema.PER_RUN by name, without the status, each (runs,).
        series: Of schema.SERIES by name, each (runs, samples).
        fields: h [m], v [m/s] and phi [-] by name, each (runs, snapshots, cells).
        time, series_time: Of the snapshots and of the samples [s].
        x, bed: Cell centres and bed [m], shape (cells,), or (runs, cells) where the grids differ, padded by NaN.
        texts: Of the run files: of each run, or one for all.
        source: The file, "" if there is none.
    """

    run: Array
    swept: Mapping[str, Array]
    status: Array
    values: Mapping[str, Array]
    series: Mapping[str, Any]
    fields: Mapping[str, Any]
    time: Array
    series_time: Array
    x: Any
    bed: Any
    texts: Array
    source: str = ""

    @classmethod
    def of(cls, data: xr.Dataset | RunColumns) -> RunColumns:
        """Those of a result, with all its runs or some (`data.isel(run=[0, 3])`).

        Raises:
            ResultError: A selection without the dimension `run`.
        """
        if isinstance(data, RunColumns):
            return data
        from warpgran.analysis.runs import status_words, swept

        if "run" not in data.dims:
            raise ResultError(
                "tables, caveats and figures need the dimension `run`: select one run with data.isel(run=[0])"
            )
        # A selection may have left any of these out.
        there = {name: data[name] if name in data else np.zeros(0) for name in ("time", "series_time", "x", "bed")}
        return cls(
            run=data["run"].values,
            swept={key: data[key].values for key in swept(data)},
            status=status_words(data),
            values={name: data[name].values for name in PER_RUN if name != "status" and name in data},
            series={name: data[name].transpose("run", ...) for name in SERIES if name in data},
            fields={name: data[name].transpose("run", "time", ...) for name in FIELDS if name in data},
            time=np.asarray(there["time"]),
            series_time=np.asarray(there["series_time"]),
            x=there["x"],
            bed=there["bed"],
            texts=data["case_toml"].values if "case_toml" in data.coords else np.array(data.attrs.get("case_toml", "")),
            source=str(data.encoding.get("source", "")),
        )

    def parameter(self, key: str, default: Any = None) -> Array:
        """What a parameter was in each run, or in all; see `parameter_values`."""
        return parameter_values(self.texts, self.swept.get(key), key, default)

    def pick(self, run: int) -> RunColumns:
        """One of the runs alone, by its place, in memory."""

        def row(values: Any) -> Array:
            return np.asarray(values[run : run + 1])

        def rows(columns: Mapping[str, Any]) -> dict[str, Array]:
            return {name: row(values) for name, values in columns.items()}

        return replace(
            self,
            run=row(self.run),
            swept=rows(self.swept),
            status=row(self.status),
            values=rows(self.values),
            series=rows(self.series),
            fields=rows(self.fields),
            x=np.asarray(self.x if self.x.ndim == 1 else self.x[run]),
            bed=np.asarray(self.bed if self.bed.ndim == 1 else self.bed[run]),
            texts=row(self.texts) if self.texts.ndim else self.texts,
        )


def parameter_values(texts: Array, swept: Array | None, key: str, default: Any = None) -> Array:
    """What a parameter was in each run.

    Args:
        texts: Of the run files, of each run or one for all.
        swept: Values of the key that stand beside them; where they are missing, the text counts.
        key: Dotted.
        default: The value where the result does not have the key; None for an error.

    Returns:
        The values, of each run, or one where all have the same.

    Raises:
        ResultError: A run has no such parameter, and no default is given.
    """
    missing = np.True_ if swept is None else _missing(swept)
    if swept is not None and not missing.any():
        return swept
    found = {text: value_in(text, key) for text in dict.fromkeys(texts.ravel().tolist())}
    first, *others = found.values()
    same = all(value == first for value in others)
    values = np.array(first if same else [found[text] for text in texts.tolist()], dtype=object)
    values = np.where(_missing(values), default, values)
    values = values if swept is None else np.where(missing, values, swept)
    if default is None and _missing(values).any():
        raise ResultError(
            f"the result does not say what {key} was: neither its case_toml nor a coordinate of that name"
        )
    return np.array(values.tolist())


def _missing(values: Array) -> Array:
    """Where there is None or NaN."""
    flat = [value is None or value != value for value in values.ravel().tolist()]
    return np.array(flat, dtype=bool).reshape(values.shape)


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
