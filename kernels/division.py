"""Divisions, which bound the cost of a step in float64: two that are needed together are made from one."""

from typing import Any

import warp as wp

from warpgran.kernels.precision import Precision


def make(kinds: Precision) -> Any:
    """inverses(a, b) of a precision.

    In float64 1/a and 1/b are b r and a r with r = 1/(a b): another multiplication or two in place of a division. The
    range of float32 is too short for the product (thin cells have denominators of 1e-28), and its divisions are cheap.
    """
    Real = kinds.Real

    @wp.func
    def shared(a: Real, b: Real):
        """1/a and 1/b; a b must not underflow."""
        r = Real(1.0) / (a * b)
        return b * r, a * r

    @wp.func
    def apart(a: Real, b: Real):
        """1/a and 1/b."""
        return Real(1.0) / a, Real(1.0) / b

    return shared if kinds.name == "float64" else apart
