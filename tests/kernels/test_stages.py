"""Each kernel of a step against the same stage of the reference, and what must not change a bit."""

from __future__ import annotations

import inspect
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from helpers.cases import at_centres, drawn, small

from warpgran.case.case import Case
from warpgran.kernels import clock, precision, record
from warpgran.kernels.first import ARRAYS
from warpgran.physics import first_order, laws, state
from warpgran.schema import Status
from warpgran.solve import finished
from warpgran.solve.schedule import Outputs
from warpgran.solve.solver import Solver
from warpgran.solve.variant import variant_of

CELLS = 100
ENDS = ("scheme.left", "scheme.right")


def test_constants_of_the_kernels_are_those_of_the_python_side() -> None:
    """The engines are used without Warp too, so both sides write them down."""
    assert record.SCALARS == finished.SCALARS
    assert precision.DRY == state.DRY
    for name in ("OK", "DIVERGED", "STEP_LIMIT", "AT_REST"):
        assert getattr(clock, name) == Status[name]


def test_the_arrays_of_a_state_are_those_that_its_kernels_read_and_write() -> None:
    solver = Solver.holding([small()])
    state, stages = solver.state, solver.stages
    names = {name for stage in (*stages.load, *stages.step) for name in inspect.signature(stage.kernel.func).parameters}
    assert {name for name in names if name != "chunks" and np.size(state.argument(name)) == state.size} == set(ARRAYS)
    assert len({array.ptr for array in state.arrays.values()}) == len(ARRAYS) == len(state.arrays)


def rough_case(**changes: Any) -> Case:
    """Every cell drawn at random, a third of them dry, on a rough bed."""
    rng = np.random.default_rng(7)
    h = np.where(rng.random(CELLS) < 0.3, 0.0, rng.uniform(1e-4, 0.1, CELLS))
    case = at_centres(h, rng.uniform(0.4, 0.62, CELLS), 0.05 * rng.standard_normal(CELLS))
    ends = {"scheme.left": "wall", "scheme.right": "open"}
    return case.with_(**{"scheme.window": False, "slope.angle": 20.0, **ends, **changes})


def expected_stages(case: Case, steps: int) -> dict[str, np.ndarray]:
    """What every array of a step holds after step number `steps` of the first_order."""
    run = first_order.FirstOrder(case)
    for _ in range(steps - 1):
        run.step()
    fields = run.fields
    periodic = case.scheme.periodic
    h, v, phi = (state.with_ghosts(field, periodic=periodic) for field in fields)
    mu = first_order.friction(fields, case)
    mu_l, mu_r = state.with_ghosts(mu, periodic=periodic)
    mu_f = 0.5 * (mu_l + mu_r)
    rho = phi[0] * h[0], phi[1] * h[1]
    v_f = laws.quotient(rho[0] * v[0] + rho[1] * v[1], rho[0] + rho[1])
    before = run.U
    dt = run.step()
    Dz = first_order.apparent_topography(h, phi, v_f, mu_f, run.dbhat, dt, case)
    if not periodic:
        Dz[[0, -1]] = 0.0
    up, alpha = laws.positive(Dz), case.scheme.alpha
    h_l, phi_l = first_order.reconstruct(h[0], phi[0], phi[1], up, Dz > 0.0, alpha)
    h_r, phi_r = first_order.reconstruct(h[1], phi[1], phi[0], laws.positive(-Dz), Dz < 0.0, alpha)
    flux = first_order.interface_flux(fields, Dz, case)
    updated = first_order.update(before, flux, dt, case)
    relaxed = first_order.relax(updated, dt, case)
    inner = slice(None) if periodic else slice(1, -1)
    return {
        "h": fields.h, "v": fields.v, "phi": fields.phi, "mu": mu, "v_f": v_f[inner], "dt": np.array([dt]),
        "Dz": Dz[inner], "iota": laws.positive(v_f * Dz)[inner],
        "h_star": np.where(Dz > 0.0, h_l, h_r), "phi_star": np.where(Dz > 0.0, phi_l, phi_r),
        "F0": flux.F0, "F1_l": flux.F1_l, "F1_r": flux.F1_r, "F2": flux.F2,
        "W0": updated[0], "W1": updated[1], "W2": relaxed[2], "c": laws.quotient(relaxed[2], relaxed[0]),
        "U0": run.U[0], "U1": run.U[1], "U2": run.U[2],
    }  # fmt: skip


def actual_stages(case: Case, steps: int, device: str) -> dict[str, np.ndarray]:
    """The same from the kernels, every output poisoned before the last step."""
    solver = Solver.holding([case.with_(**{"time.end": 1e3, "time.snapshots": [1e3]})], device=device)
    s = solver.state
    for _ in range(steps - 1):
        solver.step()
    row, n = s.row(0), s.cells[0]
    for array in (*(array for name, array in s.arrays.items() if name not in GIVEN), s.dt):
        values = array.numpy()
        values[slice(None) if array is s.dt else slice(row, row + n + 1)] = np.nan
        array.assign(values)
    solver.step()
    beyond = {name: n + 1 for name in AT_INTERFACES}
    first = 0 if case.scheme.periodic else 1
    inner = dict.fromkeys(INNER, slice(row + first, row + n + 1 - first))
    places = {name: inner.get(name, slice(row, row + beyond.get(name, n))) for name in STAGES if name != "dt"}
    return {"dt": s.dt.numpy(), **{name: s.arrays[name].numpy()[place] for name, place in places.items()}}


GIVEN = ("U0", "U1", "U2", "bhat", "dbhat")
"""What a step starts from; all else it must write."""
AT_INTERFACES = ("h_star", "phi_star", "F0", "F1_l", "F1_r", "F2")
INNER = ("v_f", "Dz", "iota")
"""At two ends that are not one these are of a ghost cell and have no effect."""
STAGES = ("h v phi mu v_f dt Dz iota h_star phi_star F0 F1_l F1_r F2 W0 W1 W2 c U0 U1 U2").split()


@pytest.fixture(scope="module", params=[(2.0, {}), (1.5, {}), (2.0, dict.fromkeys(ENDS, "periodic"))])
def stages(request: pytest.FixtureRequest, device: str) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    alpha, ends = request.param
    case = rough_case(**{"scheme.alpha": alpha, **ends})
    return actual_stages(case, 5, device), expected_stages(case, 5)


@pytest.mark.parametrize("name", STAGES)
def test_stage_agrees_with_the_reference(name: str, stages: tuple[dict[str, np.ndarray], ...]) -> None:
    actual, expected = (each[name] for each in stages)
    scale = np.abs(expected).max()
    assert scale > 0.0
    assert actual.shape == expected.shape
    np.testing.assert_allclose(actual, expected, rtol=1e-11, atol=1e-13 * scale)


Bits = list[tuple[np.ndarray, ...]]


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


def assert_same_bits(a: Bits, b: Bits) -> None:
    for one, other in zip(a, b, strict=True):
        for x, y in zip(one, other, strict=True):
            assert np.isfinite(x).all()
            np.testing.assert_array_equal(x, y)


MIXED: list[dict[str, Any]] = [
    {},
    {"grid.cells": 77, "slope.angle": -5.0},
    {"column.start": 0.1, "column.length": 0.1, "scheme.left": "open"},
    {"slope.angle": 0.0, "column.phi": 0.55, "grid.cells": 401, "scheme.right": "wall"},
    {"scheme.h_bed": 1e-4, "rheology.K": 1.0},
]
SERIES = {"time.series": {"every": 0.03}}


@pytest.mark.parametrize("precision", ["float64", "float32"])
def test_a_batch_gives_the_bits_of_single_runs(precision: str, device: str) -> None:
    cases = [small(**SERIES, **changes) for changes in MIXED]
    batch = bits(cases, precision, device=device)
    singles = [bits([case], precision, device=device)[0] for case in cases]
    assert_same_bits(batch, singles)
    assert len({int(run[-1]) for run in batch}) == len(cases)  # each has its own time step


@pytest.mark.parametrize("precision", ["float64", "float32"])
@pytest.mark.parametrize("changes", MIXED)
def test_the_window_changes_no_bit(changes: dict[str, Any], precision: str, device: str) -> None:
    case = small(**{"grid.cells": 300, **SERIES, **changes})
    full = case.with_(**{"scheme.window": False})
    assert_same_bits(*(bits([each], precision, device=device) for each in (case, full)))


def test_the_window_leaves_out_what_is_dry() -> None:
    solvers = [Solver.holding([small(**{"grid.cells": 300, "scheme.window": on})]) for on in (True, False)]
    for solver in solvers:
        assert solver.replay()
    limited, full = (int(solver.state.hi.numpy()[0] - solver.state.lo.numpy()[0]) for solver in solvers)
    assert full == 320
    assert 150 < limited < 260


def test_replays_of_any_length_give_the_same_bits(device: str) -> None:
    case = small(**SERIES)
    assert_same_bits(bits([case], device=device), bits([case], replay=7, device=device))


def test_a_step_by_hand_gives_the_bits_of_a_replay(device: str) -> None:
    stepped = Solver.holding([small(**SERIES)], device=device)
    while stepped.state.active.numpy()[0]:
        stepped.step()
    assert_same_bits(bits([small(**SERIES)], device=device), recorded(stepped))


@pytest.mark.parametrize("other", [{"grid.cells": 250, "slope.angle": 30.0}, {"scheme.h_bed": 1e-3}])
def test_a_solver_loaded_again_remembers_nothing(other: dict[str, Any], device: str) -> None:
    used = Solver(3, 256, variant_of(small(), "float64"), Outputs.of(small(**SERIES)), device)
    used.load([small(**SERIES, **other)] * 3)
    assert used.replay()
    used.load([small(**SERIES)])  # fewer than there is room for
    assert used.replay()
    assert_same_bits(recorded(used)[:1], bits([small(**SERIES)], device=device))
    assert list(used.state.steps.numpy()[1:]) == [0, 0]


@pytest.mark.parametrize("seed", range(6))
def test_lambda_flux_is_that_of_the_reference(seed: int) -> None:
    case = drawn(seed).with_(**{"scheme.lambda": 0.7, "scheme.h_bed": 1e-4, "rheology.phi_eq": "f2"})
    run, solver = first_order.FirstOrder(case), Solver.holding([case])
    for _ in range(20):
        run.step()
        solver.step()
    for k in range(3):
        np.testing.assert_allclose(solver.state.of_run(solver.state.U[k], 0), run.U[k], rtol=1e-10, atol=1e-14)
