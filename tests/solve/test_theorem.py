"""What the paper proves of its scheme: Theorem B.1, the steady states (3.13), and the energy inequality (2.7).

Each holds for the finite volume step alone, so dilatancy (K = 0) and viscosity (xi = 0) are off unless said.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from helpers.cases import EVERY_ENGINE, FIRST, Ran, at_centres, ran, small

from warpgran.case.case import Case

FINITE_VOLUMES: dict[str, Any] = {**FIRST, "rheology.K": 0.0, "scheme.xi": [0.0, 0.0, 0.0]}
CELLS = 128

pytestmark = pytest.mark.parametrize("engine", EVERY_ENGINE)


def rough(seed: int, dry: float = 0.2) -> dict[str, Any]:
    """Thickness, volume fraction and bed drawn at random in every cell; a part of the cells is dry."""
    rng = np.random.default_rng(seed)
    h = np.where(rng.random(CELLS) < dry, 0.0, rng.uniform(0.001, 0.1, CELLS))
    return {"h": h, "phi": rng.uniform(0.3, 0.6, CELLS), "bed": 0.05 * rng.standard_normal(CELLS)}


def run(engine: str, case: Case, times: Sequence[float] = (0.1,)) -> Ran:
    done = ran(engine, case, times)
    assert done.steps > 20
    return done


@pytest.mark.parametrize("alpha", [1.5, 2.0, 3.0])
def test_conserves_the_first_and_third_components(engine: str, alpha: float) -> None:  # (i)
    case = at_centres(**rough(1), **{"scheme.alpha": alpha, "scheme.lambda": 0.5, **FINITE_VOLUMES})
    h, phi = case.initial_state()
    before, after = np.stack((phi * h, 0.0 * h, phi**alpha * h)), run(engine, case).U
    assert np.abs(after - before).max() > 1e-3
    for k in (0, 2):
        assert after[k].sum() == pytest.approx(before[k].sum(), rel=1e-13)


FRICTION = [pytest.param(0.0, id="frictionless"), pytest.param(0.5, id="friction")]


def assert_at_rest(engine: str, case: Case) -> None:
    done = run(engine, case)
    h, phi = case.initial_state()
    assert np.abs(done.v).max() <= 1e-14
    assert np.abs(done.h - h).max() <= 1e-14
    assert np.abs(done.phi - phi).max() <= 1e-13


@pytest.mark.parametrize("alpha", [1.5, 2.0, 3.0])
@pytest.mark.parametrize("mu", FRICTION)
@pytest.mark.parametrize("angle", [0.0, -15.0])
def test_keeps_a_flat_surface_with_constant_phi(engine: str, angle: float, mu: float, alpha: float) -> None:  # (ii)
    bed = 0.01 * np.random.default_rng(2).standard_normal(CELLS)
    x = (np.arange(CELLS) + 0.5) / CELLS
    h = 0.4 - (bed - x * np.tan(np.radians(angle)))
    changes = {"rheology.mu1": mu, "rheology.mu2": mu, "slope.angle": angle, "scheme.alpha": alpha, **FINITE_VOLUMES}
    assert_at_rest(engine, at_centres(h, 0.6, bed, **changes))


@pytest.mark.parametrize("alpha", [1.5, 2.0, 3.0])
@pytest.mark.parametrize("mu", FRICTION)
def test_keeps_the_second_family_of_steady_states(engine: str, mu: float, alpha: float) -> None:  # (iii)
    bed = 0.01 * np.random.default_rng(3).standard_normal(CELLS)
    h = (0.4 - bed) * (alpha - 1.0) / (alpha - 0.5)
    phi = 0.55 * (h / h.max()) ** (1.0 / (alpha - 1.0))  # h phi^(1 - alpha) is constant
    changes = {"rheology.mu1": mu, "rheology.mu2": mu, "scheme.alpha": alpha, **FINITE_VOLUMES}
    assert_at_rest(engine, at_centres(h, phi, bed, **changes))


def heap(slope: float, K: float) -> Case:
    x = (np.arange(CELLS) + 0.5) / CELLS
    return at_centres(0.25 - slope * np.abs(x - 0.5), 0.6, **FIRST, **{"rheology.K": K})


@pytest.mark.parametrize(("slope", "K"), [(0.47, 0.0), (0.5, 4.09)])  # mu = 0.48, and 0.48 + 4.09 (0.6 - 0.582)
def test_friction_holds_a_heap_below_its_angle(engine: str, slope: float, K: float) -> None:  # (3.13), |X| <= mu
    assert_at_rest(engine, heap(slope, K))


def test_a_heap_above_its_angle_moves(engine: str) -> None:
    assert np.abs(run(engine, heap(0.5, 0.0)).v).max() > 1e-3


@pytest.mark.parametrize("seed", range(4))
def test_thickness_stays_nonnegative(engine: str, seed: int) -> None:  # (iv)
    case = at_centres(**rough(seed, dry=0.5), **{"scheme.cfl": 0.5, **FINITE_VOLUMES})
    for t in np.linspace(0.004, 0.1, 10):
        assert ran(engine, case, [t]).U[[0, 2]].min() >= 0.0


@pytest.mark.slow
@pytest.mark.parametrize("viscosity", [0.0, 3.0])
@pytest.mark.parametrize("alpha", [1.5, 2.0])
def test_constant_phi_stays_constant(engine: str, alpha: float, viscosity: float) -> None:  # (vii)
    data = rough(5)
    data["phi"] = np.full(CELLS, 0.6)
    changes: dict[str, Any] = {
        **FIRST,
        "rheology.K": 0.0,
        "scheme.alpha": alpha,
        "scheme.xi": [viscosity, viscosity, 2.5 * viscosity],
    }
    done = run(engine, at_centres(**data, **changes))
    assert np.abs(done.phi[done.h > 0.0] - 0.6).max() <= 1e-12


@pytest.mark.parametrize("seed", range(4))
def test_minimum_principle(engine: str, seed: int) -> None:  # (viii)
    case = at_centres(**rough(seed), **FINITE_VOLUMES)
    h, phi = case.initial_state()
    least = phi[h > 0.0].min()
    done = run(engine, case, (0.01, 0.03, 0.1))
    for h, phi in zip(done.h, done.phi, strict=True):
        assert phi[h > 0.0].min() >= least - 1e-13
        assert phi[h > 0.0].min() < least + 0.1  # what is compared is near


@pytest.mark.parametrize("friction", [0.0, 0.48])
@pytest.mark.parametrize("cfl", [0.2, 0.5])
@pytest.mark.parametrize("seed", range(2))
def test_energy_does_not_grow(engine: str, seed: int, cfl: float, friction: float) -> None:  # (v), (2.7)
    """The proof is semi-discrete; no finite step up to cfl = 0.5 was seen to let the energy grow."""
    changes: dict[str, Any] = {
        "rheology.mu1": friction,
        "rheology.mu2": friction,
        "scheme.cfl": cfl,
        "slope.angle": 22.0,
    }
    case = at_centres(**rough(seed), **changes, **FINITE_VOLUMES)
    done = run(engine, case, np.linspace(0.0, 0.1, 201).tolist())  # more often than the largest step: after each step
    rises = np.diff(done.scalars["energy"])
    assert rises.max() <= 1e-15
    assert rises.min() < -1e-6


def test_mass_of_a_whole_collapse(engine: str) -> None:
    done = run(engine, small(**FIRST, **{"scheme.right": "wall"}), (0.0, 0.6))
    before, after = done.scalars["mass"]
    assert after == pytest.approx(before, rel=1e-12)
    assert done.scalars["front"][1] > 0.3
