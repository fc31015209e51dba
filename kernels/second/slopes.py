"""Slopes of the drive in cells, and the allowance of friction that X has not used up (E3)."""

from typing import Any

import warp as wp

from warpgran.kernels.precision import Ints, Variant, precision
from warpgran.kernels.ranges import end_of, first_of, run_of
from warpgran.kernels.second.limiter import Limiter


def make(variant: Variant, limiter: Limiter, module: Any) -> Any:
    """The kernel of a variant."""
    kinds = precision(variant.precision)
    Real, A, Params = kinds.Real, kinds.Array, kinds.Params
    zero = Real(0.0)
    lim = limiter.lim

    @wp.kernel(module=module)
    def slopes(
        # inputs
        X: A, P: A, unused: A, dt: A,
        # per run
        params: Params, lo: Ints, hi: Ints, active: Ints, chunks: int,
        # outputs
        SX: A, SP: A, allowance: A,
    ):  # fmt: skip
        """SX, SP [m] and allowance [m/s] of each cell, wet or dry, from the interfaces on both sides of it."""
        thread = wp.tid()
        run = run_of(thread, chunks)
        p = params[run]
        i = first_of(thread, chunks, p.row, lo[run], hi[run])
        end = end_of(thread, chunks, p.row, lo[run], hi[run], active[run])
        g_dt = p.g_c * dt[run]
        while i < end:
            SX[i] = -lim(X[i], X[i + 1])
            SP[i] = lim(P[i], P[i + 1])
            allowance[i] = g_dt * wp.max(zero, wp.min(unused[i], unused[i + 1]))
            i += wp.block_dim()

    return slopes
