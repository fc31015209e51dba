"""The two ends of the grid: ghost cells, and what the first and the last interface take from their neighbours.

One thread a run. Beyond a wall is the mirror image of the cell at the end; beyond an open end a copy of it, or its
mirror image where it flows into the grid, so that nothing flows in. Periodic ends: ../ghosts.py.
"""

from typing import Any, NamedTuple

import warp as wp

from warpgran.kernels.ghosts import make_after_decode, make_beyond, make_wrap
from warpgran.kernels.precision import Ints, Variant, precision


class SecondEnds(NamedTuple):
    """The kernels of this file by what they follow; None where there is nothing to do."""

    after_decode: Any
    after_cells: Any
    after_drive: Any
    after_faces: Any


def make(variant: Variant, module: Any) -> SecondEnds:
    """The kernels of a variant."""
    return (_periodic if variant.periodic else _apart)(variant, module)


def _apart(variant: Variant, module: Any) -> SecondEnds:
    """Walls and open ends."""
    kinds = precision(variant.precision)
    Real, A, Params = kinds.Real, kinds.Array, kinds.Params
    zero = Real(0.0)

    beyond = make_beyond(kinds)

    @wp.func
    def extend(q: A, s: A, c: A, inner: int, cell: int, ghost: int):
        """Set all but the velocity of a ghost cell: q changes there as between the last two cells, s and c do not."""
        q[ghost] = q[cell] + (q[cell] - q[inner])
        s[ghost] = s[cell]
        c[ghost] = c[cell]

    @wp.func
    def take(X: A, P: A, hold: A, unused: A, inner: int, end: int):
        """Let the interface at an end take X, P, unused of the next one (E2); its jump is 0 (E6), by hold = 0."""
        X[end] = X[inner]
        P[end] = P[inner]
        unused[end] = unused[inner]
        hold[end] = zero

    @wp.kernel(module=module)
    def after_drive(
        # per run
        params: Params, active: Ints,
        # outputs
        q: A, s: A, v: A, c: A, X: A, P: A, hold: A, unused: A,
    ):  # fmt: skip
        """Ghost cells, for the differences across the ends (E4); the interfaces at the ends."""
        run = wp.tid()
        if active[run] == 0:
            return
        p = params[run]
        first = p.row
        last = p.row + p.cells - 1
        extend(q, s, c, first + 1, first, first - 1)
        extend(q, s, c, last - 1, last, last + 1)
        v[first - 1] = p.v_left * v[first]
        v[last + 1] = p.v_right * v[last]
        take(X, P, hold, unused, first + 1, first)
        take(X, P, hold, unused, last, last + 1)

    @wp.kernel(module=module)
    def after_faces(
        # per run
        params: Params, active: Ints,
        # outputs
        SX: A, SP: A, q_L: A, q_R: A, s_L: A, s_R: A, v_L: A, v_R: A, c_L: A, c_R: A,
    ):  # fmt: skip
        """The faces of the ghost cells toward the grid (E6); these cells have no slopes."""
        run = wp.tid()
        if active[run] == 0:
            return
        p = params[run]
        first = p.row
        last = p.row + p.cells - 1
        SX[first - 1] = zero
        SP[first - 1] = zero
        SX[last + 1] = zero
        SP[last + 1] = zero
        q_R[first - 1] = q_L[first]
        s_R[first - 1] = s_L[first]
        c_R[first - 1] = c_L[first]
        v_R[first - 1] = beyond(v_L[first], Real(-1.0), p.v_left)
        q_L[last + 1] = q_R[last]
        s_L[last + 1] = s_R[last]
        c_L[last + 1] = c_R[last]
        v_L[last + 1] = beyond(v_R[last], Real(1.0), p.v_right)

    return SecondEnds(None, None, after_drive, after_faces)


def _periodic(variant: Variant, module: Any) -> SecondEnds:
    """Periodic ends."""
    kinds = precision(variant.precision)
    A, Params = kinds.Array, kinds.Params
    wrap = make_wrap(kinds)

    @wp.kernel(module=module)
    def after_cells(
        # per run
        params: Params, active: Ints,
        # outputs
        q: A, s: A, v: A, c: A, mu: A,
    ):  # fmt: skip
        """Ghost cells of what a state decodes to."""
        run = wp.tid()
        if active[run] != 0:
            p = params[run]
            wrap(q, p)
            wrap(s, p)
            wrap(v, p)
            wrap(c, p)
            wrap(mu, p)

    @wp.kernel(module=module)
    def after_faces(
        # per run
        params: Params, active: Ints,
        # outputs
        SX: A, SP: A, q_L: A, q_R: A, s_L: A, s_R: A, v_L: A, v_R: A, c_L: A, c_R: A,
    ):  # fmt: skip
        """Ghost cells of slopes, and the faces of ghost cells toward the grid."""
        run = wp.tid()
        if active[run] != 0:
            p = params[run]
            wrap(SX, p)
            wrap(SP, p)
            wrap(q_L, p)
            wrap(q_R, p)
            wrap(s_L, p)
            wrap(s_R, p)
            wrap(v_L, p)
            wrap(v_R, p)
            wrap(c_L, p)
            wrap(c_R, p)

    return SecondEnds(make_after_decode(kinds, module), after_cells, None, after_faces)
