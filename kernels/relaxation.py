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
    dry, tiny = Real(DRY), Real(kinds.tiny)
    power, unpack, inertia, phi_equilibrium = (
        rheology.power,
        rheology.unpack,
        rheology.inertia,
        rheology.phi_equilibrium,
    )

    # What is left of phi - phi_eq after a step as a fraction; rate/h_e is dt gamma K phi.
    @wp.func
    def rational(rate: Real, h_e: Real):
        """1/(1 + dt gamma K phi) (3.17)."""
        return h_e, h_e + rate

    @wp.func
    def exponential(rate: Real, h_e: Real):
        """exp(-dt gamma K phi) (3.18)."""
        return wp.exp(-rate / h_e), Real(1.0)

    remaining = {"rational": rational, "exponential": exponential}[variant.relaxation]

    @wp.func
    def relaxed(h: Real, v: Real, phi: Real, dt: Real, p: RunParams) -> Real:
        """Volume fraction after dilatancy has acted for dt [s] (3.15)."""
        h_e = wp.max(h, p.h_min)
        num, den = inertia(h_e, v, phi, p)
        top, bottom = phi_equilibrium(num, den, p)
        left, whole = remaining(dt * Real(2.5) * wp.abs(v) * p.K * phi, h_e)
        r = Real(1.0) / (bottom * whole)
        phi_eq = top * (whole * r)
        return phi_eq + (phi - phi_eq) * (left * (bottom * r))

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
            some = U0_i > tiny
            wet = U0_i > dry and U2_i > Real(0.0)
            per_U0, phi, h = unpack(wp.where(some, U0_i, Real(1.0)), wp.where(wet, U2_i, Real(1.0)), p)
            phi_after = relaxed(h, U1[i] * per_U0, phi, step, p)
            s_i = wp.where(wet, power(phi_after, p), wp.where(some, U2_i * per_U0, Real(0.0)))
            s[i] = s_i
            U2[i] = wp.where(wet, U0_i * s_i, U2_i)
            i += wp.block_dim()

    return relax
