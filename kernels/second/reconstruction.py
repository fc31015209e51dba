"""The jump that remains at an interface beside the slopes of its cells, and q* on its two sides (E5)."""

from typing import Any, NamedTuple

import warp as wp

from warpgran.kernels.precision import Precision
from warpgran.kernels.second.limiter import Limiter


class SecondReconstruction(NamedTuple):
    """Functions of a precision; see each below."""

    jump: Any
    reconstructed: Any


def make(kinds: Precision, limiter: Limiter) -> SecondReconstruction:
    """The functions of a precision."""
    Real = kinds.Real
    zero, half = Real(0.0), Real(0.5)
    clip = limiter.clip

    @wp.func
    def jump(X: Real, P: Real, share: Real, hold: Real, SX_l: Real, SP_l: Real, SX_r: Real, SP_r: Real) -> Real:
        """J [m], what remains of the drive at an interface; 0 where friction holds."""
        return clip(P - X - half * (SX_l + SX_r) - (SP_r + share * (SP_l - SP_r)), hold)

    @wp.func
    def reconstructed(q_l: Real, q_r: Real, J: Real):
        """q* [m] of both sides: the one that faces the remaining step is cut down by it."""
        return wp.min(q_l, wp.max(zero, q_r - J)), wp.min(q_r, wp.max(zero, q_l + J))

    return SecondReconstruction(jump, reconstructed)
