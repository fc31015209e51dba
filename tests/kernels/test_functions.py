"""Functions of the kernels of order 1 one by one, against the reference, each other, and where they must be exact."""

from functools import partial
from typing import Any

import numpy as np
import pytest
import warp as wp
from helpers import cases
from helpers.functions import Caller

from warpgran.case.case import Case
from warpgran.kernels import lanes, record
from warpgran.kernels import laws as laws_of
from warpgran.kernels.first import decode, drive, flux, reconstruction, rheology, viscosity
from warpgran.kernels.precision import FAST, module, precision
from warpgran.kernels.stages import Over, launches
from warpgran.physics import first_order, laws
from warpgran.physics.state import Fields
from warpgran.solve.finished import fault
from warpgran.solve.solver import Solver

small = partial(cases.small, **cases.FIRST)
CLOSE = {"float64": 1e-13, "float32": 1e-5}
PRECISIONS = pytest.mark.parametrize("precision_name", CLOSE)
RNG = np.random.default_rng(3)
H, V, PHI = RNG.uniform(1e-4, 0.2, 64), RNG.standard_normal(64), RNG.uniform(0.4, 0.63, 64)


def close(actual: Any, expected: Any, precision_name: str = "float64") -> None:
    scale = np.abs(expected).max()
    np.testing.assert_allclose(actual, expected, rtol=CLOSE[precision_name], atol=CLOSE[precision_name] * scale)


def state(alpha: float) -> tuple[np.ndarray, ...]:
    return PHI * H, PHI * H * V, PHI**alpha * H


# Laws


@PRECISIONS
@pytest.mark.parametrize(("law", "N"), [("f0", 1.0), ("f1", 1.0), ("f2", 2.5), ("f2", 1.0)])
def test_phi_eq_is_that_of_the_reference(law: str, N: float, precision_name: str) -> None:
    call = Caller(small(**{"rheology.phi_eq": law, "rheology.phi_eq_N": N}), precision_name)
    of = laws_of.make(call.variant)
    num, den = RNG.uniform(0.0, 3.0, 64), RNG.uniform(0.1, 1.0, 64)
    top, bottom = call(of.phi_equilibrium, num, den, returns=2)
    close(top / bottom, laws.PHI_EQ[law](num / den, 0.2, 0.582, N), precision_name)
    assert call(of.phi_at_rest) == np.array(0.582, dtype=precision_name).astype(float)


@pytest.mark.parametrize("alpha", [2.0, 1.5])
def test_powers(alpha: float) -> None:
    call = Caller(small(**{"scheme.alpha": alpha}))
    of = laws_of.make(call.variant)
    close(call(of.power, PHI), PHI ** (alpha - 1.0))
    close(call(of.root, PHI), PHI ** (1.0 / (alpha - 1.0)))


def test_friction_is_that_of_the_reference() -> None:
    call = Caller(small(**{"rheology.mu_wall": 0.18, "rheology.K": 20.0}))
    mu = call(laws_of.make(call.variant).friction, 0.5, PHI, 0.55, H)
    close(mu, laws.effective_friction(0.5, 20.0 * (PHI - 0.55), 0.18 / 0.2 * H))
    assert (mu < 0.18 / 0.2 * H + 1e-15).any()  # where the first part is cut off at 0


# The rheology of a state, both forms

RHEOLOGY: list[dict[str, Any]] = [{}, {"rheology.phi_eq": "f1", "scheme.relaxation": "exponential"}]


@PRECISIONS
@pytest.mark.parametrize("form", ["plain", "by_one"])
@pytest.mark.parametrize("changes", RHEOLOGY)
def test_rheology_of_a_state_is_that_of_the_reference(changes: dict[str, Any], form: str, precision_name: str) -> None:
    case = small(**{"rheology.mu_wall": 0.18, "scheme.h_min": 0.02, **changes})
    call = Caller(case, precision_name)
    properties, relaxed = getattr(rheology.make(call.variant, laws_of.make(call.variant)), form)
    U = state(2.0)
    per_U0, phi, h, mu = call(properties, *U, returns=4)
    close(per_U0, 1.0 / U[0], precision_name)
    close(phi, PHI, precision_name)
    close(h, H, precision_name)
    close(mu, first_order.friction(Fields(H, V, PHI), case), precision_name)
    per_U0, phi = call(relaxed, *U, 1e-3, returns=2)
    close(per_U0, 1.0 / U[0], precision_name)
    close(phi * U[0], first_order.relax(np.stack(U), 1e-3, case)[2], precision_name)


def test_rheology_of_any_alpha() -> None:
    case = small(**{"scheme.alpha": 1.5})
    call = Caller(case)
    of = rheology.make(call.variant, laws_of.make(call.variant))
    _, phi, h, mu = call(of.properties, *state(1.5), returns=4)
    close(phi, PHI)
    close(h, H)
    close(mu, first_order.friction(Fields(H, V, PHI), case))


def test_dry_cells_get_their_friction_from_the_laws(device: str) -> None:
    """By laws that are nobody's: another phi_eq at rest, another friction."""
    case = small(**{"grid.cells": 40, "scheme.window": False})
    solver = Solver.holding([case], device=device)
    kinds = precision("float64")
    Real, RunParams = kinds.Real, kinds.RunParams

    @wp.func  # type: ignore[untyped-decorator]
    def phi_at_rest(p: RunParams) -> Real:  # type: ignore[valid-type]
        return Real(0.25)

    @wp.func  # type: ignore[untyped-decorator]
    def friction(mu_I: Real, phi: Real, phi_eq: Real, h: Real, p: RunParams) -> Real:  # type: ignore[valid-type]
        return mu_I + Real(100.0) * phi_eq + h

    variant, test = solver.state.variant, module("warpgran_test_fill", FAST)
    of = laws_of.make(variant)._replace(phi_at_rest=phi_at_rest, friction=friction)
    cells = decode.make(variant, of, rheology.make(variant, of), test)
    solver.launch(launches((cells.decode, Over.CELLS), (cells.fill, Over.CELLS)))
    mu = solver.state.of_run(solver.state.arrays["mu"], 0)
    dry = case.initial_state()[0] == 0.0
    close(mu[dry], np.full(dry.sum(), 0.48 + 25.0))


# Interfaces


def sides() -> tuple[tuple[np.ndarray, np.ndarray], ...]:
    """h, v, phi on both sides of interfaces, some without mass on one side or both, some of a speed above all waves."""
    rng = np.random.default_rng(5)
    h_l, h_r = rng.permutation(H), H.copy()
    h_l[:8] = 0.0
    h_r[4:12] = 0.0
    v_l, v_r = rng.permutation(V), V.copy()
    v_l[20:24] = v_r[20:24] = 5.0
    v_l[24:28] = v_r[24:28] = -5.0
    return (h_l, h_r), (v_l, v_r), (rng.permutation(PHI), PHI)


def test_velocity_and_drive_at_interfaces() -> None:
    case = small(**{"scheme.alpha": 1.5})
    call = Caller(case)
    (h_l, h_r), (v_l, v_r), (phi_l, phi_r) = sides()
    at_face = drive.make(call.variant, laws_of.make(call.variant), lanes.make(False), call.module).at_face
    v_f, X = call(at_face, h_l, v_l, phi_l, h_r, v_r, phi_r, 1e-3, returns=2)
    m_l, m_r, c_l, c_r = phi_l * h_l, phi_r * h_r, phi_l**0.5, phi_r**0.5
    close(v_f, laws.quotient(m_l * v_l + m_r * v_r, m_l + m_r))  # (3.8)
    close(X, (h_l - h_r - 1e-3 + (h_l + h_r) * (c_l - c_r) / (c_l + c_r)) / case.dx)  # (3.12)


def test_apparent_slope_takes_up_what_friction_holds() -> None:
    call = Caller(small())
    slope = reconstruction.make(call.variant, laws_of.make(call.variant), call.module).apparent_slope
    X = np.linspace(-1.0, 1.0, 41)
    np.testing.assert_array_equal(call(slope, X, 0.0, 0.5), np.clip(X, -0.5, 0.5))  # at rest, to the last bit
    np.testing.assert_array_equal(call(slope, X, np.where(X > 0.0, 1e3, -1e3), 0.5), np.where(X > 0.0, 0.5, -0.5))
    np.testing.assert_array_equal(call(slope, X, 1.0, 0.0), 0.0)
    close(call(slope, -0.4, 0.1, 0.5), [-0.4 + 0.2 / 2.0])  # (3.10)
    close(call(slope, -1.5, 0.1, 0.5), [-0.5 + 0.2 / (1.0 + 3.0)])


@pytest.mark.parametrize("alpha", [2.0, 1.5])
def test_reconstruction_is_that_of_the_reference(alpha: float) -> None:
    call = Caller(small(**{"scheme.alpha": alpha}))
    of = reconstruction.make(call.variant, laws_of.make(call.variant), call.module)
    (h, _), _, (phi, phi_over) = sides()
    z = RNG.uniform(0.0, 0.2, h.size)
    found = call(of.reconstructed, h, phi, laws.quotient(np.ones_like(h), phi * h), phi_over, z, returns=2)
    h_star, phi_star = first_order.reconstruct(h, phi, phi_over, z, np.full(h.shape, True), alpha)
    close(found[0], h_star)
    close(np.where(h > 0.0, found[1], 0.0), np.where(h > 0.0, phi_star, 0.0))
    flat = call(of.reconstructed, h, phi, laws.quotient(np.ones_like(h), phi * h), phi, 0.0, returns=2)
    np.testing.assert_array_equal(flat[0], h)


@pytest.mark.parametrize("weight", [0.0, 0.7])
def test_height_climbed_is_less_the_head(weight: float) -> None:
    case = small(**{"scheme.lambda": weight})
    call = Caller(case)
    climb = reconstruction.make(call.variant, laws_of.make(call.variant), call.module).climb
    Dz = RNG.uniform(-0.1, 0.1, 64)
    _, (v_l, v_r), _ = sides()
    head = weight / case.g_c * 0.5 * np.where(Dz > 0.0, v_l**2 - v_r**2, v_r**2 - v_l**2)
    close(call(climb, Dz, v_l, v_r), laws.positive(np.abs(Dz) - laws.positive(head)))


# The Suliciu solver


def suliciu_sides(case: Case) -> tuple[np.ndarray, ...]:
    """rho, v, p and celerity of the left and the right side."""
    (h_l, h_r), (v_l, v_r), (phi_l, phi_r) = sides()
    left, right = (
        (phi * h, v, 0.5 * case.g_c * phi * h**2, np.sqrt(case.g_c * h))
        for h, v, phi in ((h_l, v_l, phi_l), (h_r, v_r, phi_r))
    )
    return *left, *right


def solver_of(call: Caller) -> flux.FirstFlux:
    return flux.make(call.variant, laws_of.make(call.variant), call.module)


@PRECISIONS
def test_suliciu_flux_is_that_of_the_reference(precision_name: str) -> None:
    case = small()
    call = Caller(case, precision_name)
    F0, F1 = call(solver_of(call).suliciu, *suliciu_sides(case), returns=2)
    h, v, phi = sides()
    expected = first_order.suliciu(h, v, phi, case)
    close(F0, expected[0], precision_name)
    close(F1, expected[1], precision_name)


def test_suliciu_flux_of_equal_sides_is_that_of_the_model() -> None:
    case = small()
    call = Caller(case)
    left = rho, v, p, _ = suliciu_sides(case)[4:]
    F0, F1 = call(solver_of(call).suliciu, *left, *left, returns=2)
    close(F0, rho * v)
    close(F1, rho * v**2 + p)


def test_suliciu_flux_of_mirrored_sides_is_mirrored() -> None:
    case = small()
    call = Caller(case)
    rho_l, v_l, p_l, celerity_l, rho_r, v_r, p_r, celerity_r = suliciu_sides(case)
    F0, F1 = call(solver_of(call).suliciu, *suliciu_sides(case), returns=2)
    mirrored = rho_r, -v_r, p_r, celerity_r, rho_l, -v_l, p_l, celerity_l
    F0_mirrored, F1_mirrored = call(solver_of(call).suliciu, *mirrored, returns=2)
    close(F0_mirrored, -F0)
    close(F1_mirrored, F1)


def test_both_forms_of_the_solver_agree() -> None:
    case = small()
    call = Caller(case)
    of = solver_of(call)
    rho_l, v_l, p_l, celerity_l, rho_r, v_r, p_r, celerity_r = suliciu_sides(case)
    plain, by_one = (
        call(form, np.abs(p_r - p_l), rho_l, celerity_l, rho_r, celerity_r, v_l - v_r, returns=2) for form in of.speeds
    )
    close(by_one, plain)
    some = rho_l > 0.0
    plain, by_one = (call(form, 0.3 + H, 1.0 + H, 0.1 * V, some, returns=2) for form in of.between)
    close(by_one[0], plain[0])
    close(by_one[1][some], plain[1][some])  # of a side without mass it has no effect


def test_head_source_is_that_of_the_paper() -> None:
    case = small(**{"scheme.lambda": 0.7})
    call = Caller(case)
    _, (v, v_over), _ = sides()
    jump = RNG.uniform(-0.1, 0.1, v.size)
    v = np.where(np.arange(v.size) < 5, 0.0, v)
    gain = 0.7 / case.g_c * laws.positive(0.5 * v**2 - 0.5 * v_over**2)
    carried = laws.positive(jump) - laws.positive(laws.positive(jump) - gain)
    close(call(solver_of(call).source, 0.02, jump, v, v_over), 0.02 * case.g_c * laws.quotient(carried, v))


# Viscosity, and whether a state is sound


def test_viscosity_keeps_a_constant_phi() -> None:
    call = Caller(small())
    exchange = viscosity.make(call.variant, call.module).exchange
    U0_l, U0_r = RNG.permutation(H), H
    close(call(exchange, U0_l, 0.6 * U0_l, 0.6, U0_r, 0.6 * U0_r, 0.6), 2.0 * 0.6 * (U0_r - U0_l))


@pytest.mark.parametrize(
    "U", [(0.1, 0.0, 0.06), (0.0, 0.0, 0.0), (-1e-15, 0.0, 0.0), (-1e-9, 0.0, 0.0), (0.1, 0.0, 0.11), (0.1, 1.0, 0.0)]
)
def test_what_is_sound_is_so_for_both_engines(U: tuple[float, ...]) -> None:
    call = Caller(small())
    sound = record.make(precision("float64"), lanes.make(False), call.module).sound
    assert bool(call(sound, *U)[0]) == (fault(np.array([U]).T) is None)
