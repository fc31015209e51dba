"""The two ends of the grid: ghost cells, one thread a run.

A wall mirrors the cell at the end. An open end copies it, or mirrors it where it flows into the grid, so that nothing
flows in. Periodic ends are in ../ghosts.py; with them the state U of the right ghost cell is computed with the others
but means nothing: whoever reads it wraps it first.
"""

from typing import Any, NamedTuple

import warp as wp

from warpgran.kernels.ghosts import make_after_decode, make_beyond, make_wrap
from warpgran.kernels.precision import Ints, Variant, precision


class FirstEnds(NamedTuple):
    """The kernels of this file by what they follow; None where there is nothing to do."""

    after_decode: Any
    after_fill: Any
    after_relax: Any


def make(variant: Variant, module: Any) -> FirstEnds:
    """The kernels of a variant."""
    return (_periodic if variant.periodic else _apart)(variant, module)


def _apart(variant: Variant, module: Any) -> FirstEnds:
    """Walls and open ends."""
    kinds = precision(variant.precision)
    Real, A, Params = kinds.Real, kinds.Array, kinds.Params

    beyond = make_beyond(kinds)

    @wp.func
    def set_ghost(h: A, v: A, phi: A, mu: A, per_mass: A, celerity: A, ghost: int, cell: int, v_ghost: Real):
        h[ghost] = h[cell]
        v[ghost] = v_ghost
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
            first = p.row
            last = p.row + p.cells - 1
            v_before = beyond(v[first], Real(-1.0), p.v_left)
            v_after = beyond(v[last], Real(1.0), p.v_right)
            set_ghost(h, v, phi, mu, per_mass, celerity, first - 1, first, v_before)
            set_ghost(h, v, phi, mu, per_mass, celerity, last + 1, last, v_after)

    return FirstEnds(None, after_fill, None)


def _periodic(variant: Variant, module: Any) -> FirstEnds:
    """Periodic ends."""
    kinds = precision(variant.precision)
    A, Params = kinds.Array, kinds.Params
    wrap = make_wrap(kinds)

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

    return FirstEnds(make_after_decode(kinds, module), after_fill, after_relax)
