"""What the paper proves of the scheme: Theorem B.1, the steady states (3.13), and the energy inequality (2.7).

Each holds for the finite volume step alone, so dilatancy (K = 0) and viscosity (xi = 0) are off unless said.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from cases import at_centres, engines, small, state_of

from warpgran.case import Case
from warpgran.engines import Engine

FINITE_VOLUMES: dict[str, Any] = {"rheology.K": 0.0, "scheme.xi": [0.0, 0.0, 0.0]}
CELLS = 128

pytestmark = pytest.mark.parametrize("engine", engines())


def rough(seed: int, dry: float = 0.2) -> dict[str, Any]:
    """Thickness, volume fraction and bed drawn at random in every cell; a part of the cells is dry."""
    rng = np.random.default_rng(seed)
    h = np.where(rng.random(CELLS) < dry, 0.0, rng.uniform(0.001, 0.1, CELLS))
    return {"h": h, "phi": rng.uniform(0.3, 0.6, CELLS), "bed": 0.05 * rng.standard_normal(CELLS)}


def run(engine: Any, case: Case, t: float = 0.1) -> Engine:
    running: Engine = engine([case])
    running.advance(t, lambda: True)
    assert running.steps[0] > 20
    return running


@pytest.mark.parametrize("alpha", [1.5, 2.0, 3.0])
def test_conserves_the_first_and_third_components(engine: Any, alpha: float) -> None:  # (i)
    case = at_centres(**rough(1), **{"scheme.alpha": alpha, "scheme.lambda": 0.5, **FINITE_VOLUMES})
    before, after = state_of(engine([case])), state_of(run(engine, case))
    assert np.abs(after - before).max() > 1e-3
    for k in (0, 2):
        assert after[k].sum() == pytest.approx(before[k].sum(), rel=1e-13)


FRICTION = [pytest.param(0.0, id="frictionless"), pytest.param(0.5, id="friction")]


def assert_at_rest(engine: Any, case: Case) -> None:
    running = run(engine, case)
    h, v, phi = (field[0] for field in running.profiles())
    h_0, phi_0 = case.initial_state()
    assert np.abs(v).max() <= 1e-14
    assert np.abs(h - h_0).max() <= 1e-14
    assert np.abs(phi - phi_0).max() <= 1e-13


@pytest.mark.parametrize("alpha", [1.5, 2.0, 3.0])
@pytest.mark.parametrize("mu", FRICTION)
@pytest.mark.parametrize("angle", [0.0, -15.0])
def test_keeps_a_flat_surface_with_constant_phi(engine: Any, angle: float, mu: float, alpha: float) -> None:  # (ii)
    bed = 0.01 * np.random.default_rng(2).standard_normal(CELLS)
    x = (np.arange(CELLS) + 0.5) / CELLS
    h = 0.4 - (bed - x * np.tan(np.radians(angle)))
    changes = {"rheology.mu1": mu, "rheology.mu2": mu, "slope.angle": angle, "scheme.alpha": alpha, **FINITE_VOLUMES}
    assert_at_rest(engine, at_centres(h, 0.6, bed, **changes))


@pytest.mark.parametrize("alpha", [1.5, 2.0, 3.0])
@pytest.mark.parametrize("mu", FRICTION)
def test_keeps_the_second_family_of_steady_states(engine: Any, mu: float, alpha: float) -> None:  # (iii)
    bed = 0.01 * np.random.default_rng(3).standard_normal(CELLS)
    h = (0.4 - bed) * (alpha - 1.0) / (alpha - 0.5)
    phi = 0.55 * (h / h.max()) ** (1.0 / (alpha - 1.0))  # h phi^(1 - alpha) is constant
    changes = {"rheology.mu1": mu, "rheology.mu2": mu, "scheme.alpha": alpha, **FINITE_VOLUMES}
    assert_at_rest(engine, at_centres(h, phi, bed, **changes))


def heap(slope: float, K: float) -> Case:
    x = (np.arange(CELLS) + 0.5) / CELLS
    return at_centres(0.25 - slope * np.abs(x - 0.5), 0.6, **{"rheology.K": K})


@pytest.mark.parametrize(("slope", "K"), [(0.47, 0.0), (0.5, 4.09)])  # mu = 0.48, and 0.48 + 4.09 (0.6 - 0.582)
def test_friction_holds_a_heap_below_its_angle(engine: Any, slope: float, K: float) -> None:  # (3.13), |X| <= mu
    assert_at_rest(engine, heap(slope, K))


def test_a_heap_above_its_angle_moves(engine: Any) -> None:
    assert np.abs(run(engine, heap(0.5, 0.0)).profiles()[1][0]).max() > 1e-3


@pytest.mark.parametrize("seed", range(4))
def test_thickness_stays_nonnegative(engine: Any, seed: int) -> None:  # (iv)
    case = at_centres(**rough(seed, dry=0.5), **{"scheme.cfl": 0.5, **FINITE_VOLUMES})
    running = engine([case])
    for t in np.linspace(0.001, 0.1, 25):
        running.advance(t, lambda: True)
        assert state_of(running)[[0, 2]].min() >= 0.0


@pytest.mark.parametrize("viscosity", [0.0, 3.0])
@pytest.mark.parametrize("alpha", [1.5, 2.0])
def test_constant_phi_stays_constant(engine: Any, alpha: float, viscosity: float) -> None:  # (vii)
    data = rough(5)
    data["phi"] = np.full(CELLS, 0.6)
    changes: dict[str, Any] = {
        "rheology.K": 0.0,
        "scheme.alpha": alpha,
        "scheme.xi": [viscosity, viscosity, 2.5 * viscosity],
    }
    h, _, phi = (field[0] for field in run(engine, at_centres(**data, **changes)).profiles())
    assert np.abs(phi[h > 0.0] - 0.6).max() <= 1e-12


@pytest.mark.parametrize("seed", range(4))
def test_minimum_principle(engine: Any, seed: int) -> None:  # (viii)
    case = at_centres(**rough(seed), **FINITE_VOLUMES)
    h, phi = case.initial_state()
    least = phi[h > 0.0].min()
    running = engine([case])
    for t in (0.01, 0.03, 0.1):
        running.advance(t, lambda: True)
        h, _, phi = (field[0] for field in running.profiles())
        assert phi[h > 0.0].min() >= least - 1e-13
        assert phi[h > 0.0].min() < least + 0.1  # what is compared is near


@pytest.mark.parametrize("friction", [0.0, 0.48])
@pytest.mark.parametrize("cfl", [0.2, 0.5])
@pytest.mark.parametrize("seed", range(2))
def test_energy_does_not_grow(engine: Any, seed: int, cfl: float, friction: float) -> None:  # (v), (2.7)
    """The proof is semi-discrete; no finite step up to cfl = 0.5 was seen to let the energy grow."""
    changes: dict[str, Any] = {
        "rheology.mu1": friction,
        "rheology.mu2": friction,
        "scheme.cfl": cfl,
        "slope.angle": 22.0,
    }
    running = engine([at_centres(**rough(seed), **changes, **FINITE_VOLUMES)])
    energies = [running.scalars()["energy"][0]]
    for t in np.linspace(0.0005, 0.1, 200):  # more often than the largest step: after each step
        running.advance(t, lambda: True)
        energies.append(running.scalars()["energy"][0])
    rises = np.diff(energies)
    assert rises.max() <= 1e-15
    assert rises.min() < -1e-6


def test_mass_of_a_whole_collapse(engine: Any) -> None:
    case = small(**{"scheme.right": "wall", "time.end": 0.6, "time.snapshots": [0.6]})
    before = engine([case]).scalars()["mass"][0]
    running = run(engine, case, 0.6)
    assert running.scalars()["mass"][0] == pytest.approx(before, rel=1e-12)
    assert running.scalars()["front"][0] > 0.3
