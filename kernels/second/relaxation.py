"""Dilatancy over dt/2 at the beginning of a step (R), and v and phi of wet cells (D)."""

from typing import Any

import warp as wp

from warpgran.kernels.precision import Ints, Variant, precision
from warpgran.kernels.ranges import end_of, first_of, run_of
from warpgran.kernels.second.rheology import SecondRheology


def make(variant: Variant, rheology: SecondRheology, module: Any) -> Any:
    """The kernel of a variant."""
    kinds = precision(variant.precision)
    Real, A, Params = kinds.Real, kinds.Array, kinds.Params
    zero, half, one = Real(0.0), Real(0.5), Real(1.0)
    is_wet, relaxed = rheology.wet, rheology.relaxed

    @wp.kernel(module=module)
    def relax(
        # inputs
        U0: A, U1: A, dt: A,
        # per run
        params: Params, lo: Ints, hi: Ints, active: Ints, chunks: int,
        # outputs
        U2: A, v: A, phi_wet: A,
    ):  # fmt: skip
        """U2 after dt/2 of dilatancy, in place; v [m/s] and phi, 0 in dry cells."""
        thread = wp.tid()
        run = run_of(thread, chunks)
        p = params[run]
        i = first_of(thread, chunks, p.row, lo[run], hi[run])
        end = end_of(thread, chunks, p.row, lo[run], hi[run], active[run])
        tau = half * dt[run]
        while i < end:
            U0_i = U0[i]
            U2_i = U2[i]
            wet = is_wet(U0_i, U2_i)
            mass = wp.where(wet, U0_i, one)
            v_i, phi, U2_new = relaxed(mass, U1[i], wp.where(wet, U2_i, one), tau, p)
            U2[i] = wp.where(wet, U2_new, U2_i)
            v[i] = wp.where(wet, v_i, zero)
            phi_wet[i] = wp.where(wet, phi, zero)
            i += wp.block_dim()

    return relax
