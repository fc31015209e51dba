"""Velocities and driving slopes at interfaces, and what of them limits the time step."""

from typing import Any, NamedTuple

import warp as wp

from warpgran.kernels.lanes import Lanes, lane_of
from warpgran.kernels.laws import Laws
from warpgran.kernels.precision import DRY, Ints, Variant, precision
from warpgran.kernels.ranges import before_first, end_of, run_of


class FirstDrive(NamedTuple):
    """The kernel of this file, and its functions."""

    drive: Any
    at_face: Any
    viscosity_bound: Any


def make(variant: Variant, laws: Laws, lanes: Lanes, module: Any) -> FirstDrive:
    """The kernel of a variant."""
    kinds = precision(variant.precision)
    Real, A, RunParams, Params = kinds.Real, kinds.Array, kinds.RunParams, kinds.Params
    empty = Real(0.1 * DRY)  # less than any wet cell holds
    power = laws.power
    most = lanes.most

    @wp.func
    def at_face(h_l: Real, v_l: Real, phi_l: Real, h_r: Real, v_r: Real, phi_r: Real, dbhat: Real, p: RunParams):
        """Mass-weighted velocity [m/s] (3.8), 0 between dry cells; X (3.12), the slope pressure and gravity drive."""
        rho_l = phi_l * h_l
        rho_r = phi_r * h_r
        rho = wp.max(rho_l + rho_r, empty)
        c_l = power(phi_l, p)
        c_r = power(phi_r, p)
        per_both = Real(1.0) / (rho * (c_l + c_r))
        X = (h_l - h_r - dbhat + (h_l + h_r) * (c_l - c_r) * (rho * per_both) * p.per_2a) * p.per_dx
        return (rho_l * v_l + rho_r * v_r) * ((c_l + c_r) * per_both), X

    @wp.func
    def viscosity_bound(v_f: Real, dbhat: Real, mu_l: Real, mu_r: Real, p: RunParams) -> Real:
        """Bound of v_f Dz that does not depend on dt [m2/s], for (3.22)."""
        return v_f * dbhat + wp.abs(v_f) * Real(0.5) * (mu_l + mu_r) * p.dx

    @wp.kernel(module=module)
    def drive(
        # inputs
        h: A, v: A, phi: A, mu: A, celerity: A, dbhat: A,
        # per run
        params: Params, lo: Ints, hi: Ints, active: Ints, chunks: int,
        # outputs
        v_f: A, X: A, max_speed: A, max_viscosity: A,
    ):  # fmt: skip
        """v_f and X of interfaces; the fastest wave of a run and the bound of its viscosity."""
        thread = wp.tid()
        run = run_of(thread, chunks)
        p = params[run]
        left = before_first(thread, chunks, p.row, lo[run], hi[run])
        end = end_of(thread, chunks, p.row, lo[run], hi[run], active[run]) - 1
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
        if lane_of(thread) == 0 and active[run] != 0:
            wp.atomic_max(max_speed, run, speed)
            wp.atomic_max(max_viscosity, run, viscosity)

    return FirstDrive(drive, at_face, viscosity_bound)
