"""Ghost cells, as both schemes set them.

A wall mirrors the cell at the end. An open end copies it, or mirrors it where it flows into the grid, so that nothing
flows in. With periodic ends the interfaces on the left of cell 0 and on the right of the last cell are one and the
same: each ghost cell is a copy of the cell at the other end, so that both are computed from the same numbers, to the
same bits.
"""

import functools
from typing import Any

import warp as wp

from warpgran.kernels.precision import Ints, Precision


@functools.cache
def make_beyond(kinds: Precision) -> Any:
    """The function of a precision that tells the velocity beyond an end."""
    Real = kinds.Real

    @wp.func
    def beyond(v: Real, outward: Real, v_factor: Real) -> Real:
        """Velocity [m/s] beyond an end. outward: 1 at the right end, -1 at the left; v_factor: -1 wall, 1 open."""
        return wp.where(v_factor < Real(0.0), -v, outward * wp.abs(v))

    return beyond


@functools.cache
def make_wrap(kinds: Precision) -> Any:
    """The function of a precision that sets the ghost cells of an array of a run with periodic ends."""
    A, RunParams = kinds.Array, kinds.RunParams

    @wp.func
    def wrap(a: A, p: RunParams):
        """Set the ghost cells of a run."""
        a[p.row - 1] = a[p.row + p.cells - 1]
        a[p.row + p.cells] = a[p.row]

    return wrap


def make_after_decode(kinds: Precision, module: Any) -> Any:
    """The kernel that sets the ghost cells of what dry cells are filled from, for periodic ends."""
    A, Params = kinds.Array, kinds.Params
    wrap = make_wrap(kinds)

    @wp.kernel(module=module)
    def after_decode(
        # per run
        params: Params, active: Ints,
        # outputs
        phi_wet: A,
    ):  # fmt: skip
        """Ghost cells of what dry cells are filled from."""
        run = wp.tid()
        if active[run] != 0:
            wrap(phi_wet, params[run])

    return after_decode
