"""Dilatancy, the relaxation of phi toward phi_eq."""

from typing import Any

import warp as wp

from warpgran.kernels.first.rheology import FirstRheology
from warpgran.kernels.laws import Laws
from warpgran.kernels.precision import DRY, Ints, Variant, precision
from warpgran.kernels.ranges import end_of, first_of, run_of

NOTHING = 1e-30
"""A cell that holds less solid than this (m) counts as empty where c = U2/U0 is made: far below a rounding of any mass,
far above what would underflow."""


def make(variant: Variant, laws: Laws, rheology: FirstRheology, module: Any) -> Any:
    """The kernel of a variant."""
    kinds = precision(variant.precision)
    Real, A, Params = kinds.Real, kinds.Array, kinds.Params
    dry, nothing = Real(DRY), Real(NOTHING)
    power, relaxed = laws.power, rheology.relaxed

    @wp.kernel(module=module)
    def relax(
        # inputs
        W0: A, W1: A, dt: A,
        # per run
        params: Params, lo: Ints, hi: Ints, active: Ints, chunks: int,
        # outputs
        W2: A, c: A,
    ):  # fmt: skip
        """W2 of wet cells after relaxation, in place; c = W2/W0 of every cell, for the viscosity."""
        thread = wp.tid()
        run = run_of(thread, chunks)
        p = params[run]
        i = first_of(thread, chunks, p.row, lo[run], hi[run])
        end = end_of(thread, chunks, p.row, lo[run], hi[run], active[run])
        step = dt[run]
        while i < end:
            W0_i = W0[i]
            W2_i = W2[i]
            some = W0_i > nothing
            wet = W0_i > dry and W2_i > Real(0.0)
            per_W0, phi = relaxed(wp.where(some, W0_i, Real(1.0)), W1[i], wp.where(wet, W2_i, Real(1.0)), step, p)
            c_i = wp.where(wet, power(phi, p), wp.where(some, W2_i * per_W0, Real(0.0)))
            c[i] = c_i
            W2[i] = wp.where(wet, W0_i * c_i, W2_i)
            i += wp.block_dim()

    return relax
