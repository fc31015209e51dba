"""Order 1: kernels against the reference, step for step, and against the numbers of an independent implementation."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from helpers.cases import EVERY_ENGINE, FIRST, Ran, drawn, ran, small

from warpgran.analysis.front import front
from warpgran.case.case import Case
from warpgran.physics.state import decode
from warpgran.schema import Status


def differences(case: Case, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Largest differences of h/h0, v/sqrt(g h0) and phi; a and b are (3, ...)."""
    scales = case.column.height, np.sqrt(9.81 * case.column.height), 1.0
    return np.array([np.abs(p - q).max() / scale for p, q, scale in zip(a, b, scales, strict=True)])


def fields(done: Ran, case: Case) -> np.ndarray:
    """h, v, phi of the last state, by the decoding of the reference."""
    return np.stack(decode(done.U, case))


@pytest.mark.parametrize("seed", range(32))
def test_kernels_agree_with_numpy_over_100_steps_of_any_option(seed: int, device: str) -> None:
    case = drawn(seed, order=1)
    kernels, reference = (ran(engine, case) for engine in (device, "numpy"))
    assert kernels.steps == reference.steps == 100
    assert kernels.status == reference.status == Status.STEP_LIMIT
    assert differences(case, fields(kernels, case), fields(reference, case)).max() <= 1e-11
    assert np.abs(fields(kernels, case)[1]).max() > 1e-6  # something moved
    if case.scheme.periodic:
        assert reference.U[0, -1] > case.scheme.h_bed  # it came through the ends


@pytest.fixture(scope="module")
def collapse() -> Case:
    return small(**FIRST, **{"grid.cells": 800})


def recorded(done: Ran) -> np.ndarray:
    return np.stack((done.h, done.v, done.phi))


@pytest.mark.slow
def test_whole_collapse_agrees_with_numpy(collapse: Case, device: str) -> None:
    kernels, reference = (ran(engine, collapse, [0.1, 0.3]) for engine in (device, "numpy"))
    assert kernels.steps == reference.steps
    assert kernels.end_time == reference.end_time == 0.3
    assert differences(collapse, recorded(kernels), recorded(reference)).max() <= 1e-10
    for name, value in reference.scalars.items():
        assert kernels.scalars[name] == pytest.approx(value, rel=1e-10), name


@pytest.mark.parametrize("engine", EVERY_ENGINE)
def test_starts_with_the_velocity_of_the_profile(engine: str) -> None:
    x = np.linspace(0.0, 0.4, 9)
    profile = {"x": x, "h": 0.1 - 0.2 * x, "v": 2.0 * x - 0.1}
    case = small(**FIRST, **{"column.profile": profile, "time.series": [0.0]})
    done = ran(engine, case, [0.0, 0.01])
    wet = done.h[0] > 0.0
    assert np.abs(done.v[0] - np.where(wet, case.initial_velocity(), 0.0)).max() <= 1e-15
    assert done.v[0].max() > 0.5 and done.v[0].min() < 0.0


def test_a_moving_start_agrees_with_numpy(device: str) -> None:
    x = np.linspace(0.0, 0.4, 9)
    case = small(**FIRST, **{"column.profile": {"x": x, "h": 0.1 - 0.2 * x, "v": 2.0 * x - 0.1}})
    kernels, reference = (ran(engine, case) for engine in (device, "numpy"))
    assert kernels.steps == reference.steps
    assert differences(case, recorded(kernels), recorded(reference)).max() <= 1e-11


def test_float32_agrees_with_float64(collapse: Case, device: str) -> None:
    single, double = (ran(device, collapse, [0.3], precision) for precision in ("float32", "float64"))
    assert 0.0 < differences(collapse, recorded(single), recorded(double)).max() <= 1e-4


WET_BED = {"scheme.h_bed": 1e-5}
TABLE: list[tuple[str, float, dict[str, Any], list[tuple[float, int | None, str]]]] = [
    # name, slope angle, changes, rows: t, steps, "max h (cm), front (cm), max v where h > 1 mm, volume change (%)"
    ("0", 0.0, {}, [(0.36, None, "14.005 32.22 0.12261 4.03"), (0.5, 3227, "14.002 31.87 0.00001 3.95")]),
    ("0, K = 0", 0.0, {"rheology.K": 0.0}, [(0.36, 2453, "13.674 30.45 0.14737 -0.01")]),
    ("0, loose", 0.0, {"column.phi": 0.55}, [(0.36, 2742, "12.398 31.47 0.10340 -3.58")]),
    ("22", 22.0, {}, [(0.48, None, "6.293 70.89 1.14860 9.96"), (1.38, 4755, "4.469 107.81 0.25879 7.12")]),
    ("22, alpha = 3", 22.0, {"scheme.alpha": 3.0}, [(0.48, 2839, "6.294 70.27 1.12440 9.90")]),
    ("22, lambda = 1", 22.0, {"scheme.lambda": 1.0, **WET_BED}, [(0.48, 2099, "6.292 68.32 0.97688 9.75")]),
    ("22, paper", 22.0, {"scheme.viscosity": "paper", **WET_BED}, [(0.48, 3198, "6.279 68.08 1.01322 9.76")]),
    ("22, f1, exponential", 22.0, {"rheology.phi_eq": "f1", "scheme.relaxation": "exponential"},
     [(0.48, 2984, "6.293 77.49 1.32502 11.83")]),
    ("22, walls", 22.0, {"rheology.mu_wall": 0.18}, [(0.48, 2664, "7.635 69.03 1.09403 9.46")]),
]  # fmt: skip


QUICK = ("0, K = 0", "22, lambda = 1")
"""Rows of the table that the reference computes in seconds; the kernels, which it agrees with, compute all."""


def assert_rows(engine: str, angle: float, changes: dict[str, Any], rows: list[tuple[float, int | None, str]]) -> None:
    grid = {"grid.right": 0.6, "grid.cells": 800} if angle == 0.0 else {"grid.right": 1.4, "grid.cells": 1600}
    case = Case().with_(**{**FIRST, "slope.angle": angle, **grid, **changes})
    done = ran(engine, case, [0.0, *(t for t, _, _ in rows)])
    thick = done.h > 1e-3  # of h itself, which the series are not
    volume = (done.h * thick).sum(axis=1)
    for k, (_, steps, expected) in enumerate(rows, start=1):
        change = 100 * (volume[k] / volume[0] - 1)
        cm = 100 * done.h[k].max(), 100 * front(case.x, done.h[k], 1e-3)
        speed = np.abs(done.v[k, thick[k]]).max()
        assert f"{cm[0]:.3f} {cm[1]:.2f} {speed:.5f} {change:.2f}" == expected
        assert steps is None or done.steps == steps


@pytest.mark.slow
@pytest.mark.parametrize("row", TABLE, ids=[name for name, *_ in TABLE])
def test_kernels_give_the_numbers_of_an_independent_implementation(row: Any, device: str) -> None:
    assert_rows(device, *row[1:])


@pytest.mark.slow
@pytest.mark.parametrize("row", [row for row in TABLE if row[0] in QUICK], ids=QUICK)
def test_the_reference_gives_the_numbers_of_an_independent_implementation(row: Any) -> None:
    assert_rows("numpy", *row[1:])
