"""Step 10: dilatancy, the relaxation of phi toward phi_eq."""

from typing import Any

import warp as wp

from warpgran.kernels.precision import DRY, Ints, Variant, precision
from warpgran.kernels.ranges import end_of, first_of, run_of
from warpgran.kernels.rheology import Rheology

NOTHING = 1e-30
"""A cell that holds less solid than this (m) counts as empty where s = U2/U0 is made: far below a rounding of any mass,
far above what would underflow."""


def make(variant: Variant, rheology: Rheology, module: Any) -> Any:
    """The kernel of a variant."""
    kinds = precision(variant.precision)
    Real, A, Params = kinds.Real, kinds.Array, kinds.Params
    dry, nothing = Real(DRY), Real(NOTHING)
    power, relaxed = rheology.power, rheology.relaxed

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
            some = U0_i > nothing
            wet = U0_i > dry and U2_i > Real(0.0)
            per_U0, phi = relaxed(wp.where(some, U0_i, Real(1.0)), U1[i], wp.where(wet, U2_i, Real(1.0)), step, p)
            s_i = wp.where(wet, power(phi, p), wp.where(some, U2_i * per_U0, Real(0.0)))
            s[i] = s_i
            U2[i] = wp.where(wet, U0_i * s_i, U2_i)
            i += wp.block_dim()

    return relax
