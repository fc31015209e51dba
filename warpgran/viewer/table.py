"""The runs of one or several results as a table of the page: swept keys, outcomes, how each ended."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from warpgran.analysis.caveats import caveats
from warpgran.analysis.fields import parameter
from warpgran.analysis.runs import status_words
from warpgran.analysis.units import Lengths
from warpgran.case.defaults import FOLLOWS
from warpgran.case.sections import KEYS
from warpgran.figures.style import Panel
from warpgran.figures.swept_keys import Key, varied_keys
from warpgran.viewer.words import pieces

OUTCOMES = (
    Panel("run_out", "run-out", "along"),
    Panel("h_max_final", r"final max. thickness $h_\mathrm{max}$", "thick"),
    Panel("stop_time", r"stop time $t_\mathrm{stop}$", "s"),
    Panel("dilation_max", r"max. dilation $\Delta V/V_0$", "%", factor=100.0),
)
NO_PARAMETER = {*FOLLOWS, "time.snapshots", "time.series"}
"""Keys that files need not share: they follow from others as their default, or say what is written out."""


def table(results: Mapping[str, xr.Dataset], lengths: Lengths) -> dict[str, Any]:
    """The table, as the page reads it.

    Args:
        results: by the name of their file, each with those of its runs that are rows.
        lengths: their units.

    Returns:
        - file, run: of each row the place of its file, and the number of the run in it
        - columns: keys and outcomes, each with its label, unit, values in that unit (None: not known) or words
        - status: in words; failure: the text, by row; left_grid, moving: rows with that reserve
    """
    every = list(results.values())
    sizes = [data.sizes["run"] for data in every]
    left, moving = (np.concatenate([caveats(data)[name] for data in every]) for name in ("left_grid", "moving"))
    failures = np.concatenate(
        [data["failure"].values if "failure" in data else [""] * data.sizes["run"] for data in every]
    )
    return {
        "file": np.repeat(np.arange(len(sizes)), sizes).tolist(),
        "run": np.concatenate([data["run"].values for data in every]).tolist(),
        "columns": [*map(_key_column, _keys(every)), *(_outcome(panel.of(lengths), every) for panel in OUTCOMES)],
        "status": np.concatenate([status_words(data) for data in every]).tolist(),
        "failure": {str(row): str(text) for row, text in enumerate(failures.tolist()) if text},
        "left_grid": np.flatnonzero(left).tolist(),
        "moving": np.flatnonzero(moving).tolist(),
    }


def _keys(results: Sequence[xr.Dataset]) -> list[Key]:
    """The keys in which the runs of all results differ, without those that are no parameter of the flow."""
    names = dict.fromkeys(key.name for data in results for key in varied_keys(data))
    if len(results) > 1:
        names |= dict.fromkeys(name for name in KEYS if name not in NO_PARAMETER and _differs(results, name))
    columns = {name: np.concatenate([_of_runs(data, name) for data in results]) for name in names}
    return [key for key in (Key(name, values) for name, values in columns.items()) if key.levels.size > 1]


def _differs(results: Sequence[xr.Dataset], name: str) -> bool:
    """Whether a key has one value in each result, and not the same in all."""
    values = [parameter(data, name, np.nan).values for data in results]
    return all(value.ndim == 0 for value in values) and len({str(value.item()) for value in values}) > 1


def _of_runs(data: xr.Dataset, name: str) -> np.ndarray:
    return np.broadcast_to(parameter(data, name, np.nan).values, data.sizes["run"])


def _key_column(key: Key) -> dict[str, Any]:
    named = key.words
    label = f"{named.words} ${named.symbol.strip('$')}$" if named.symbol else named.words
    column = {
        "name": key.name,
        "kind": "key",
        "label": pieces(label),
        "unit": named.unit.strip(),
        "log": key.logarithmic,
    }
    if key.numeric:
        return {**column, "values": _numbers(key.at)}
    words = [str(key.levels[level]) for level in key.level]
    return {**column, "words": ["none" if word == "nan" else word for word in words]}


def _outcome(panel: Panel, results: Sequence[xr.Dataset]) -> dict[str, Any]:
    values = panel.factor * np.concatenate([data[panel.name].values for data in results])
    label = pieces(panel.words)
    return {
        "name": panel.name, "kind": "outcome", "label": label, "unit": panel.unit, "log": False,
        "values": _numbers(np.round(values, 9)),  # below there is rounding alone
    }  # fmt: skip


def _numbers(values: np.ndarray) -> list[float | None]:
    """Six digits of each, None where it is not finite."""
    return [float(f"{value:.6g}") if np.isfinite(value) else None for value in values.tolist()]
