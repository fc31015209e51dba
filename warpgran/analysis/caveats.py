"""What a result must not be read without: runs that lost solid, had not stopped, or did not end cleanly."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from warpgran.analysis.run_columns import WAITING, RunColumns
from warpgran.arrays import Array
from warpgran.case.defaults import FOLLOWS

if TYPE_CHECKING:
    import xarray as xr

LOST = 1e-3
"""Share of the solid whose loss through the ends makes a run-out a lower bound."""
LATE = 0.1
"""The last share of the run's time, over which the growth of a run-out that is not final is given."""
NAMED = 3
"""Most runs of a batch that a line names; the table and the file mark all of them."""
LISTED = 20
"""Most unclean runs with a line of their own; the others are named by number."""


def caveats(data: xr.Dataset | RunColumns) -> dict[str, Array]:
    """Which runs have results that hold only with reservations.

    Args:
        data: A result, with all its runs or some (`data.isel(run=[0, 3])`).

    Returns:
        Boolean arrays over the runs, by name; False also where the result cannot tell.

        - left_grid: more than 0.1 % of the solid has left through an end of the grid; run_out is a lower bound
        - moving: the run got to its end and had not stopped; run_out is not final. A flow between periodic ends has no
          run-out, and is none of these

    Raises:
        ResultError: A selection without the dimension `run`.
    """
    data = RunColumns.of(data)
    # A NaN, of what was not computed or is not known, is neither above nor below anything.
    fast = _final(data, "v_flow_final") >= data.parameter("time.rest_speed", np.nan)
    ended = (data.status == "ok") & np.isnan(data.values["stop_time"])
    return {
        "left_grid": _final(data, "outflow_final") > LOST,
        "moving": ended & fast & (data.parameter("scheme.left", "") != "periodic"),
    }


def messages(data: xr.Dataset | RunColumns) -> list[str]:
    """The caveats of a result in words, a line each, and the runs that did not end cleanly, by name.

    Args:
        data: A result, with all its runs or some.

    Returns:
        Lines without a full stop; none for a result without reservations.

    Raises:
        ResultError: A selection without the dimension `run`.
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
    """One line for the runs that lost solid: how much, and for a single run since when it was more than LOST."""
    lost = 100.0 * _final(data, "outflow_final")
    if data.run.size > 1:
        return _counted(data, left, "left the grid", f"up to {lost[left].max(initial=0.0):.2g} %", "are lower bounds")
    if not left[0]:
        return []
    above = np.asarray(data.series["outflow"][0] if "outflow" in data.series else []) > LOST
    began = f", from t = {data.series_time[np.argmax(above)]:.4g} s on" if above.any() else ""
    what = f"lost solid through an end of the grid ({lost[0]:.2g} %{began})"
    return [f"{_name(data, 0)} {what}: its run-out is a lower bound"]


def _moving(data: RunColumns, moving: Array) -> list[str]:
    """One line for the runs that had not stopped."""
    speed = _final(data, "v_flow_final")
    if data.run.size > 1:
        fastest = f"up to {speed[moving].max(initial=0.0):.2g} m/s"
        return _counted(data, moving, "had not stopped", fastest, "are not final")
    if not moving[0]:
        return []
    grown = "" if caveats(data)["left_grid"][0] else _growth(data)  # at the end of the grid a front goes no further
    at = f"{speed[0]:.2g} m/s at t = {data.values['end_time'][0]:.4g} s"
    return [f"{_name(data, 0)} had not stopped at the end ({at}): its run-out is not final{grown}"]


def _growth(data: RunColumns) -> str:
    """`, and grew by 0.8 % in the last tenth of the time`: what a later end would give, of a result of one run."""
    t, front = data.series_time, np.asarray(data.series["front"][0] if "front" in data.series else [])
    late = np.searchsorted(t, (1.0 - LATE) * data.values["end_time"][0])
    if late >= front.size - 1 or t[-1] != data.values["end_time"][0] or not front[-1] > front[0]:
        return ""
    grown = (front[-1] - front[late]) / (front[-1] - front[0])
    return f", and grew by {100.0 * grown:.2g} % in the last tenth of the time"


def _counted(data: RunColumns, which: Array, said: str, most: str, reserve: str) -> list[str]:
    """A caveat of a batch in one line of a terminal, with its first runs; none where no run has it."""
    at = data.run[which].tolist()
    if not at:
        return []
    named = ", ".join(map(str, at[:NAMED])) + (", ..." if len(at) > NAMED else "")
    return [f"{len(at)} of {data.run.size} runs {said} ({named}; {most}): run-outs {reserve}"]


def _name(data: RunColumns, i: int) -> str:
    """`run 3 (slope.angle = 22)`: its number and the values that were swept."""
    values = {key: column[i] for key, column in data.swept.items()}
    chosen = [f"{key} = {_value(value)}" for key, value in values.items() if key not in FOLLOWS or len(values) == 1]
    return f"run {data.run[i]}" + (f" ({', '.join(chosen)})" if chosen else "")


def _value(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _ranges(numbers: Array) -> str:
    """`3, 7-12, 20` of increasing numbers."""
    pieces = np.split(numbers, np.flatnonzero(np.diff(numbers) > 1) + 1)
    return ", ".join(f"{piece[0]}-{piece[-1]}" if piece.size > 1 else str(piece[0]) for piece in pieces)


def _final(data: RunColumns, name: str) -> Array:
    """A value of each run; NaN where the result has none."""
    return data.values.get(name, np.full(data.run.size, np.nan))
