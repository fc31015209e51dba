"""Output times of a run: snapshots, series samples, end. Each is met exactly."""

from __future__ import annotations

import math

import numpy as np

from warpgran.case.sections import Every, Time

SAME_TIME = 1e-9
"""Times that differ by less than this fraction of `time.end` are one."""


def snapshots(time: Time) -> Every | tuple[float, ...]:
    """`time.snapshots`, or its default."""
    return _parts(time.end, 5) if time.snapshots is None else time.snapshots


def series(time: Time) -> Every | tuple[float, ...]:
    """`time.series`, or its default."""
    return _parts(time.end, 200) if time.series is None else time.series


def _parts(end: float, count: int) -> Every:
    return Every.model_construct(every=float(f"{end / count:.12g}"))  # 0.009, not 0.009000000000000001


def snapshot_times(time: Time) -> tuple[float, ...]:
    """Times of whole profiles, s, increasing."""
    return _listed(snapshots(time), time.end)


def sample_times(time: Time) -> tuple[float, ...]:
    """Times of the scalar series, s, increasing; a sample at a snapshot has its time to the bit."""
    near = SAME_TIME * time.end
    times = np.array(_listed(series(time), time.end))
    snapshots = np.array([*snapshot_times(time), math.inf])
    candidate = snapshots[np.searchsorted(snapshots, times - near, side="right")]  # the only one that can be near
    return tuple(np.unique(np.where(candidate < times + near, candidate, times)).tolist())


def output_times(time: Time) -> tuple[float, ...]:
    """Every output time, s, increasing."""
    return tuple(sorted({*snapshot_times(time), *sample_times(time), time.end}))


def _listed(times: Every | tuple[float, ...], end: float) -> tuple[float, ...]:
    if isinstance(times, Every):
        return _spaced(end, times.every)
    near = SAME_TIME * end
    return tuple(end if end - time < near else 0.0 if time < near else time for time in times)


def _spaced(end: float, step: float) -> tuple[float, ...]:
    """0, step, 2 step, ... <= end, rounded so that 3 x 0.1 is 0.3, and the end to the bit where it is a multiple."""
    digits = max(12, 6 - math.floor(math.log10(step)))
    times = [round(k * step, digits) for k in range(math.floor(end / step * (1 + SAME_TIME)) + 1)]
    if abs(times[-1] - end) < SAME_TIME * end:
        times[-1] = end
    return tuple(times)
