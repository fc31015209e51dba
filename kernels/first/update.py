"""Finite volume update."""

from typing import Any

import warp as wp

from warpgran.kernels.precision import Ints, Variant, precision
from warpgran.kernels.ranges import end_of, first_of, run_of


def make(variant: Variant, module: Any) -> Any:
    """The kernel of a variant."""
    kinds = precision(variant.precision)
    Real, A, Params = kinds.Real, kinds.Array, kinds.Params

    @wp.kernel(module=module)
    def update(
        # inputs
        U0: A, U1: A, U2: A, F0: A, F1_l: A, F1_r: A, F2: A, dt: A,
        # per run
        params: Params, lo: Ints, hi: Ints, active: Ints, chunks: int,
        # outputs
        W0: A, W1: A, W2: A,
    ):  # fmt: skip
        """W = U - dt/dx (flux out - flux in) (3.5)."""
        thread = wp.tid()
        run = run_of(thread, chunks)
        p = params[run]
        i = first_of(thread, chunks, p.row, lo[run], hi[run])
        end = end_of(thread, chunks, p.row, lo[run], hi[run], active[run])
        beyond = p.row + p.cells  # the ghost cell and the padding are not updated
        dt_dx = dt[run] / p.dx
        while i < end:
            ratio = wp.where(i < beyond, dt_dx, Real(0.0))
            W0[i] = U0[i] - ratio * (F0[i + 1] - F0[i])
            W1[i] = U1[i] - ratio * (F1_l[i + 1] - F1_r[i])
            W2[i] = U2[i] - ratio * (F2[i + 1] - F2[i])
            i += wp.block_dim()

    return update
