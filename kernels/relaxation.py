"""Step 10: dilatancy, the relaxation of phi toward phi_eq."""

from typing import Any

import warp as wp
from warpgran.kernels.precision import DRY, Ints, Variant, precision
from warpgran.kernels.ranges import end_of, first_of, run_of
from warpgran.kernels.rheology import Rheology


def make(variant: Variant, rheology: Rheology, module: Any) -> Any:
    """The kernel of a variant."""
    kinds = precision(variant.precision)
    Real, A, RunParams, Params = kinds.Real, kinds.Array, kinds.RunParams, kinds.Params
    dry = Real(DRY)
    power, root, inertia, phi_equilibrium = rheology.power, rheology.root, rheology.inertia, rheology.phi_equilibrium

    # What is left of phi - phi_eq after a step: rate/h_e is dt gamma K phi; h_e [m] is kept apart to save a division.
    @wp.func
    def remaining_rational(rate: Real, h_e: Real) -> Real:
        """1/(1 + dt gamma K phi) (3.17)."""
        return h_e / (h_e + rate)

    @wp.func
    def remaining_exponential(rate: Real, h_e: Real) -> Real:
        """exp(-dt gamma K phi) (3.18)."""
        return wp.exp(-rate / h_e)

    remaining = {"rational": remaining_rational, "exponential": remaining_exponential}[variant.relaxation]

    @wp.func
    def relaxed(h: Real, v: Real, phi: Real, dt: Real, p: RunParams) -> Real:
        """Volume fraction after dilatancy has acted for dt [s] (3.15)."""
        h_e = wp.max(h, p.h_min)
        num, den = inertia(h_e, v, phi, p)
        phi_eq = phi_equilibrium(num, den, p)
        rate = dt * Real(2.5) * wp.abs(v) * p.K * phi
        return phi_eq + (phi - phi_eq) * remaining(rate, h_e)

    @wp.kernel(module=module)
    def relax(
        U0: A, U1: A, dt: A, params: Params, lo: Ints, hi: Ints,
        active: Ints, chunks: int,
        U2: A, s: A,
    ):  # fmt: skip
        """U2 of wet cells after relaxation, in place; s = U2/U0 of every cell, for the viscosity."""
        t = wp.tid()
        r = run_of(t, chunks)
        p = params[r]
        i = first_of(t, chunks, p.row, lo[r], hi[r])
        end = end_of(t, chunks, p.row, lo[r], hi[r], active[r])
        step = dt[r]
        while i < end:
            U0_i = U0[i]
            U2_i = U2[i]
            some = U0_i > Real(0.0)
            mass = wp.where(some, U0_i, Real(1.0))
            per_mass = Real(1.0) / mass
            s_before = wp.where(some, U2_i * per_mass, Real(0.0))
            wet = U0_i > dry and U2_i > Real(0.0)
            phi = root(wp.where(wet, s_before, Real(1.0)), p)
            phi_after = relaxed(mass / phi, U1[i] * per_mass, phi, step, p)
            s_i = wp.where(wet, power(phi_after, p), s_before)
            s[i] = s_i
            U2[i] = wp.where(wet, mass * s_i, U2_i)
            i += wp.block_dim()

    return relax
