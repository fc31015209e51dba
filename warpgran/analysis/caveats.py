"""What a result must not be read without: runs that lost solid, had not stopped, or did not end cleanly."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from warpgran.analysis.run_columns import WAITING, RunColumns
from warpgran.arrays import Array
from warpgran.case.defaults import FOLLOWS

if TYPE_CHECKING:
    import xarray as xr

LOST = 1e-3
"""Share of the solid whose loss through the ends makes a run-out a lower bound."""
NAMED = 3
"""Most runs of a batch that a line names with their values."""
LISTED = 20
"""Most unclean runs with a line of their own; the others are named by number."""


def caveats(data: xr.Dataset | RunColumns) -> dict[str, Array]:
    """Which runs have results that hold with a reserve.

    Args:
        data: a result, with all its runs or some (`data.isel(run=[0, 3])`).

    Returns:
        Boolean arrays over the runs, by name; False also where the result cannot tell, as without series.

        - left_grid: more than 0.1 % of the solid has left through an end of the grid; run_out is a lower bound
        - moving: the run got to its end and had not stopped; run_out is not final. A flow between periodic ends has no
          run-out, and is none of these

    Raises:
        ResultError: a selection without the dimension `run`.
    """
    data = RunColumns.of(data)
    # A NaN, of what was not computed or is not known, is neither above nor below anything.
    fast = _final(data, "v_flow") >= data.parameter("time.rest_speed", np.nan)
    ended = (data.status == "ok") & np.isnan(data.values["stop_time"])
    return {
        "left_grid": _final(data, "outflow") > LOST,
        "moving": ended & fast & (data.parameter("scheme.left", "") != "periodic"),
    }


def messages(data: xr.Dataset | RunColumns) -> list[str]:
    """The caveats of a result in words, a line each, and the runs that did not end cleanly, by name.

    Args:
        data: a result, with all its runs or some.

    Returns:
        Lines without a full stop; none of a result without reserve.

    Raises:
        ResultError: a selection without the dimension `run`.
    """
    data = RunColumns.of(data)
    found = caveats(data)
    return [*_unclean(data), *_waiting(data), *_left_grid(data, found["left_grid"]), *_moving(data, found["moving"])]


def _unclean(data: RunColumns) -> list[str]:
    """A line for each run that diverged or ran out of steps; beyond a score of them, their numbers."""
    lines: list[str] = []
    for status, said in (("diverged", _divergence), ("step_limit", _step_limit)):
        at = np.flatnonzero(data.status == status)
        lines += [f"{_name(data, i)} {said(data, i)}" for i in at[:LISTED].tolist()]
        if at.size > LISTED:
            lines.append(f"{at.size - LISTED} runs more ended as {status}: {_ranges(data.run[at[LISTED:]])}")
    return lines


def _divergence(data: RunColumns, i: int) -> str:
    text = str(data.values["failure"][i]) if "failure" in data.values else ""
    return text or f"diverged after t = {data.values['end_time'][i]:.6g} s"


def _step_limit(data: RunColumns, i: int) -> str:
    return f"reached its step limit, {data.values['steps'][i]} steps, at t = {data.values['end_time'][i]:.6g} s"


def _waiting(data: RunColumns) -> list[str]:
    """One line for the runs that are still to be computed."""
    at = np.flatnonzero(np.isin(data.status, WAITING))
    runs = data.run.size
    if at.size == 0:
        return []
    if runs > 1:
        return [f"{at.size} of {runs} runs are not computed: {_ranges(data.run[at])}"]
    t, times = data.values["end_time"][0], data.time
    stored = f"{int((times <= t).sum())} of {times.size} snapshots"
    return [f"{_name(data, 0)} was interrupted at t = {t:.4g} s, after {stored}"]


def _left_grid(data: RunColumns, left: Array) -> list[str]:
    """One line for the runs that lost solid, with the share and the first sample at which it was above LOST."""
    final = _final(data, "outflow")

    def loss(i: int) -> str:
        began = data.series_time[np.argmax(np.asarray(data.series["outflow"][i]) > LOST)]
        return f"{100 * final[i]:.2g} %, from t = {began:.4g} s on"

    return _line(data, left, loss, "lost solid through an end of the grid", "run-out", "a lower bound", "lower bounds")


def _moving(data: RunColumns, moving: Array) -> list[str]:
    """One line for the runs that had not stopped."""
    final = _final(data, "v_flow")

    def speed(i: int) -> str:
        return f"{final[i]:.2g} m/s at t = {data.values['end_time'][i]:.4g} s"

    return _line(data, moving, speed, "had not stopped at the end", "run-out", "not final", "not final")


def _line(
    data: RunColumns, which: Array, detail: Callable[[int], str], said: str, what: str, of_one: str, of_many: str
) -> list[str]:
    """A caveat in one line, which names a few of the runs that have it; none where no run has."""
    at, runs = np.flatnonzero(which).tolist(), data.run.size
    if not at:
        return []
    if runs == 1:
        return [f"{_name(data, 0)} {said} ({detail(0)}): its {what} is {of_one}"]
    named = [_name(data, i, detail(i)) for i in at[:NAMED]]
    more = [f"and {len(at) - NAMED} more"] if len(at) > NAMED else []
    return [f"{len(at)} of {runs} runs {said}, so that their {what}s are {of_many}: {', '.join(named + more)}"]


def _name(data: RunColumns, i: int, detail: str = "") -> str:
    """`run 3 (slope.angle = 22; 23 %, ...)`: its number, the values that were swept, and what is to be said of it."""
    values = {key: column[i] for key, column in data.swept.items()}
    chosen = [f"{key} = {_value(value)}" for key, value in values.items() if key not in FOLLOWS or len(values) == 1]
    inside = "; ".join(filter(None, (", ".join(chosen), detail)))
    return f"run {data.run[i]}" + (f" ({inside})" if inside else "")


def _value(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _ranges(numbers: Array) -> str:
    """`3, 7-12, 20` of increasing numbers."""
    pieces = np.split(numbers, np.flatnonzero(np.diff(numbers) > 1) + 1)
    return ", ".join(f"{piece[0]}-{piece[-1]}" if piece.size > 1 else str(piece[0]) for piece in pieces)


def _final(data: RunColumns, name: str) -> Array:
    """The last value of a series that each run has; NaN where it has none. Whole rows are read of few runs alone."""
    if name not in data.series or not data.series[name].size:
        return np.full(data.run.size, np.nan)
    last = np.array(data.series[name][:, -1])
    short = np.flatnonzero(~np.isfinite(last))
    if not short.size:  # older xarray cannot read no rows from a file
        return last
    rows = np.asarray(data.series[name][short])
    known = np.isfinite(rows)
    at = known.shape[1] - 1 - np.argmax(known[:, ::-1], axis=1)
    last[short] = np.where(known.any(axis=1), rows[np.arange(short.size), at], np.nan)
    return last
