"""Runs by blocks of many lanes, as on a GPU, on Warp's emulation of them on the CPU; a program of its own.

    python tests/helpers/lanes.py OUT.npz

Warp must be told of blocks before anything is compiled, and vector code contracts other products and sums than the
code of single lanes: here contraction follows the source alone, in the plain loops too, so that bits can be compared.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import warp as wp

from warpgran.kernels import precision

wp.config.enable_cpu_blocks = True
wp.config.log_level = wp.LOG_WARNING
precision.FAST += " -ffp-contract=on"
precision.CAREFUL += " -ffp-contract=on"

sys.path.insert(0, str(Path(__file__).parent.parent))
sys.path.insert(0, str(Path(__file__).parent.parent.parent / "benchmarks"))

from parts.one_block import OneBlock  # noqa: E402

from helpers.cases import FIRST, small  # noqa: E402
from warpgran.case.case import Case  # noqa: E402
from warpgran.solve.schedule import Outputs  # noqa: E402
from warpgran.solve.solver import Solver  # noqa: E402
from warpgran.solve.state import padded_cells  # noqa: E402
from warpgran.solve.variant import variant_of  # noqa: E402

SHAPES = {"plain loop": (1, 1024), "32 lanes": (32, 32), "64 lanes": (64, 128), "256 lanes": (256, 1024)}
"""Lanes of a block and cells of a chunk: up to 13 chunks of a run, lanes with one cell, several, or none."""
OTHER_FIRST = {
    **FIRST, "scheme.alpha": 3.0, "scheme.lambda": 1.0, "rheology.phi_eq": "f1", "scheme.relaxation": "exponential",
    "scheme.h_min": 2e-3,
    "scheme.viscosity": "paper", "scheme.h_bed": 1e-4, "scheme.left": "periodic", "scheme.right": "periodic",
}  # fmt: skip
OTHER_SECOND = {"scheme.alpha": 3.0, "rheology.phi_eq": "f1", "scheme.left": "periodic", "scheme.right": "periodic"}
WAYS: list[tuple[str, dict[str, Any], tuple[str, ...]]] = [
    ("float64", {}, tuple(SHAPES)),
    ("float32", {}, ("plain loop", "256 lanes")),
    ("float64", OTHER_SECOND, ("plain loop", "64 lanes")),
    ("float64", FIRST, ("plain loop", "64 lanes")),
    ("float32", FIRST, ("plain loop", "64 lanes")),
    ("float64", OTHER_FIRST, ("plain loop", "64 lanes")),
]
"""Precision, changes of all cases, and shapes to compute them with."""


def cases(changes: dict[str, Any]) -> list[Case]:
    """One that runs through, one at rest, one out of steps, one that diverges if it can, and one on a wet bed."""
    times = {"time.end": 0.06, "time.snapshots": [0.02, 0.06], "time.series": {"every": 0.01}}
    full: dict[str, Any] = {"column.length": 0.8, "slope.angle": 0.0, "time.stop_at_rest": True}
    full |= {} if "scheme.right" in changes else {"scheme.right": "wall"}
    each: list[dict[str, Any]] = [{"grid.cells": 401}, {"grid.cells": 77, **full}, {"time.step_limit": 30},
            {"scheme.h_bed": 0.0, "rheology.K": 0.0},
            {"scheme.h_bed": 1e-3, "scheme.window": False, "slope.angle": -5.0}]  # fmt: skip
    return [small(**{**times, **changes, **one}) for one in each]


def kept(solver: Solver) -> dict[str, np.ndarray]:
    """What each run recorded and how it ended."""
    state = solver.state
    profiles = dict(zip(("h", "v", "phi"), state.recorded_profiles(), strict=True))
    ended = {key: getattr(state, key).numpy().copy() for key in ("status", "steps", "t", "bad_cell", "lo", "hi")}
    return {**profiles, **ended, "scalars": state.recorded_scalars()}


def one_block(batch: list[Case], padded: int) -> Solver:
    """The batch by a block a run, 50 steps a launch; its kernel compiles for a GPU too."""
    solver = Solver(len(batch), padded, variant_of(batch[0], "float64"), Outputs.of(batch[0]), lanes=64, chunk=padded)
    solver.load(batch)
    blocks = OneBlock(solver)
    with tempfile.TemporaryDirectory() as folder:
        wp.compile_aot_module(blocks.module, arch=90, use_ptx=False, module_dir=folder)
    while solver.state.active.numpy().any():
        blocks.steps(50)
    return solver


def main() -> None:
    """Compute every way, and write what each run recorded and how it ended."""
    found: dict[str, np.ndarray] = {}
    for n, (name, changes, shapes) in enumerate(WAYS):
        batch = cases(changes)
        variant = variant_of(batch[0], name)
        padded = padded_cells(max(case.grid.cells for case in batch))
        for shape in shapes:
            lanes, chunk = SHAPES[shape]
            solver = Solver(len(batch), padded, variant, Outputs.of(batch[0]), lanes=lanes, chunk=chunk)
            solver.load(batch)
            while not solver.replay():
                pass
            found |= {f"{n}/{shape}/{key}": values for key, values in kept(solver).items()}
        if n == 0:
            found |= {f"0/one block/{key}": values for key, values in kept(one_block(batch, padded)).items()}
    np.savez(sys.argv[1], **found)  # type: ignore[arg-type]


if __name__ == "__main__":
    main()
