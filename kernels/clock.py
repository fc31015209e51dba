"""Time of each run: which runs go on, and when all of a batch have reached the output time.

One thread a run. `status` tells why a run ended: see the codes. `running` is the condition of the time loop: 1 while
some run has not reached the output time and the loop has steps left in its `budget`.
"""

from typing import Any, NamedTuple

import warp as wp
from warpgran.kernels.precision import BLOCK, Doubles, Ints, Variant, precision

OK = 0
DIVERGED = 1
STEP_LIMIT = 2
"""Codes of a run's status; a run with another status than OK is not advanced."""

_BLOCK = wp.constant(BLOCK)
_OK = wp.constant(OK)
_DIVERGED = wp.constant(DIVERGED)
_STEP_LIMIT = wp.constant(STEP_LIMIT)


class Clock(NamedTuple):
    """The kernels of this stage."""

    start: Any
    tick: Any


def make(variant: Variant, module: Any) -> Clock:
    """The kernels of a variant; the module must be one that honours NaN."""
    kinds = precision(variant.precision)
    Real, A, RunParams, Params = kinds.Real, kinds.Array, kinds.RunParams, kinds.Params

    @wp.kernel(module=module)
    def start(
        t: Doubles, t_out: Doubles, status: Ints,
        active: Ints, running: Ints,
    ):  # fmt: skip
        """Wake the runs that have not reached t_out [s]."""
        r = wp.tid()
        go = wp.where(status[r] == _OK and t[r] < t_out[0], 1, 0)
        active[r] = go
        wp.atomic_max(running, 0, go)

    @wp.func
    def widen(U0: A, lo: Ints, hi: Ints, r: int, p: RunParams):
        """Keep an empty cell at each end of the window: mass moves by one cell a step."""
        if lo[r] > 0 and U0[p.row + lo[r]] != Real(0.0):
            lo[r] = lo[r] - _BLOCK
        if hi[r] < p.padded and U0[p.row + hi[r] - 1] != Real(0.0):
            hi[r] = hi[r] + _BLOCK

    @wp.kernel(module=module)
    def tick(
        U0: A, dt: Doubles, t_out: Doubles, params: Params,
        budget: Ints,
        t: Doubles, steps: Ints, status: Ints,
        active: Ints, lo: Ints, hi: Ints, running: Ints,
    ):  # fmt: skip
        """Advance the time of each run; retire those at the output time, diverged or out of steps."""
        r = wp.tid()
        if active[r] != 0:
            p = params[r]
            widen(U0, lo, hi, r, p)
            steps[r] = steps[r] + 1
            if dt[r] >= t_out[0] - t[r]:  # the output limited the step: its time is met exactly
                t[r] = t_out[0]
                active[r] = 0
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
