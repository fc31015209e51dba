"""What a run comes to: the values of a run that follow from its series, as tables and figures show them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from warpgran.arrays import Array


def run_values(t: Array, series: Mapping[str, Array], rest_speed: Array) -> dict[str, Array]:
    """The values of each run that follow from its series; NaN where it has no sample.

    What is not finite is left out: a run that diverged has the values that it reached.

    Args:
        t: Of the samples [s], shape (samples,).
        series: Of schema.SERIES by name, each (runs, samples).
        rest_speed: Of each run [m/s], shape (runs,).

    Returns:
        run_out [m], dilation_max [-] and stop_time [s], each (runs,).
    """
    front, change = (_finite(series[name]) for name in ("front", "volume_change"))
    speeds = zip(series["v_flow"], rest_speed, strict=True)
    return {
        "run_out": last(front) - (front[:, 0] if t.size else np.nan),
        "dilation_max": np.fmax.reduce(change, axis=1, initial=np.nan),
        "stop_time": np.array([stop_time(t, v_flow, speed) for v_flow, speed in speeds]),
    }


def final_values(series: Mapping[str, Array], end: Mapping[str, Array]) -> dict[str, Array]:
    """The values of each run at its end, or the last that it reached; NaN where there are none.

    Args:
        series: Of schema.SERIES by name, each (runs, samples).
        end: The same at the end alone, where the series may have no sample, each (runs, 1).

    Returns:
        h_max_final [m], v_flow_final [m/s] and outflow_final [-], each (runs,).
    """
    return {f"{name}_final": last(np.hstack([series[name], end[name]])) for name in ("h_max", "v_flow", "outflow")}


def last(values: Array) -> Array:
    """The last finite value of each row, shape (runs,); NaN if there is none."""
    values = np.pad(_finite(values), ((0, 0), (1, 0)), constant_values=np.nan)
    at = np.where(np.isnan(values), 0, np.arange(values.shape[1])).max(axis=1)
    return np.asarray(values[np.arange(values.shape[0]), at])


def stop_time(t: Array, v_flow: Array, rest_speed: float) -> float:
    """First sample time [s] after which the speed stays below rest_speed [m/s]; NaN if it never does.

    The initial state is at rest without having stopped: what counts is after the mass has moved.
    """
    moving = np.flatnonzero(~(v_flow < rest_speed))
    if moving.size == 0 or moving[-1] == t.size - 1:
        return float("nan")
    return float(t[moving[-1] + 1])


def _finite(values: Array) -> Array:
    return np.where(np.isfinite(values), values, np.nan)
