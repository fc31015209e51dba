"""Time of each run: which runs advance, and when all of a block have ended.

One thread a run. `status` says why a run ended: see the codes. `running` is the condition of the time loop: 1 while
some run is active and the loop has steps left in its `budget`.
"""

from typing import Any, NamedTuple

import warp as wp

from warpgran.kernels.precision import BLOCK, Doubles, Ints, Precision

OK = 0
DIVERGED = 1
STEP_LIMIT = 2
AT_REST = 4
"""Codes of a run's status, a part of warpgran.schema.Status."""

_BLOCK = wp.constant(BLOCK)
_DIVERGED = wp.constant(DIVERGED)
_STEP_LIMIT = wp.constant(STEP_LIMIT)


class Clock(NamedTuple):
    """The kernels of this file."""

    start: Any
    tick: Any


def make(kinds: Precision, empty: int, module: Any) -> Clock:
    """The kernels of a precision.

    Args:
        kinds: The types.
        empty: Empty cells that a window has at each end before a step.
        module: One that honours NaN.
    """
    Real, A, RunParams, Params = kinds.Real, kinds.Array, kinds.RunParams, kinds.Params

    @wp.kernel(module=module)
    def start(
        # per run
        active: Ints,
        # outputs
        running: Ints,
    ):  # fmt: skip
        """Set the condition of the time loop."""
        wp.atomic_max(running, 0, active[wp.tid()])

    @wp.func
    def occupied(U0: A, first: int) -> bool:
        """Whether any of the elements from the first, as many as are to be empty, holds mass."""
        for n in range(empty):
            if U0[first + n] != Real(0.0):
                return True
        return False

    @wp.func
    def widen(U0: A, lo: Ints, hi: Ints, run: int, p: RunParams):
        """Widen the window before mass can leave it: as many cells as a step can cross must be empty at its ends."""
        if lo[run] > 0 and occupied(U0, p.row + lo[run]):
            lo[run] = lo[run] - _BLOCK
        if hi[run] < p.longest and occupied(U0, p.row + hi[run] - empty):
            hi[run] = hi[run] + _BLOCK

    @wp.kernel(module=module)
    def tick(
        # inputs
        U0: A, times: Doubles, budget: Ints,
        # per run
        params: Params, dt_exact: Doubles, output: Ints, t_stop: Doubles,
        # outputs
        t: Doubles, steps: Ints, status: Ints, active: Ints, due: Ints, lo: Ints, hi: Ints, running: Ints,
    ):  # fmt: skip
        """Advance the time of each run; retire those that have diverged, are out of steps or at their stop."""
        run = wp.tid()
        if active[run] == 0:
            return
        p = params[run]
        widen(U0, lo, hi, run, p)
        steps[run] = steps[run] + 1
        dt = dt_exact[run]
        t_out = wp.min(times[output[run]], t_stop[run])
        if dt >= t_out - t[run]:  # an output or the stop limited the step: its time is met exactly
            t[run] = t_out
            if t_out < t_stop[run]:
                due[run] = 1
            else:
                active[run] = 0
        elif dt > wp.float64(0.0) and t[run] + dt > t[run]:
            t[run] = t[run] + dt
            if steps[run] >= p.step_limit:
                status[run] = _STEP_LIMIT
                active[run] = 0
        else:  # a NaN, or a step too short to advance the time
            status[run] = _DIVERGED
            active[run] = 0
        if active[run] != 0 and budget[0] > 0:
            wp.atomic_max(running, 0, 1)

    return Clock(start, tick)
