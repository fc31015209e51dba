"""Kernels against the NumPy reference, step for step, and against the numbers of an independent implementation."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from cases import drawn, small

from warpgran.case import Case
from warpgran.engines import Engine, NumPyEngine, WarpEngine
from warpgran.schema import Status


def finished(engine: Engine, t: float) -> Engine:
    engine.advance(t, lambda: True)
    return engine


def differences(case: Case, a: Engine, b: Engine) -> np.ndarray:
    """Largest differences of h/h0, v/sqrt(g h0) and phi."""
    scales = case.column.height, np.sqrt(9.81 * case.column.height), 1.0
    both = zip(a.profiles(), b.profiles(), scales, strict=True)
    return np.array([np.abs(p[0] - q[0]).max() / scale for p, q, scale in both])


@pytest.mark.parametrize("seed", range(24))
def test_kernels_agree_with_numpy_over_100_steps_of_any_option(seed: int) -> None:
    case = drawn(seed)
    kernels, reference = finished(WarpEngine([case]), 10.0), finished(NumPyEngine([case]), 10.0)
    assert kernels.steps == reference.steps == 100
    assert kernels.status == reference.status == Status.STEP_LIMIT
    assert differences(case, kernels, reference).max() <= 1e-11
    assert np.abs(kernels.profiles()[1][0]).max() > 1e-6  # something moved


@pytest.fixture(scope="module")
def collapse() -> Case:
    return small(**{"grid.cells": 800, "time.end": 0.3, "time.snapshots": [0.1, 0.3]})


def test_whole_collapse_agrees_with_numpy(collapse: Case) -> None:
    kernels, reference = WarpEngine([collapse]), NumPyEngine([collapse])
    for t in (0.1, 0.3):
        finished(kernels, t)
        finished(reference, t)
    assert kernels.steps == reference.steps
    assert kernels.t == reference.t == 0.3
    assert differences(collapse, kernels, reference).max() <= 1e-10


def test_float32_agrees_with_float64(collapse: Case) -> None:
    single, double = finished(WarpEngine([collapse], precision="float32"), 0.3), finished(WarpEngine([collapse]), 0.3)
    assert 0.0 < differences(collapse, single, double).max() <= 1e-4


def test_scalars_of_kernels_agree_with_numpy(collapse: Case) -> None:
    kernels, reference = finished(WarpEngine([collapse]), 0.1), finished(NumPyEngine([collapse]), 0.1)
    ours, theirs = kernels.scalars(), reference.scalars()
    assert ours.keys() == theirs.keys()
    for name, value in theirs.items():
        assert ours[name] == pytest.approx(value, rel=1e-10), name


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


@pytest.mark.parametrize("engine", [WarpEngine, NumPyEngine])
@pytest.mark.parametrize(("angle", "changes", "rows"), [row[1:] for row in TABLE], ids=[row[0] for row in TABLE])
def test_numbers_of_an_independent_implementation(
    engine: Any, angle: float, changes: dict[str, Any], rows: list[tuple[float, int | None, str]]
) -> None:
    grid = {"grid.right": 0.6, "grid.cells": 800} if angle == 0.0 else {"grid.right": 1.4, "grid.cells": 1600}
    times = [t for t, _, _ in rows]
    case = Case().with_(
        **{"slope.angle": angle, "time.end": times[-1], "time.snapshots": times, "time.series": [], **grid, **changes}
    )
    run = engine([case])
    volume = run.scalars()["volume"][0]
    for t, steps, expected in rows:
        finished(run, t)
        now = {name: value[0] for name, value in run.scalars().items()}
        change = 100 * (now["volume"] / volume - 1)
        assert f"{100 * now['h_max']:.3f} {100 * now['front']:.2f} {now['v_flow']:.5f} {change:.2f}" == expected
        assert steps is None or run.steps == steps
