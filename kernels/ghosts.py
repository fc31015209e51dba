"""Periodic ends: the interfaces on the left of cell 0 and on the right of the last cell are one and the same.

Each ghost cell is a copy of the cell at the other end, so that both interfaces are computed from the same numbers, to
the same bits.
"""

import functools
from typing import Any

import warp as wp

from warpgran.kernels.precision import Precision


@functools.cache
def make_wrap(kinds: Precision) -> Any:
    """The function of a precision that sets the ghost cells of an array."""
    A, RunParams = kinds.Array, kinds.RunParams

    @wp.func
    def wrap(a: A, p: RunParams):
        """Set the ghost cells of a run."""
        a[p.row - 1] = a[p.row + p.cells - 1]
        a[p.row + p.cells] = a[p.row]

    return wrap
