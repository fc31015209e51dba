"""The two functions that everything is limited with: lim and clip."""

from typing import Any, NamedTuple

import warp as wp

from warpgran.kernels.precision import Precision


class Limiter(NamedTuple):
    """Functions of a precision; see each below."""

    lim: Any
    half_lim: Any
    clip: Any


def make(kinds: Precision) -> Limiter:
    """The functions of a precision."""
    Real = kinds.Real
    zero, quarter, half = Real(0.0), Real(0.25), Real(0.5)

    @wp.func
    def clip(x: Real, M: Real) -> Real:
        """The number in [-M, M] that is nearest to x."""
        return wp.min(wp.max(x, -M), M)

    # The same in two forms, each the faster one where it is used: one has fewer minima and maxima, the other fewer
    # operations that wait for another.
    @wp.func
    def lim(a: Real, b: Real) -> Real:
        """The mean, no more than twice the smaller one; 0 where signs differ (t = 2)."""
        least = wp.min(wp.abs(a), wp.abs(b))
        return clip(half * (a + b), wp.where(a * b > zero, least + least, zero))

    @wp.func
    def half_lim(a: Real, b: Real, t_2: Real) -> Real:
        """Half the mean, no more than t/2 times the smaller one; 0 where signs differ. t_2: t/2."""
        low, high = wp.min(wp.max(a, b), zero), wp.max(wp.min(a, b), zero)
        return wp.min(wp.max(quarter * (a + b), t_2 * low), t_2 * high)

    return Limiter(lim, half_lim, clip)
