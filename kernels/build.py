"""The stages of a variant, built once."""

import functools

from warpgran.kernels import clock, first, lanes, record, timestep
from warpgran.kernels.first import stages as first_stages
from warpgran.kernels.precision import CAREFUL, FAST, Variant, module, precision
from warpgran.kernels.stages import Careful, Stages


@functools.cache
def build(variant: Variant, many_lanes: bool = False) -> Stages:
    """The stages of a variant. Compiled when they are first launched: some seconds, then cached on disk.

    Args:
        variant: What is compiled in.
        many_lanes: Whether they are for blocks of more than one lane, as on a GPU.
    """
    fast = module(_named(variant.name, many_lanes), FAST)
    careful = _careful(variant.precision, first.EMPTY, many_lanes)
    return first_stages.make(variant, careful, lanes.make(many_lanes), fast)


@functools.cache
def _careful(name: str, empty: int, many_lanes: bool) -> Careful:
    kinds = precision(name)
    careful = module(_named(f"warpgran_{name}_careful_{empty}", many_lanes), CAREFUL)
    time = clock.make(kinds, empty, careful)
    recording = record.make(kinds, lanes.make(many_lanes), careful)
    return Careful(recording.record, timestep.make(kinds, careful), time.tick, time.start)


def _named(name: str, many_lanes: bool) -> str:
    return f"{name}_lanes" if many_lanes else name
