"""Means over the finer cells of a start on finer cells: how a level hands over to a coarser one, see solve/start.py."""

from typing import Any

import warp as wp

from warpgran.kernels.precision import Ints, Precision
from warpgran.kernels.record import make_sound

_MOST = wp.constant(11)
"""One more than the most levels between two states."""


def make(kinds: Precision, module: Any) -> Any:
    """The kernel of a precision; the module must be one that honours NaN."""
    Real, A, Params = kinds.Real, kinds.Array, kinds.Params
    Halves = wp.types.vector(length=_MOST, dtype=Real)
    sound, half = make_sound(kinds), Real(0.5)

    @wp.func
    def mean(fine: A, first: int, levels: int) -> Real:
        """Mean of 2^levels elements, as that of pairs of pairs: the order of the sum is that of one level at a time."""
        left = Halves()  # by their size, the means of left halves that wait for their right ones
        x = Real(0.0)
        for k in range(1 << levels):
            x = fine[first + k]
            ends = int(k)  # k in binary ends in as many ones as there are halves that its element completes
            size = int(0)
            while ends % 2 == 1:
                x = half * (left[size] + x)
                ends = ends // 2
                size += 1
            left[size] = x
        return x

    @wp.kernel(module=module)
    def means(
        # inputs
        levels: int, fine_params: Params, fine_U0: A, fine_U1: A, fine_U2: A, to: Ints,
        # per run of the coarser state
        params: Params, due: Ints,
        # outputs
        U0: A, U1: A, U2: A,
    ):  # fmt: skip
        """Set each cell of run to[run] of the coarser state to the mean of 2^levels cells of the finer state's run.

        Runs with to < 0 are skipped. What is to be recorded must be sound in every finer cell: where one is not, the
        mean is NaN.
        """
        run, cell = wp.tid()
        target = to[run]
        if target < 0 or cell >= params[target].cells:
            return
        first = fine_params[run].row + cell * (1 << levels)
        at = params[target].row + cell
        U0[at] = mean(fine_U0, first, levels)
        U1[at] = mean(fine_U1, first, levels)
        U2[at] = mean(fine_U2, first, levels)
        if due[target] != 0:
            for i in range(first, first + (1 << levels)):
                if not sound(fine_U0[i], fine_U1[i], fine_U2[i]):
                    U0[at] = Real(wp.nan)

    return means
