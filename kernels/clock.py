"""Time of each run: which runs go on, and when all of a batch have ended.

One thread a run. `status` tells why a run ended: see the codes. `running` is the condition of the time loop: 1 while
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
    """The kernels of this stage."""

    start: Any
    tick: Any


def make(kinds: Precision, module: Any) -> Clock:
    """The kernels of a precision; the module must be one that honours NaN."""
    Real, A, RunParams, Params = kinds.Real, kinds.Array, kinds.RunParams, kinds.Params

    @wp.kernel(module=module)
    def start(active: Ints, running: Ints):
        """Set the condition of the time loop."""
        wp.atomic_max(running, 0, active[wp.tid()])

    @wp.func
    def widen(U0: A, lo: Ints, hi: Ints, r: int, p: RunParams):
        """Keep an empty cell at each end of the window: mass moves by one cell a step."""
        if lo[r] > 0 and U0[p.row + lo[r]] != Real(0.0):
            lo[r] = lo[r] - _BLOCK
        if hi[r] < p.padded and U0[p.row + hi[r] - 1] != Real(0.0):
            hi[r] = hi[r] + _BLOCK

    @wp.kernel(module=module)
    def tick(
        U0: A, dt: Doubles, times: Doubles, output: Ints, params: Params, budget: Ints,
        t: Doubles, steps: Ints, status: Ints, active: Ints, due: Ints, lo: Ints, hi: Ints, running: Ints,
    ):  # fmt: skip
        """Advance the time of each run; retire those that have diverged or are out of steps."""
        r = wp.tid()
        if active[r] == 0:
            return
        p = params[r]
        widen(U0, lo, hi, r, p)
        steps[r] = steps[r] + 1
        t_out = times[output[r]]
        if dt[r] >= t_out - t[r]:  # the output limited the step: its time is met exactly
            t[r] = t_out
            due[r] = 1
        elif dt[r] > wp.float64(0.0) and t[r] + dt[r] > t[r]:
            t[r] = t[r] + dt[r]
            if steps[r] >= p.step_limit:
                status[r] = _STEP_LIMIT
                active[r] = 0
        else:  # a NaN, or a step too short to advance the time
            status[r] = _DIVERGED
            active[r] = 0
        if active[r] != 0 and budget[0] > 0:
            wp.atomic_max(running, 0, 1)

    return Clock(start, tick)
