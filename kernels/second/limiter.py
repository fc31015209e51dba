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

    # lim without a test of signs and without a size: the mean, between two bounds of which at least one is 0. A form
    # with sums and sizes is as fast, but not as accurate where one number is much smaller: in float32 it shows.
    @wp.func
    def bounds(a: Real, b: Real):
        """Where what has the sign of both numbers and is no larger than either begins and ends."""
        return wp.min(wp.max(a, b), zero), wp.max(wp.min(a, b), zero)

    @wp.func
    def lim(a: Real, b: Real) -> Real:
        """The mean, no more than twice the smaller one; 0 where signs differ (t = 2)."""
        low, high = bounds(a, b)
        return wp.min(wp.max(half * (a + b), low + low), high + high)

    @wp.func
    def half_lim(a: Real, b: Real, t_2: Real) -> Real:
        """Half the mean, no more than t/2 times the smaller one; 0 where signs differ. t_2: t/2."""
        low, high = bounds(a, b)
        return wp.min(wp.max(quarter * (a + b), t_2 * low), t_2 * high)

    return Limiter(lim, half_lim, clip)
