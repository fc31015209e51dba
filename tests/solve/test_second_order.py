"""Order 2: kernels and reference against the table and each other, and what must not change a bit."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from helpers.cases import EVERY_ENGINE, FIRST, ON_ONE_GRID, at_centres, drawn, ran, small
from helpers.second_order import PERIODIC, TABLE, WALLS, held_heap, measured

from warpgran.case.case import Case
from warpgran.physics.reference import reference
from warpgran.physics.second_order import SecondOrder
from warpgran.physics.state import decode
from warpgran.solve.solver import Solver

PRECISIONS = ["float64", "float32"]
QUICK = ("0, 400 cells", "0, K = 0", "15, f0", "-10, bump", "-30, open", "0, start", "22, start")
"""Rows of the table that the reference computes in seconds; the kernels, which it agrees with, compute all."""


def assert_row(found: Sequence[float], expected: str, precision: str) -> None:
    if precision == "float64":
        digits = (6, 5, 5, 8, 4)
        assert " ".join(f"{value:.{n}f}" for value, n in zip(found, digits, strict=True)) == expected
    else:
        np.testing.assert_allclose(found, [float(word) for word in expected.split()], rtol=4e-5, atol=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize(("changes", "rows"), TABLE)
def test_kernels_give_the_numbers_of_the_table(
    changes: dict[str, Any], rows: list[tuple[float, int | None, str]], precision: str, device: str
) -> None:
    case = Case().with_(**{**ON_ONE_GRID, **changes})
    done = ran(device, case, [t for t, _, _ in rows], precision)
    for k, (_, steps, expected) in enumerate(rows):
        assert_row(measured(case, done.h[k], done.v[k], done.phi[k]), expected, precision)
        assert steps is None or abs(done.steps - steps) <= (0 if precision == "float64" else 1)


@pytest.mark.slow
@pytest.mark.parametrize(("changes", "rows"), [row for row in TABLE if row.id in QUICK])
def test_the_reference_gives_the_numbers_of_the_table(
    changes: dict[str, Any], rows: list[tuple[float, int | None, str]]
) -> None:
    case = Case().with_(**{**ON_ONE_GRID, **changes})
    run = reference(case)
    for t, steps, expected in rows:
        run.advance(t)
        assert_row(measured(case, *run.fields), expected, "float64")
        assert steps is None or run.steps == steps


def difference(case: Case, U: np.ndarray, V: np.ndarray) -> float:
    """Largest difference of h/h0, v/sqrt(g h0), phi between two states."""
    h_0 = case.column.height or 0.1
    pairs = zip(decode(U, case), decode(V, case), (h_0, np.sqrt(9.81 * h_0), 1.0), strict=True)
    return max(float(np.abs(a - b).max() / scale) for a, b, scale in pairs)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(40))
def test_kernels_agree_with_the_reference_over_100_steps_of_any_option(seed: int, device: str) -> None:
    case = drawn(seed, order=2)
    case = case.with_(**{"scheme.h_min": max(case.h_min, 5 * case.rheology.grain_diameter)})
    kernels, plain = ran(device, case), ran("numpy", case)
    assert kernels.steps == plain.steps == 100
    found = difference(case, kernels.U, plain.U)
    if found > 1e-11:  # a film that amplifies rounding: one unit in the last place of phi_0 must make as much of it
        nudged = ran("numpy", case.with_(**{"column.phi": float(np.nextafter(case.column.phi, 1.0))}))
        assert found <= min(1e-7, 10.0 * difference(case, nudged.U, plain.U))
    assert np.abs(decode(plain.U, case).v).max() > 1e-6  # something moved


@pytest.mark.slow
def test_whole_collapse_agrees_with_the_reference(device: str) -> None:
    case = small(**ON_ONE_GRID, **{"grid.cells": 800})
    kernels, plain = (ran(engine, case, [0.1, 0.3]) for engine in (device, "numpy"))
    assert kernels.steps == plain.steps
    assert difference(case, kernels.U, plain.U) <= 1e-10
    for name, value in plain.scalars.items():
        assert kernels.scalars[name] == pytest.approx(value, rel=1e-10), name


@pytest.mark.parametrize("ends", ["wall", "open"])
def test_what_fills_the_grid_to_its_ends_agrees_with_the_reference(ends: str, device: str) -> None:
    x = (np.arange(60) + 0.5) / 60
    changes = {"slope.angle": 40.0, "scheme.left": ends, "scheme.right": ends}
    case = at_centres(0.1 + 0.05 * np.cos(2.0 * x), 0.55 + 0.05 * x, **changes)
    kernels, plain = (ran(engine, case, [0.02]) for engine in (device, "numpy"))
    assert kernels.steps == plain.steps
    assert np.abs(decode(plain.U, case).v[[0, -1]]).min() > 1e-3
    assert difference(case, kernels.U, plain.U) <= 1e-12


def test_float32_agrees_with_float64(device: str) -> None:
    case = small(**ON_ONE_GRID, **{"grid.cells": 800})
    single, double = (ran(device, case, [0.3], precision) for precision in ("float32", "float64"))
    assert abs(single.steps - double.steps) <= 1
    assert 0.0 < difference(case, single.U, double.U) <= 2e-4


@pytest.mark.parametrize("engine", EVERY_ENGINE)
def test_starts_with_the_velocity_of_the_profile(engine: str) -> None:
    x = np.linspace(0.0, 0.4, 9)
    profile = {"x": x, "h": 0.1 - 0.2 * x, "v": 2.0 * x - 0.1}
    done = ran(engine, small(**ON_ONE_GRID, **{"column.profile": profile}), [0.0, 0.01])
    assert done.v[0].max() > 0.5 and done.v[0].min() < 0.0
    assert done.steps > 3  # the first step knows the fastest wave


@pytest.mark.parametrize("precision", PRECISIONS)
def test_what_friction_holds_stays_to_the_bit(precision: str, device: str) -> None:
    changes: dict[str, Any] = {"time.end": 10.0, "time.snapshots": [10.0]}
    if precision == "float32":  # of which every variant would be compiled
        changes |= {"scheme.alpha": 2.0, "rheology.phi_eq": "f2"}
    groups: dict[Any, list[Case]] = {}
    for case in (held_heap(seed).with_(**changes) for seed in range(100)):
        kind = case.scheme.periodic, case.scheme.alpha == 2.0, case.rheology.phi_eq
        groups.setdefault(kind, []).append(case)
    for cases in groups.values():
        solver = Solver.holding(cases, precision_name=precision, device=device)
        state = solver.state
        before = [[state.of_run(u, r) for u in state.U] for r in range(len(cases))]
        for _ in range(60):
            solver.step()
        assert (state.steps.numpy() == 60).all()
        for r, kept in enumerate(before):
            for k in range(3):
                np.testing.assert_array_equal(state.of_run(state.U[k], r), kept[k], f"U{k} of {r}")


@pytest.mark.parametrize("start", range(30, 34))
def test_the_window_grows_before_mass_passes_it(start: int, device: str) -> None:
    """Columns whose ends lie anywhere in a block of cells, that run fast to both sides."""
    steep = {"column.height": 1.0, "slope.angle": 40.0, "rheology.mu1": 0.0, "rheology.K": 0.0}
    for left in (start + np.arange(0, 32, 4)) / 300 * 0.8 - 0.2:
        column = {"grid.cells": 300, "column.start": float(left), "column.length": 0.1}
        limited, full = (
            ran(device, small(**ON_ONE_GRID, **column, **steep, **{"scheme.window": on}), [0.1, 0.2])
            for on in (True, False)
        )
        np.testing.assert_array_equal(limited.U, full.U)
        np.testing.assert_array_equal(limited.phi, full.phi)


@pytest.mark.slow
@pytest.mark.parametrize("precision", PRECISIONS)
def test_no_mass_is_lost_and_phi_keeps_its_bounds(precision: str, device: str) -> None:
    """Random states that no grains would be found in, of all ends: mass is never negative, phi in bounds."""
    exact = precision == "float64"
    for seed in range(20):
        rng = np.random.default_rng(seed)
        n = 100
        h = np.where(rng.random(n) < 0.3, 0.0, 10.0 ** rng.uniform(-4.0, -1.0, n))
        phi = rng.uniform(0.4, 0.62, n)
        laws = {"slope.angle": float(rng.uniform(-40.0, 40.0)), "rheology.K": float(rng.choice([0.0, 4.0, 20.0]))}
        time = {"time.end": 10.0, "time.snapshots": [10.0]}
        closed = PERIODIC if seed % 2 else WALLS
        case = at_centres(h, phi, 0.05 * rng.standard_normal(n), **closed, **laws, **time)
        solver = Solver.holding([case], precision_name=precision, device=device)
        mass = solver.state.of_run(solver.state.U[0], 0).sum(dtype=float)
        top = max(phi[h > 0.0].max(), case.rheology.phi_stat)
        for _ in range(100):
            solver.step()
            U0, _, U2 = (solver.state.of_run(u, 0).astype(float) for u in solver.state.U)
            assert U0.min() >= 0.0 if exact else U0.min() > -1e-12
            wet = U0 > 1e-12
            assert (U2[wet] / U0[wet]).max() <= top + (3e-14 if exact else 1e-5)
            assert U2[wet].min() >= 0.0
        assert U0.sum() == pytest.approx(mass, rel=1e-14 * n if exact else 1e-5)


def test_the_reference_of_a_case_is_that_of_its_order() -> None:
    assert isinstance(reference(small()), SecondOrder)
    assert not isinstance(reference(small(**FIRST)), SecondOrder)
