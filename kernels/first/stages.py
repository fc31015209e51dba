"""The stages of order 1, in their order."""

from typing import Any

from warpgran.kernels import laws
from warpgran.kernels.first import decode, drive, ends, flux, reconstruction, relaxation, rheology, update, viscosity
from warpgran.kernels.lanes import Lanes
from warpgran.kernels.precision import Variant
from warpgran.kernels.stages import Careful, Over, Stages, launches


def make(variant: Variant, careful: Careful, lanes: Lanes, module: Any) -> Stages:
    """The stages of a variant, with the kernels that both schemes share."""
    law = laws.make(variant)
    at_point = rheology.make(variant, law)
    cells = decode.make(variant, law, at_point, module)
    ghosts = ends.make(variant, module)
    return Stages(
        load=(),
        look=launches(
            (cells.decode, Over.CELLS),
            (ghosts.after_decode, Over.RUNS),
            (cells.fill, Over.CELLS),
            (ghosts.after_fill, Over.RUNS),
            (careful.record, Over.LANES),
        ),
        choose=launches(
            (drive.make(variant, law, lanes, module).drive, Over.CELLS),
            (careful.time_step, Over.RUNS),
        ),
        advance=launches(
            (reconstruction.make(variant, law, module).reconstruct, Over.CELLS),
            (flux.make(variant, law, module).flux, Over.CELLS),
            (update.make(variant, module), Over.CELLS),
            (relaxation.make(variant, law, at_point, module), Over.CELLS),
            (ghosts.after_relax, Over.RUNS),
            (viscosity.make(variant, module).diffuse, Over.CELLS),
        ),
        tick=launches((careful.tick, Over.RUNS)),
        start=launches((careful.start, Over.RUNS)),
    )
