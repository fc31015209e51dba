"""The two ends of the grid: ghost cells, one thread a run.

A wall mirrors the cell at the end, an open end copies it. Periodic ends are one and the same interface: each ghost cell
is a copy of the cell at the other end, so that both are computed from the same numbers, to the same bits. The state U
of the right ghost cell is computed with the others and means nothing: what is read of it is wrapped first.
"""

from typing import Any, NamedTuple

import warp as wp

from warpgran.kernels.precision import Ints, Variant, precision


class Ends(NamedTuple):
    """The kernels of this file by what they follow; None where there is nothing to do."""

    after_decode: Any
    after_fill: Any
    after_relax: Any


def make(variant: Variant, module: Any) -> Ends:
    """The kernels of a variant."""
    return (_periodic if variant.periodic else _apart)(variant, module)


def _apart(variant: Variant, module: Any) -> Ends:
    """Walls and open ends."""
    kinds = precision(variant.precision)
    Real, A, Params = kinds.Real, kinds.Array, kinds.Params

    @wp.func
    def set_ghost(h: A, v: A, phi: A, mu: A, per_mass: A, celerity: A, ghost: int, cell: int, v_factor: Real):
        h[ghost] = h[cell]
        v[ghost] = v_factor * v[cell]
        phi[ghost] = phi[cell]
        mu[ghost] = -mu[cell]
        per_mass[ghost] = per_mass[cell]
        celerity[ghost] = celerity[cell]

    @wp.kernel(module=module)
    def after_fill(
        # per run
        params: Params, active: Ints,
        # outputs
        h: A, v: A, phi: A, mu: A, per_mass: A, celerity: A,
    ):  # fmt: skip
        """Ghost cells of what a state decodes to.

        The ghost's friction is -mu, so that the interface friction, and with it Dz and iota, is exactly 0 there.
        """
        run = wp.tid()
        p = params[run]
        if active[run] != 0:
            set_ghost(h, v, phi, mu, per_mass, celerity, p.row - 1, p.row, p.v_left)
            set_ghost(h, v, phi, mu, per_mass, celerity, p.row + p.cells, p.row + p.cells - 1, p.v_right)

    return Ends(None, after_fill, None)


def _periodic(variant: Variant, module: Any) -> Ends:
    """Periodic ends."""
    kinds = precision(variant.precision)
    A, RunParams, Params = kinds.Array, kinds.RunParams, kinds.Params

    @wp.func
    def wrap(a: A, p: RunParams):
        """Set the ghost cells of a run."""
        a[p.row - 1] = a[p.row + p.cells - 1]
        a[p.row + p.cells] = a[p.row]

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

    @wp.kernel(module=module)
    def after_fill(
        # per run
        params: Params, active: Ints,
        # outputs
        h: A, v: A, phi: A, mu: A, per_mass: A, celerity: A,
    ):  # fmt: skip
        """Ghost cells of what a state decodes to.

        Behind the right ghost cell friction is -mu, so that Dz and iota are exactly 0 there: no mass leaks into the
        padding.
        """
        run = wp.tid()
        p = params[run]
        if active[run] != 0:
            wrap(h, p)
            wrap(v, p)
            wrap(phi, p)
            wrap(mu, p)
            wrap(per_mass, p)
            wrap(celerity, p)
            mu[p.row + p.cells + 1] = -mu[p.row]

    @wp.kernel(module=module)
    def after_relax(
        # per run
        params: Params, active: Ints,
        # outputs
        W0: A, W1: A, W2: A, c: A,
    ):  # fmt: skip
        """Ghost cells of the state that the viscosity reads."""
        run = wp.tid()
        p = params[run]
        if active[run] != 0:
            wrap(W0, p)
            wrap(W1, p)
            wrap(W2, p)
            wrap(c, p)

    return Ends(after_decode, after_fill, after_relax)
