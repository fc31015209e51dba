"""Periodic ends: the interfaces on the left of cell 0 and on the right of the last cell are one and the same.

Each ghost cell is a copy of the cell at the other end, so that both interfaces are computed from the same numbers, to
the same bits. The state U of the right ghost cell is computed with the others and means nothing: whatever is read of
it is wrapped first.
"""

from typing import Any, NamedTuple

import warp as wp

from warpgran.kernels.precision import Ints, Variant, precision


class Periodic(NamedTuple):
    """The kernels of this stage."""

    boundary: Any
    wrap: Any


def make(variant: Variant, module: Any) -> Periodic:
    """The kernels of a variant."""
    kinds = precision(variant.precision)
    A, RunParams, Params = kinds.Array, kinds.RunParams, kinds.Params

    @wp.func
    def wrap_row(a: A, p: RunParams):
        """Set the ghost cells of a run."""
        a[p.row - 1] = a[p.row + p.cells - 1]
        a[p.row + p.cells] = a[p.row]

    @wp.kernel(module=module)
    def boundary(params: Params, active: Ints, h: A, v: A, phi: A, mu: A, per_mass: A, celerity: A):
        """Ghost cells of what a state decodes to.

        Behind the right ghost cell friction is -mu, so that Dz and iota are exactly 0 there: no mass leaks into the
        padding.
        """
        r = wp.tid()
        p = params[r]
        if active[r] != 0:
            wrap_row(h, p)
            wrap_row(v, p)
            wrap_row(phi, p)
            wrap_row(mu, p)
            wrap_row(per_mass, p)
            wrap_row(celerity, p)
            mu[p.row + p.cells + 1] = -mu[p.row]

    @wp.kernel(module=module)
    def wrap(params: Params, active: Ints, a: A):
        """Ghost cells of one array."""
        r = wp.tid()
        if active[r] != 0:
            wrap_row(a, params[r])

    return Periodic(boundary, wrap)
