"""The stages of a variant, built once."""

import functools
from typing import Any, NamedTuple

from warpgran.kernels import clock, first, lanes, means, record, second, timestep
from warpgran.kernels.first import stages as first_stages
from warpgran.kernels.precision import CAREFUL, FAST, Variant, module, precision
from warpgran.kernels.second import stages as second_stages
from warpgran.kernels.stages import Careful, Stages


class SchemeKernels(NamedTuple):
    """What a scheme is made of.

    Attributes:
        arrays: Names of its arrays of cells and interfaces.
        empty: Empty cells that a window has at each end before a step.
        flags: Compile options beside the usual.
        make: Its stages, for a variant.
    """

    arrays: tuple[str, ...]
    empty: int
    flags: str
    make: Any


SCHEMES = {
    1: SchemeKernels(first.ARRAYS, first.EMPTY, "", first_stages.make),
    2: SchemeKernels(second.ARRAYS, second.EMPTY, second.FLAGS, second_stages.make),
}
"""By their order."""


@functools.cache
def build(variant: Variant, many_lanes: bool = False) -> Stages:
    """The stages of a variant. Compiled when they are first launched: some seconds, then cached on disk.

    Args:
        variant: What is compiled in.
        many_lanes: Whether they are for blocks of more than one lane, as on a GPU.
    """
    scheme = SCHEMES[variant.order]
    fast = module(_named(variant.name, many_lanes), FAST + scheme.flags)
    careful = _careful(variant.precision, scheme.empty, many_lanes)
    return scheme.make(variant, careful, lanes.make(many_lanes), fast)


@functools.cache
def build_means(name: str) -> Any:
    """The kernel that hands a state over to coarser cells, of the precision of that name."""
    return means.make(precision(name), module(f"warpgran_{name}_means", CAREFUL))


@functools.cache
def _careful(name: str, empty: int, many_lanes: bool) -> Careful:
    kinds = precision(name)
    careful = module(_named(f"warpgran_{name}_careful_{empty}", many_lanes), CAREFUL)
    time = clock.make(kinds, empty, careful)
    recording = record.make(kinds, lanes.make(many_lanes), careful)
    return Careful(recording.record, timestep.make(kinds, careful), time.tick, time.start)


def _named(name: str, many_lanes: bool) -> str:
    return f"{name}_lanes" if many_lanes else name
