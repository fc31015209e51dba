"""Steps 3 and 4: velocities and driving slopes at interfaces, and the time step of each run."""

from typing import Any

import warp as wp

from warpgran.kernels.lanes import Lanes, lane_of
from warpgran.kernels.precision import DRY, Doubles, Ints, Precision, Variant, precision
from warpgran.kernels.ranges import before_first, end_of, run_of
from warpgran.kernels.rheology import Rheology


def make_limits(variant: Variant, rheology: Rheology, lanes: Lanes, module: Any) -> Any:
    """The kernel that looks at all cells."""
    kinds = precision(variant.precision)
    Real, A, RunParams, Params = kinds.Real, kinds.Array, kinds.RunParams, kinds.Params
    empty = Real(0.1 * DRY)  # less than any wet cell holds
    power = rheology.power
    most = lanes.most

    @wp.func
    def at_face(h_l: Real, v_l: Real, phi_l: Real, h_r: Real, v_r: Real, phi_r: Real, dbhat: Real, p: RunParams):
        """Mass-weighted velocity [m/s] (3.8), 0 between dry cells; X (3.12), the slope pressure and gravity drive."""
        rho_l = phi_l * h_l
        rho_r = phi_r * h_r
        rho = wp.max(rho_l + rho_r, empty)
        p_l = power(phi_l, p)
        p_r = power(phi_r, p)
        r = Real(1.0) / (rho * (p_l + p_r))  # for both quotients
        X = (h_l - h_r - dbhat + (h_l + h_r) * (p_l - p_r) * (rho * r) * p.per_2a) * p.per_dx
        return (rho_l * v_l + rho_r * v_r) * ((p_l + p_r) * r), X

    @wp.func
    def viscosity_bound(v_f: Real, dbhat: Real, mu_l: Real, mu_r: Real, p: RunParams) -> Real:
        """Bound of v_f Dz that does not depend on dt [m2/s], for (3.22)."""
        return v_f * dbhat + wp.abs(v_f) * Real(0.5) * (mu_l + mu_r) * p.dx

    @wp.kernel(module=module)
    def limits(
        h: A, v: A, phi: A, mu: A, celerity: A, dbhat: A, params: Params, lo: Ints, hi: Ints,
        active: Ints, chunks: int,
        v_f: A, X: A, max_speed: A, max_viscosity: A,
    ):  # fmt: skip
        """v_f and X of interfaces, and what limits the step of a run: its fastest wave and its viscosity bound."""
        t = wp.tid()
        r = run_of(t, chunks)
        p = params[r]
        left = before_first(t, chunks, p.row, lo[r], hi[r])
        end = end_of(t, chunks, p.row, lo[r], hi[r], active[r]) - 1
        beyond = p.row + p.cells  # from the last interface on, elements of no interior interface
        speed = Real(0.0)
        viscosity = Real(0.0)
        while left < end:
            i = left + 1
            v_i, X_i = at_face(h[left], v[left], phi[left], h[i], v[i], phi[i], dbhat[i], p)
            v_f[i] = v_i
            X[i] = X_i
            bound = viscosity_bound(v_i, dbhat[i], mu[left], mu[i], p)
            viscosity = wp.max(viscosity, wp.where(i < beyond, bound, Real(0.0)))
            speed = wp.max(speed, wp.abs(v[i]) + celerity[i])
            left += wp.block_dim()
        speed = most(speed)
        viscosity = most(viscosity)
        if lane_of(t) == 0 and active[r] != 0:
            wp.atomic_max(max_speed, r, speed)
            wp.atomic_max(max_viscosity, r, viscosity)

    return limits


def make_time_step(kinds: Precision, module: Any) -> Any:
    """The kernel that chooses the step of each run; the module must be one that honours NaN."""
    Real, A, Params = kinds.Real, kinds.Array, kinds.Params

    @wp.kernel(module=module)
    def time_step(
        params: Params, active: Ints, t: Doubles, times: Doubles, output: Ints, max_speed: A, max_viscosity: A,
        dt: A, dt_exact: Doubles, budget: Ints, running: Ints,
    ):  # fmt: skip
        """The least of the CFL limit, the parabolic limit and the time left to the output; resets the maxima."""
        r = wp.tid()
        if r == 0:
            budget[0] = budget[0] - 1
            running[0] = 0
        if active[r] == 0:
            return
        p = params[r]
        dx = wp.float64(p.dx)
        speed = wp.float64(max_speed[r])
        viscosity = wp.float64(p.xi_max) * wp.float64(max_viscosity[r])
        step = times[output[r]] - t[r]
        if speed != wp.float64(0.0):  # true of a NaN too, which must not be taken for a run at rest
            step = wp.min(step, wp.float64(p.cfl) * dx / speed)
        if viscosity > wp.float64(0.0):
            step = wp.min(step, dx * dx / (wp.float64(2.0) * viscosity))
        dt_exact[r] = step
        dt[r] = Real(step)
        max_speed[r] = Real(0.0)
        max_viscosity[r] = Real(0.0)

    return time_step
