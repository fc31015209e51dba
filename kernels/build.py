"""All kernels of a variant, built once."""

import functools
from typing import Any, NamedTuple

from warpgran.kernels import clock, decode, flux, inspect, reconstruction, relaxation, rheology, timestep, update
from warpgran.kernels import viscosity as viscosity_stage
from warpgran.kernels.precision import CAREFUL, FAST, Variant, module


class Kernels(NamedTuple):
    """The kernels of a variant: those of a step in their order of launch, then what is used between steps."""

    decode: Any
    friction: Any
    boundary: Any
    limits: Any
    time_step: Any
    reconstruct: Any
    flux: Any
    update: Any
    relax: Any
    diffuse: Any
    tick: Any
    start: Any
    check: Any
    measure: Any


@functools.cache
def build(variant: Variant) -> Kernels:
    """The kernels of a variant. Compiled when they are first launched: some seconds, then cached on disk."""
    fast = module(variant.name, FAST)
    careful = module(f"warpgran_{variant.precision}_careful", CAREFUL)
    laws = rheology.make(variant)
    cells = decode.make(variant, laws, fast)
    step = timestep.make(variant, fast, careful)
    time = clock.make(variant, careful)
    between = inspect.make(variant, careful)
    return Kernels(
        *cells,
        *step,
        reconstruct=reconstruction.make(variant, laws, fast),
        flux=flux.make(variant, laws, fast),
        update=update.make(variant, fast),
        relax=relaxation.make(variant, laws, fast),
        diffuse=viscosity_stage.make(variant, fast),
        tick=time.tick,
        start=time.start,
        check=between.check,
        measure=between.measure,
    )
