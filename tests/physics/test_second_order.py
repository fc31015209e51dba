"""The reference of order 2: the numbers of its table, and what the scheme promises of any run."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from helpers.cases import at_centres, drawn
from helpers.second_order import CELLS, OPEN, PERIODIC, WALLS, held_heap

from warpgran.case.case import Case
from warpgran.physics.second_order import (
    SecondOrder,
    at_interfaces,
    bed_drop,
    drive,
    face_values,
    interface_flux,
    time_step,
    unknowns,
)
from warpgran.physics.state import DRY


def solid(run: SecondOrder) -> float:
    return float(run.U[0].sum() * run.case.dx)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(100))
def test_what_friction_holds_stays_to_the_bit(seed: int) -> None:
    case = held_heap(seed)
    run = SecondOrder(case)
    cells = unknowns(run.U, case)
    on = drive(cells, bed_drop(case), 1e-3, case)
    assert (on.P == on.X).all() and (on.hold == 0.0).all()  # |X| < M: the draw is a heap that is held
    assert np.abs(on.X).max() > 5e-4 and cells.wet.all() == (seed % 8 >= 4)
    before = run.U
    for _ in range(60):
        run.step()
    np.testing.assert_array_equal(run.U, before)
    assert run.t > 0.1


def rough(seed: int, **changes: Any) -> Case:
    """Thickness, volume fraction, velocity and bed drawn at random in every cell; a fifth of the cells is dry."""
    rng = np.random.default_rng(seed)
    h = np.where(rng.random(CELLS) < 0.2, 0.0, rng.uniform(0.001, 0.1, CELLS))
    x = (np.arange(CELLS) + 0.5) / CELLS
    case = at_centres(h, 0.5, 0.03 * rng.standard_normal(CELLS))
    profile = {"x": x, "h": h, "phi": rng.uniform(0.3, 0.6, CELLS), "v": rng.standard_normal(CELLS)}
    return case.with_(**{"column.profile": profile, "slope.angle": float(rng.uniform(-40.0, 40.0)), **changes})


def assert_bounds(run: SecondOrder, highest: float, lowest: float = 1e-4) -> None:
    U0, U2 = run.U[0], run.U[2]
    wet = U0 > DRY
    phi = (U2[wet] / U0[wet]) ** (1.0 / (run.case.scheme.alpha - 1.0))
    assert np.isfinite(run.U).all() and U0.min() >= 0.0
    assert phi.max() <= highest * (1.0 + 5e-14) and phi.min() >= lowest * (1.0 - 5e-14)


@pytest.mark.slow
@pytest.mark.parametrize("K", [0.0, 4.09, 50.0])
@pytest.mark.parametrize("ends", [WALLS, OPEN, PERIODIC], ids=["walls", "open", "periodic"])
@pytest.mark.parametrize("seed", range(4))
def test_thickness_volume_fraction_and_mass_keep_their_bounds(seed: int, ends: dict[str, Any], K: float) -> None:
    case = rough(seed, **{"rheology.K": K, "scheme.alpha": [2.0, 1.5, 2.0, 3.0][seed], **ends})
    run = SecondOrder(case)
    _, phi = case.initial_state()
    mass = solid(run)
    for _ in range(150):
        run.step()
        if K > 0.0:
            assert_bounds(run, max(phi.max(), case.rheology.phi_stat))
        else:
            assert_bounds(run, phi.max(), phi.min())
        if ends is OPEN:
            assert solid(run) <= mass * (1.0 + 1e-14)
            mass = solid(run)
        else:
            assert solid(run) == pytest.approx(mass, rel=1e-13)


@pytest.mark.parametrize("seed", range(24))
def test_any_option_runs_soundly(seed: int) -> None:  # and without a warning, which would be an error here
    case = drawn(seed, order=2)
    run = SecondOrder(case)
    for _ in range(100):
        assert run.step() > 0.0
    assert run.steps == 100
    assert_bounds(run, max(case.column.phi, case.rheology.phi_stat))


def test_no_more_than_half_of_the_mass_at_a_face_leaves_in_a_step_however_long() -> None:
    case = rough(3)
    cells = unknowns(SecondOrder(case).U, case)
    dt = 4.0 * time_step(cells, case)
    faces = at_interfaces(face_values(cells, case), case)
    F0 = interface_flux(faces, drive(cells, bed_drop(case), dt, case), dt, case).F0
    most_l, most_r = (0.5 * case.dx / dt * (q * s) for q, s in zip(faces.q, faces.s, strict=True))
    assert (F0 <= most_l).all() and (F0 >= -most_r).all()
    assert ((F0 == most_l) & (F0 > 0.0)).sum() > 2 and ((F0 == -most_r) & (F0 < 0.0)).sum() > 2


def test_no_least_thickness() -> None:
    case = Case().with_(**{"grid.cells": 180, "slope.angle": 22.0})
    case = case.model_copy(update={"scheme": case.scheme.model_copy(update={"h_min": 0.0})})
    run = SecondOrder(case)
    run.advance(0.1)
    assert_bounds(run, case.column.phi)


def test_nothing_flows_in_through_open_ends() -> None:
    x = (np.arange(CELLS) + 0.5) / CELLS
    profile = {"x": x, "h": np.full(CELLS, 0.1), "v": np.where(x < 0.5, 0.5, -0.5)}
    run = SecondOrder(at_centres(np.ones(CELLS), 0.6, **OPEN).with_(**{"column.profile": profile, "column.phi": 0.6}))
    before = solid(run)
    run.step()
    assert solid(run) == pytest.approx(before, rel=1e-14)
    run.U[1] *= -1.0
    for _ in range(9):
        run.step()
    assert solid(run) < 0.999 * before


def test_a_mirrored_case_gives_the_mirrored_result() -> None:
    case = rough(7, **{"scheme.left": "wall", "scheme.right": "open", "slope.angle": 20.0})
    column, bed = case.column.profile, case.slope.bed
    assert column is not None and column.phi is not None and column.v is not None and bed is not None
    profile = {"x": column.x, "h": column.h[::-1], "phi": column.phi[::-1], "v": -column.v[::-1]}
    other = case.with_(**{"scheme.left": "open", "scheme.right": "wall", "slope.angle": -20.0})
    other = other.with_(**{"column.profile": profile, "slope.bed": {"x": bed.x, "b": bed.b[::-1]}})
    one, mirror = SecondOrder(case), SecondOrder(other)
    for run in (one, mirror):
        run.advance(0.1)
    np.testing.assert_allclose(mirror.U[:, ::-1] * [[1.0], [-1.0], [1.0]], one.U, rtol=0.0, atol=1e-13)


@pytest.mark.parametrize("angle", [28.0, -28.0])
def test_a_uniform_layer_stays_uniform_and_becomes_the_steady_flow(angle: float) -> None:
    case = at_centres(np.full(16, 0.02), 0.56, **{"slope.angle": angle, **PERIODIC})
    run = SecondOrder(case)
    run.advance(20.0)
    for field in run.fields:
        assert np.unique(field).size == 1
    h, v, phi = (field[0] for field in run.fields)
    r = case.rheology
    tan = np.tan(np.radians(28.0))  # is mu: the inertial number follows, phi is phi_eq of it, and v
    I = r.I0 * (tan - r.mu1) / (r.mu2 - tan)
    assert phi == pytest.approx(r.phi_stat / (1.0 + r.K_tilde * I / r.phi_stat), rel=1e-12)
    assert abs(v) == pytest.approx(I * h * np.sqrt(phi * case.g_c * h) / (2.5 * r.grain_diameter), rel=1e-12)


def test_smooth_flow_converges_with_the_second_order() -> None:
    def after(cells: int) -> np.ndarray:
        x = (np.arange(cells) + 0.5) / cells
        wave = np.sin(2.0 * np.pi * x)
        case = at_centres(0.05 + 0.005 * wave, 0.58, **{"slope.angle": 26.0, **PERIODIC})
        profile = {"x": x, "h": 0.05 + 0.005 * wave, "phi": 0.57 + 0.01 * wave, "v": 0.5 + 0.1 * wave}
        run = SecondOrder(case.with_(**{"column.profile": profile, "slope.bed": {"x": x, "b": 0.001 * wave}}))
        run.advance(0.3)
        return run.U

    coarse, middle, fine = (after(cells) for cells in (64, 128, 256))
    errors = [
        np.abs(a - 0.5 * (b[:, ::2] + b[:, 1::2])).sum(axis=1) / a.shape[1]
        for a, b in ((coarse, middle), (middle, fine))
    ]
    assert (np.log2(errors[0] / errors[1]) > 1.85).all()
