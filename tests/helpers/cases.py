"""Cases that several tests use."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np
import pytest
import warp as wp

from warpgran.case.case import Case
from warpgran.physics.reference import reference
from warpgran.schema import Status
from warpgran.solve.engines import run_kernels, run_reference
from warpgran.solve.finished import SCALARS, Failure
from warpgran.solve.solver import Solver

ENGINES = ("kernels", "numpy")
"""The two implementations, for tests that compare them: the kernels on the CPU, and the reference."""
_without = pytest.param("cuda", marks=pytest.mark.skip(reason="there is no NVIDIA GPU here"))
GPUS: list[Any] = [str(device) for device in wp.get_cuda_devices()] or [_without]
DEVICES = ["cpu", *GPUS]
"""Where kernels run, for tests of kernels; in a test, the fixture `device`."""
EVERY_ENGINE = [*ENGINES, *GPUS]
"""For tests that all implementations must pass, wherever they run."""

FIRST: dict[str, Any] = {"scheme.order": 1}
"""The paper's scheme, for tests of it; all others are of the default."""
ON_ONE_GRID: dict[str, Any] = {"scheme.start": 0}
"""The default scheme without its start on finer cells."""
DIVERGING: dict[str, Any] = {**FIRST, "scheme.viscosity": "paper", "rheology.K": 0.0}
"""On a dry bed the paper's viscosity makes solid fraction out of nothing: phi passes 1 after some steps."""
_x = np.linspace(0.0, 0.4, 41)
VIOLENT: dict[str, Any] = {"column.profile": {"x": _x, "h": 0.1 - 0.2 * _x, "v": np.where(_x > 0.2, 1e160, 0.0)}}
"""Velocities whose squares overflow, so that the default scheme diverges too: at the first step, in any kernels."""


def small(**changes: Any) -> Case:
    """A collapse of 200 coarse cells at 22 degrees by the default scheme, with a few changes by dotted key."""
    base: dict[str, Any] = {
        "slope.angle": 22.0,
        "grid.right": 0.6,
        "grid.cells": 200,
        "time.end": 0.2,
        "time.snapshots": [0.1, 0.2],
        "time.series": [],
    }
    return Case().with_(**{**base, **changes})


FIRST_ALONE = ("scheme.lambda", "scheme.relaxation", "scheme.viscosity", "scheme.xi")
"""Keys of the scheme of order 1 alone."""


class Compiled(NamedTuple):
    """Choices that ask for kernels of their own; order 2 has but the laws, alpha and the ends."""

    law: Literal["f0", "f1", "f2", "f2_one"]
    alpha_two: bool
    lambda_zero: bool
    rational: bool
    bounded: bool
    periodic: bool


COMPILED = [
    Compiled("f0", False, True, True, True, False),
    Compiled("f0", True, True, True, False, True),
    Compiled("f1", False, False, False, False, True),
    Compiled("f1", True, True, True, True, False),
    Compiled("f2", False, False, True, True, True),
    Compiled("f2", True, True, False, False, False),
    Compiled("f2_one", False, True, True, False, True),
    Compiled("f2_one", True, False, False, True, False),
]
"""Every choice with every other, by pairs, in as few kernels as that takes: to compile them is most of such a test."""


def drawn(seed: int, order: int) -> Case:
    """A case with every option of a scheme, by seed mod 8 of `COMPILED` and at random, that takes at most 100 steps.

    Left out is what is known to amplify rounding or to throw thin cells: lambda > 0 or the paper's viscosity on a dry
    bed, momentum diffused faster than mass (xi2 > xi1), and the paper's viscosity with xi3 != xi1, which takes phi
    above 1; f0 with lambda > 0 or the exponential relaxation.
    """
    rng = np.random.default_rng(seed)

    def one_of(*values: Any) -> Any:
        return values[rng.integers(len(values))]

    left, length = -0.3, 1.5
    x = np.linspace(left, left + length, 40)
    bed = {"x": x, "b": 0.01 * rng.standard_normal(x.size)}
    choices = COMPILED[seed % len(COMPILED)]
    dry_bed = one_of(0.0, 0.0, 1e-4) if choices.lambda_zero and choices.bounded else None
    xi = float(rng.uniform(0.5, 6.0))
    # Beside the left end, if it is periodic: mass falls to the right one.
    start = left if choices.periodic else float(rng.uniform(left, left + 0.5))
    ends = ("periodic", "periodic") if choices.periodic else (one_of("wall", "open"), one_of("wall", "open"))
    changes: dict[str, Any] = {
        "scheme.order": order,
        "rheology.mu1": float(rng.uniform(0.2, 0.6)),
        "rheology.mu2": float(rng.uniform(0.6, 0.9)),
        "rheology.I0": float(rng.uniform(0.1, 0.5)),
        "rheology.grain_diameter": float(10 ** rng.uniform(-4.0, -2.5)),
        "rheology.K": one_of(0.0, 1.0, 4.09, float(rng.uniform(0.0, 10.0))),
        "rheology.K_tilde": float(rng.uniform(0.05, 0.5)),
        "rheology.phi_stat": float(rng.uniform(0.5, 0.62)),
        "rheology.phi_eq": choices.law.partition("_")[0],
        "rheology.phi_eq_N": float(rng.uniform(1.5, 6.0)) if choices.law == "f2" else 1.0,
        "rheology.mu_wall": one_of(0.0, 0.18),
        "slope.angle": float(rng.uniform(-30.0, 40.0)),
        "slope.bed": one_of(None, bed),
        "column.height": float(rng.uniform(0.05, 0.3)),
        "column.length": float(rng.uniform(0.1, 0.5)),
        "column.phi": float(rng.uniform(0.5, 0.64)),
        "column.start": start,
        "grid.left": left,
        "grid.right": left + length,
        "grid.cells": int(rng.integers(60, 400)),
        "time.end": 10.0,
        "time.snapshots": [10.0],
        "time.series": [],
        "time.step_limit": 100,
        "scheme.alpha": 2.0 if choices.alpha_two else float(rng.uniform(1.2, 4.0)),
        "scheme.lambda": 0.0 if choices.lambda_zero else one_of(float(rng.uniform(0.0, 1.0)), 1.0),
        "scheme.cfl": float(rng.uniform(0.2, 0.5)),
        "scheme.relaxation": "rational" if choices.rational else "exponential",
        "scheme.viscosity": "bounded" if choices.bounded else "paper",
        "scheme.xi": [xi, xi, float(rng.uniform(0.5, 6.0)) if choices.bounded else xi],
        "scheme.h_min": one_of(None, 2e-3),
        "scheme.h_bed": float(10 ** rng.uniform(-5.0, -3.0)) if dry_bed is None else dry_bed,
        "scheme.left": ends[0],
        "scheme.right": ends[1],
        "scheme.window": one_of(True, False),
    }
    if changes["scheme.relaxation"] == "exponential":  # which is refused where it would empty a thin cell in one step
        steepest = 2.5 * changes["scheme.cfl"] * changes["rheology.K"] * length / changes["grid.cells"] / 9.0
        changes["scheme.h_min"] = max(changes["scheme.h_min"] or changes["rheology.grain_diameter"], steepest)
    if order == 2:
        changes["scheme.start"] = 0
        for key in FIRST_ALONE:
            del changes[key]
    return Case().with_(**changes)


@dataclass(frozen=True)
class Ran:
    """One run after it has ended: what was recorded at its output times, and its last state.

    Attributes:
        h, v, phi: (times, cells).
        scalars: By name, (times,).
        U: (3, cells).
    """

    h: np.ndarray
    v: np.ndarray
    phi: np.ndarray
    scalars: dict[str, np.ndarray]
    U: np.ndarray
    steps: int
    status: Status
    end_time: float
    failure: Failure | None


def ran(engine: str, case: Case, times: Sequence[float] | None = None, precision: str = "float64") -> Ran:
    """A case recorded at the times given or its own, by "kernels" (on the cpu), the name of a device, or "numpy"."""
    if times is not None:
        times = [float(t) for t in times]
        case = case.with_(**{"time.end": times[-1], "time.snapshots": times, "time.series": times})
    if engine != "numpy":
        device = "cpu" if engine == "kernels" else engine
        solver = Solver.holding([case], precision_name=precision, device=device)
        finished = run_kernels(solver, [case], lambda t: True)
        U = np.stack([solver.state.of_run(u, 0) for u in solver.state.U]).astype(float)
    else:
        finished = run_reference([case], lambda t: True)
        run = reference(case)
        with np.errstate(all="ignore"):
            for t in case.output_times:
                run.advance(t)
        U = run.U
    h, v, phi = (field[0, :, : case.grid.cells] for field in finished.profiles)
    scalars = dict(zip(SCALARS, finished.scalars[0].T, strict=True))
    ended = int(finished.steps[0]), Status(int(finished.status[0])), float(finished.end_time[0])
    return Ran(h, v, phi, scalars, U, *ended, finished.failures.get(0))


def at_centres(h: np.ndarray, phi: Any, bed: Any = None, **changes: Any) -> Case:
    """A case on [0, 1] m whose thickness, volume fraction and bed at the cell centres are those given, on these cells.

    So there is no start on finer ones.
    """
    n = h.size
    x = (np.arange(n) + 0.5) / n
    profile = {"x": x, "h": h, "phi": np.broadcast_to(phi, n)}
    grid = {"grid.left": 0.0, "grid.right": 1.0, "grid.cells": n}
    column = {"column.profile": profile, "column.height": None, "column.length": None, "column.phi": None}
    time = {"time.end": 0.1, "time.snapshots": [0.1], "time.series": []}
    closed = {"scheme.left": "wall", "scheme.right": "wall"}
    bed_table = {} if bed is None else {"slope.bed": {"x": x, "b": bed}}
    start = {} if changes.get("scheme.order") == 1 else ON_ONE_GRID
    return Case().with_(**{**grid, **column, **time, **closed, **bed_table, **start, **changes})


def assert_same_bits(a: Sequence[Sequence[Any]], b: Sequence[Sequence[Any]]) -> None:
    """Runs, each a sequence of arrays and numbers, are finite and the same to the bit."""
    for one, other in zip(a, b, strict=True):
        for x, y in zip(one, other, strict=True):
            assert np.isfinite(x).all()
            np.testing.assert_array_equal(x, y)
