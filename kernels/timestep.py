"""The time step of each run."""

from typing import Any

import warp as wp

from warpgran.kernels.precision import Doubles, Ints, Precision


def make(kinds: Precision, module: Any) -> Any:
    """The kernel of a precision; the module must be one that honours NaN."""
    Real, A, Params = kinds.Real, kinds.Array, kinds.Params

    @wp.kernel(module=module)
    def time_step(
        # inputs
        times: Doubles,
        # per run
        params: Params, active: Ints, t: Doubles, t_stop: Doubles, output: Ints,
        # outputs
        max_speed: A, max_viscosity: A, dt: A, dt_exact: Doubles, budget: Ints, running: Ints,
    ):  # fmt: skip
        """The least of the CFL limit, the parabolic limit and the time left to output or stop; resets the maxima."""
        run = wp.tid()
        if run == 0:
            budget[0] = budget[0] - 1
            running[0] = 0
        if active[run] == 0:
            return
        p = params[run]
        dx = wp.float64(p.dx)
        speed = wp.float64(max_speed[run])
        viscosity = wp.float64(p.xi_max) * wp.float64(max_viscosity[run])
        step = wp.min(times[output[run]], t_stop[run]) - t[run]
        if speed != wp.float64(0.0):  # true of a NaN too, which must not be taken for a run at rest
            step = wp.min(step, wp.float64(p.cfl) * dx / speed)
        if viscosity > wp.float64(0.0):
            step = wp.min(step, dx * dx / (wp.float64(2.0) * viscosity))
        dt_exact[run] = step
        dt[run] = Real(step)
        max_speed[run] = Real(0.0)
        max_viscosity[run] = Real(0.0)

    return time_step
