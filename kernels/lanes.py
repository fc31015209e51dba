"""What the lanes of a block find together: each hands in its own value, and all get the answer.

On the CPU a thread is alone and its value is the answer: a plain loop, without the code for tiles, which costs a plain
loop its vectorisation and may not run in two threads at once. The functions are chosen when kernels are built. A
maximum does not depend on the order; a sum is added up in an order that the number of lanes alone decides.
"""

import functools
from typing import Any, NamedTuple

import warp as wp


class Lanes(NamedTuple):
    """Largest, least and sum of the values of all lanes. Every lane of a block must get to the call."""

    most: Any
    least: Any
    total: Any


@functools.cache
def make(many: bool) -> Lanes:
    """The functions for blocks of many lanes, or of one."""

    @wp.func
    def alone(x: Any):
        return x

    @wp.func
    def most(x: Any):
        return wp.tile_max(wp.tile(x))[0]

    @wp.func
    def least(x: Any):
        return wp.tile_min(wp.tile(x))[0]

    @wp.func
    def total(x: Any):
        return wp.tile_sum(wp.tile(x))[0]

    return Lanes(most, least, total) if many else Lanes(alone, alone, alone)


@wp.func
def lane_of(thread: int) -> int:
    """A thread's place in its block."""
    return thread % wp.block_dim()
