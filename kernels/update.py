"""Step 9: finite volume update."""

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
        U0: A, U1: A, U2: A, F0: A, F1_l: A, F1_r: A, F2: A, dt: A, params: Params,
        lo: Ints, hi: Ints, active: Ints, chunks: int,
        U0_new: A, U1_new: A, U2_new: A,
    ):  # fmt: skip
        """U -= dt/dx (flux out - flux in) (3.5)."""
        t = wp.tid()
        r = run_of(t, chunks)
        p = params[r]
        i = first_of(t, chunks, p.row, lo[r], hi[r])
        end = end_of(t, chunks, p.row, lo[r], hi[r], active[r])
        beyond = p.row + p.cells  # the ghost cell and the padding are not updated
        ratio = dt[r] / p.dx
        while i < end:
            k = wp.where(i < beyond, ratio, Real(0.0))
            U0_new[i] = U0[i] - k * (F0[i + 1] - F0[i])
            U1_new[i] = U1[i] - k * (F1_l[i + 1] - F1_r[i])
            U2_new[i] = U2[i] - k * (F2[i + 1] - F2[i])
            i += wp.block_dim()

    return update
