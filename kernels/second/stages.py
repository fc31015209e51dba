"""The stages of order 2, in their order."""

from typing import Any

from warpgran.kernels import laws
from warpgran.kernels.lanes import Lanes
from warpgran.kernels.precision import Variant, precision
from warpgran.kernels.second import (
    cells,
    drive,
    ends,
    faces,
    flux,
    limiter,
    look,
    reconstruction,
    relaxation,
    rheology,
    slopes,
    update,
)
from warpgran.kernels.stages import Careful, Over, Stages, launches


def make(variant: Variant, careful: Careful, lanes: Lanes, module: Any) -> Stages:
    """The stages of a variant, with the kernels that both schemes share."""
    kinds = precision(variant.precision)
    law, limit = laws.make(variant), limiter.make(kinds)
    at_point = rheology.make(variant, law)
    ghosts = ends.make(variant, module)
    finish = update.make(variant, at_point, limit, lanes, module)
    at_cells = cells.make(variant, law, at_point, module)
    interfaces = launches(
        (ghosts.after_cells, Over.RUNS),
        (drive.make(variant, limit, module).drive, Over.CELLS),
        (ghosts.after_drive, Over.RUNS),
        (slopes.make(variant, limit, module), Over.CELLS),
        (faces.make(variant, limit, module).faces, Over.CELLS),
        (ghosts.after_faces, Over.RUNS),
        (flux.make(variant, reconstruction.make(kinds, limit), module).flux, Over.CELLS),
    )
    return Stages(
        load=launches((finish.fastest, Over.CELLS)),
        look=launches((look.make(variant, at_point, module), Over.CELLS), (careful.record, Over.LANES)),
        choose=launches((careful.time_step, Over.RUNS)),
        advance=(
            *launches(
                (relaxation.make(variant, at_point, module), Over.CELLS),
                (ghosts.after_decode, Over.RUNS),
                (at_cells, Over.CELLS, {"mass": "U0"}),
            ),
            *interfaces,
            *launches(
                (finish.end_first, Over.CELLS),
                (ghosts.after_decode, Over.RUNS),
                (at_cells, Over.CELLS, {"mass": "W0"}),
            ),
            *interfaces,
            *launches((finish.end_second, Over.CELLS)),
        ),
        tick=launches((careful.tick, Over.RUNS)),
        start=launches((careful.start, Over.RUNS)),
    )
