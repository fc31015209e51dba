"""What must not change a bit of a result: the batch, the window, the replays, what a solver held before."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from helpers.cases import assert_same_bits, at_centres, small

from warpgran.case.case import Case
from warpgran.kernels.build import SCHEMES
from warpgran.solve.schedule import Outputs
from warpgran.solve.solver import Solver
from warpgran.solve.variant import variant_of

Bits = list[tuple[np.ndarray, ...]]


@pytest.fixture(params=SCHEMES)
def series(request: pytest.FixtureRequest) -> dict[str, Any]:
    """Changes of a case: its order, and samples."""
    return {"scheme.order": request.param, "time.series": {"every": 0.03}}


def bits(cases: Sequence[Case], precision: str = "float64", replay: int | None = None, device: str = "cpu") -> Bits:
    """The snapshots, scalars and steps of each run."""
    solver = Solver.holding(cases, precision_name=precision, device=device)
    while not solver.replay(replay):
        pass
    return recorded(solver)


def recorded(solver: Solver) -> Bits:
    state = solver.state
    profiles = [[field[r, :, :n] for field in state.recorded_profiles()] for r, n in enumerate(state.cells)]
    return [(*p, s, n) for p, s, n in zip(profiles, state.recorded_scalars(), state.steps.numpy().copy(), strict=True)]


MIXED: list[dict[str, Any]] = [
    {},
    {"grid.cells": 77, "slope.angle": -5.0},
    {"column.start": 0.1, "column.length": 0.1, "scheme.left": "open"},
    {"column.start": 0.2, "column.length": 0.05, "slope.angle": -50.0, "scheme.left": "open", "column.phi": 0.5},
    {"slope.angle": 0.0, "column.phi": 0.55, "grid.cells": 401, "scheme.right": "wall"},
    {"scheme.h_bed": 1e-4, "rheology.K": 1.0},
]


@pytest.mark.parametrize("precision", ["float64", "float32"])
def test_a_batch_gives_the_bits_of_single_runs(precision: str, series: dict[str, Any], device: str) -> None:
    cases = [small(**series, **changes) for changes in MIXED]
    batch = bits(cases, precision, device=device)
    singles = [bits([case], precision, device=device)[0] for case in cases]
    assert_same_bits(batch, singles)
    assert len({int(run[-1]) for run in batch}) == len(cases)  # each has its own time step


@pytest.mark.parametrize("precision", ["float64", "float32"])
@pytest.mark.parametrize("changes", MIXED)
def test_the_window_changes_no_bit(
    changes: dict[str, Any], precision: str, series: dict[str, Any], device: str
) -> None:
    case = small(**{"grid.cells": 300, **series, **changes})
    full = case.with_(**{"scheme.window": False})
    assert_same_bits(*(bits([each], precision, device=device) for each in (case, full)))


def test_the_window_leaves_out_what_is_dry(series: dict[str, Any]) -> None:
    solvers = [Solver.holding([small(**{"grid.cells": 300, **series, "scheme.window": on})]) for on in (True, False)]
    for solver in solvers:
        assert solver.replay()
    limited, full = (int(solver.state.hi.numpy()[0] - solver.state.lo.numpy()[0]) for solver in solvers)
    assert full == 320
    assert 150 < limited < 260


def test_replays_of_any_length_give_the_same_bits(series: dict[str, Any], device: str) -> None:
    case = small(**series)
    assert_same_bits(bits([case], device=device), bits([case], replay=7, device=device))


def test_a_step_by_hand_gives_the_bits_of_a_replay(series: dict[str, Any], device: str) -> None:
    stepped = Solver.holding([small(**series)], device=device)
    while stepped.state.active.numpy()[0]:
        stepped.step()
    assert_same_bits(bits([small(**series)], device=device), recorded(stepped))


@pytest.mark.parametrize("other", [{"grid.cells": 250, "slope.angle": 30.0}, {"scheme.h_bed": 1e-3}])
def test_a_solver_loaded_again_remembers_nothing(other: dict[str, Any], series: dict[str, Any], device: str) -> None:
    case = small(**series)
    used = Solver(3, 256, variant_of(case, "float64"), Outputs.of(case), device)
    used.load([small(**series, **other)] * 3)
    assert used.replay()
    used.load([case])  # fewer than the capacity
    assert used.replay()
    assert_same_bits(recorded(used)[:1], bits([case], device=device))
    assert list(used.state.steps.numpy()[1:]) == [0, 0]


@pytest.mark.parametrize("ends", ["wall", "open", "periodic"])
def test_a_step_takes_nothing_but_the_state_from_the_step_before(
    ends: str, series: dict[str, Any], device: str
) -> None:
    """All other arrays are NaN before it, in the cells of the run and at its interfaces."""
    rng = np.random.default_rng(7)
    h = np.where(rng.random(100) < 0.3, 0.0, rng.uniform(1e-4, 0.1, 100))
    both = {"scheme.left": ends, "scheme.right": ends, "scheme.window": False, "slope.angle": 20.0, **series}
    case = at_centres(h, rng.uniform(0.4, 0.62, 100), 0.05 * rng.standard_normal(100), **both)
    clean, spoiled = (Solver.holding([case], device=device) for _ in range(2))
    for solver in (clean, spoiled):
        for _ in range(3):
            solver.step()
    state = spoiled.state
    for name, array in state.arrays.items():
        if name not in ("U0", "U1", "U2", "bhat", "dbhat", "drop"):
            values = array.numpy()
            values[state.row(0) : state.row(0) + 101] = np.nan
            array.assign(values)
    for solver in (clean, spoiled):
        solver.step()
    for ours, theirs in zip(spoiled.state.U, clean.state.U, strict=True):
        np.testing.assert_array_equal(spoiled.state.of_run(ours, 0), clean.state.of_run(theirs, 0))
