"""Each kernel of a step against the same stage of the reference, and what must not change a bit."""

from __future__ import annotations

import inspect
from typing import Any

import numpy as np
import pytest
from helpers.cases import FIRST, at_centres, drawn, small

from warpgran.case.case import Case
from warpgran.kernels import clock, precision, record
from warpgran.kernels.build import SCHEMES
from warpgran.physics import first_order, laws, state
from warpgran.schema import Status
from warpgran.solve import finished
from warpgran.solve.solver import Solver

CELLS = 100
ENDS = ("scheme.left", "scheme.right")


def test_constants_of_the_kernels_are_those_of_the_python_side() -> None:
    """The engines are used without Warp too, so both sides write them down."""
    assert record.SCALARS == finished.SCALARS
    assert precision.DRY == state.DRY
    for name in ("OK", "DIVERGED", "STEP_LIMIT", "AT_REST"):
        assert getattr(clock, name) == Status[name]


@pytest.mark.parametrize("order", SCHEMES)
def test_the_arrays_of_a_state_are_those_that_its_kernels_read_and_write(order: int) -> None:
    solver = Solver.holding([small(**{"scheme.order": order})])
    state, stages = solver.state, solver.stages
    names = {
        stage.named.get(name, name)
        for stage in (*stages.load, *stages.step)
        for name in inspect.signature(stage.kernel.func).parameters
    }
    arrays = SCHEMES[order].arrays
    assert {name for name in names if name != "chunks" and np.size(state.argument(name)) == state.size} == set(arrays)
    assert len({array.ptr for array in state.arrays.values()}) == len(arrays) == len(state.arrays)


def rough_case(**changes: Any) -> Case:
    """Every cell drawn at random, a third of them dry, on a rough bed."""
    rng = np.random.default_rng(7)
    h = np.where(rng.random(CELLS) < 0.3, 0.0, rng.uniform(1e-4, 0.1, CELLS))
    case = at_centres(h, rng.uniform(0.4, 0.62, CELLS), 0.05 * rng.standard_normal(CELLS), **FIRST)
    ends = {"scheme.left": "wall", "scheme.right": "open"}
    return case.with_(**{"scheme.window": False, "slope.angle": 20.0, **ends, **changes})


def expected_stages(case: Case, steps: int) -> dict[str, np.ndarray]:
    """What every array of a step holds after step number `steps` of the reference."""
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


@pytest.mark.parametrize("seed", range(6))
def test_lambda_flux_is_that_of_the_reference(seed: int) -> None:
    case = drawn(seed, order=1).with_(**{"scheme.lambda": 0.7, "scheme.h_bed": 1e-4, "rheology.phi_eq": "f2"})
    run, solver = first_order.FirstOrder(case), Solver.holding([case])
    for _ in range(20):
        run.step()
        solver.step()
    for k in range(3):
        np.testing.assert_allclose(solver.state.of_run(solver.state.U[k], 0), run.U[k], rtol=1e-10, atol=1e-14)
