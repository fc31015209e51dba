"""All kernels of a variant, built once."""

import functools
from typing import Any, NamedTuple

from warpgran.kernels import (
    clock,
    decode,
    flux,
    lanes,
    periodic,
    reconstruction,
    record,
    relaxation,
    rheology,
    timestep,
    update,
    viscosity,
)
from warpgran.kernels.precision import CAREFUL, FAST, Variant, module, precision


class Kernels(NamedTuple):
    """The kernels of a variant: those of a step in their order of launch, then what starts the loop.

    `wrap` is launched where a stage reads the ghost cells of what the stage before has written; None where no run is
    periodic.
    """

    decode: Any
    fill: Any
    boundary: Any
    record: Any
    limits: Any
    time_step: Any
    reconstruct: Any
    flux: Any
    update: Any
    relax: Any
    diffuse: Any
    tick: Any
    start: Any
    wrap: Any


@functools.cache
def build(variant: Variant, many_lanes: bool = False) -> Kernels:
    """The kernels of a variant. Compiled when they are first launched: some seconds, then cached on disk.

    Args:
        variant: What is compiled in.
        many_lanes: Whether they are for blocks of more than one lane, as on a GPU.
    """
    fast = module(_named(variant.name, many_lanes), FAST)
    laws = rheology.make(variant)
    cells = decode.make(variant, laws, fast)
    ends = periodic.make(variant, fast) if variant.periodic else periodic.Periodic(cells.boundary, None)
    careful = _careful(variant.precision, many_lanes)
    return Kernels(
        decode=cells.decode,
        fill=cells.fill,
        boundary=ends.boundary,
        record=careful.record,
        limits=timestep.make_limits(variant, laws, lanes.make(many_lanes), fast),
        time_step=careful.time_step,
        reconstruct=reconstruction.make(variant, laws, fast),
        flux=flux.make(variant, laws, fast),
        update=update.make(variant, fast),
        relax=relaxation.make(variant, laws, fast),
        diffuse=viscosity.make(variant, fast),
        tick=careful.tick,
        start=careful.start,
        wrap=ends.wrap,
    )


class Careful(NamedTuple):
    """The kernels that work on runs, not cells: the same for all variants of a precision, and honouring NaN."""

    record: Any
    time_step: Any
    start: Any
    tick: Any


@functools.cache
def _careful(name: str, many_lanes: bool) -> Careful:
    kinds = precision(name)
    careful = module(_named(f"warpgran_{name}_careful", many_lanes), CAREFUL)
    recording = record.make(kinds, lanes.make(many_lanes), careful)
    return Careful(recording, timestep.make_time_step(kinds, careful), *clock.make(kinds, careful))


def _named(name: str, many_lanes: bool) -> str:
    return f"{name}_lanes" if many_lanes else name
