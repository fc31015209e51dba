"""Defaults, changing and comparing cases, the grid and the initial state."""

import math
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from warpgran.case.case import Case, CaseError

PROFILE = {"x": [0.0, 0.4], "h": [0.1, 0.2]}


# Defaults


def test_defaults_are_the_papers_table_1_and_the_schemes() -> None:
    assert Case().flat() == {
        "title": "",
        "rheology.mu1": 0.48,
        "rheology.mu2": 0.73,
        "rheology.I0": 0.279,
        "rheology.grain_diameter": 7e-4,
        "rheology.K": 4.09,
        "rheology.K_tilde": 0.2,
        "rheology.phi_stat": 0.582,
        "rheology.phi_eq": "f2",
        "rheology.phi_eq_N": 1.0,
        "rheology.mu_wall": 0.0,
        "rheology.channel_width": 0.2,
        "slope.angle": 0.0,
        "slope.gravity": 9.81,
        "slope.bed": None,
        "column.height": 0.14,
        "column.length": 0.20,
        "column.phi": 0.62,
        "column.start": -0.2,
        "column.profile": None,
        "grid.left": -0.2,
        "grid.right": 1.6,
        "grid.cells": 1800,
        "time.end": 1.8,
        "time.snapshots": {"every": 0.36},
        "time.series": {"every": 0.009},
        "time.rest_speed": pytest.approx(1.1719215e-3),  # 1e-3 sqrt(9.81 0.14)
        "time.stop_at_rest": False,
        "time.step_limit": 10_000_000,
        "scheme.order": 2,
        "scheme.start": 2,
        "scheme.alpha": 2.0,
        "scheme.lambda": None,
        "scheme.cfl": 0.45,
        "scheme.relaxation": None,
        "scheme.viscosity": None,
        "scheme.xi": None,
        "scheme.h_min": 3.5e-3,
        "scheme.h_bed": 0.0,
        "scheme.h_front": 1.4e-3,
        "scheme.left": "wall",
        "scheme.right": "open",
        "scheme.window": True,
    }


def test_the_defaults_of_order_1_are_the_papers() -> None:
    first, second = Case().with_(**{"scheme.order": 1}).flat(), Case().flat()
    assert {key: value for key, value in first.items() if value != second[key]} == {
        "scheme.order": 1,
        "scheme.start": None,
        "scheme.lambda": 0.0,
        "scheme.relaxation": "rational",
        "scheme.viscosity": "bounded",
        "scheme.xi": [2.0, 2.0, 5.0],
        "scheme.h_min": 7e-4,
    }


def test_defaults_follow_what_they_depend_on() -> None:
    case = Case().with_(
        **{"grid.left": -0.5, "rheology.grain_diameter": 1e-3, "slope.angle": 60.0, "slope.gravity": 2.0}
    )
    assert (case.column_start, case.h_min, case.h_front) == (-0.5, 5e-3, 2e-3)
    assert case.with_(**{"scheme.order": 1}).h_min == 1e-3
    assert case.rest_speed == pytest.approx(1e-3 * math.sqrt(0.14))
    profiled = case.with_(**{"column.profile": {"x": [0.0, 0.2, 0.4], "h": [0.1, 0.25, 0.2]}})
    assert profiled.rest_speed == pytest.approx(0.5e-3)
    given = {"column.start": 0.5, "scheme.h_min": 1e-5, "scheme.h_front": 2e-5, "time.rest_speed": 3e-5}
    case = case.with_(**given)
    assert (case.column_start, case.h_min, case.h_front, case.rest_speed) == (0.5, 1e-5, 2e-5, 3e-5)


def test_numpy_numbers_are_numbers() -> None:
    case = Case().with_(
        **{
            "slope.angle": np.int64(16),
            "column.phi": np.float32(0.5),
            "scheme.order": np.int32(1),
            "scheme.xi": np.ones(3),
            "grid.cells": np.int32(9),
        }
    )
    assert (case.slope.angle, case.column.phi, case.scheme.xi, case.grid.cells) == (16.0, 0.5, (1.0, 1.0, 1.0), 9)
    assert type(case.slope.angle) is float


# Changing and comparing


def test_with_checks_again_and_leaves_the_case_alone() -> None:
    case = Case()
    assert case.with_(**{"slope.angle": 16.0}).slope.angle == 16.0
    assert case.slope.angle == 0.0
    with pytest.raises(CaseError, match=r"^slope\.angle: 100\.0 is out of range"):
        case.with_(**{"slope.angle": 100.0})
    assert case.with_(slope={"angle": 3}).slope.angle == 3.0


def test_with_none_takes_a_key_back_to_its_default() -> None:
    case = Case().with_(**{"column.height": 0.1, "column.start": 0.3})
    profiled = case.with_(**{"column.profile": PROFILE, "column.height": None, "column.start": None})
    assert profiled.column.profile is not None
    assert case.with_(**{"column.height": None, "column.start": None}) == Case()


def test_cases_are_frozen() -> None:
    case = Case()
    with pytest.raises(ValidationError):
        case.title = "x"
    with pytest.raises(ValidationError):
        case.slope.angle = 3.0
    assert isinstance(case.with_(**{"time.snapshots": [0.1]}).time.snapshots, tuple)


def test_equality_is_that_of_the_values_in_force() -> None:
    case = Case()
    assert case == case.with_(**{"column.start": -0.2, "scheme.h_min": 3.5e-3, "slope.angle": -0.0})
    assert hash(case) == hash(case.with_(**{"column.start": -0.2, "slope.angle": -0.0}))
    assert case != case.with_(**{"column.start": -0.1})
    assert case != "case"
    assert case.with_(**{"slope.bed": {"x": [0, 1], "b": [0, 1]}}) != case.with_(
        **{"slope.bed": {"x": [0, 1], "b": [0, 2]}}
    )


# Grid and initial state


def small(**changes: Any) -> Case:
    """Cells of 0.25 m with centres 0.125, 0.375, ... on [0, 2]."""
    base = {"grid.left": 0.0, "grid.right": 2.0, "grid.cells": 8, "column.start": 0.5, "column.length": 0.625}
    return Case().with_(**{**base, **changes})


def test_grid_and_slope_by_hand() -> None:
    case = small(**{"slope.angle": 30.0})
    assert case.dx == 0.25
    assert case.x.tolist() == [0.125, 0.375, 0.625, 0.875, 1.125, 1.375, 1.625, 1.875]
    assert case.bed.tolist() == [0.0] * 8
    assert case.bhat == pytest.approx(-case.x / math.sqrt(3), rel=1e-15)
    assert case.g_c == pytest.approx(9.81 * math.sqrt(3) / 2, rel=1e-15)
    assert small(**{"slope.gravity": 1.62}).g_c == 1.62


def test_bed_is_linear_between_points_and_constant_beyond() -> None:
    case = small(**{"slope.angle": 45.0, "slope.bed": {"x": [0.375, 0.875], "b": [1.0, 3.0]}})
    assert case.bed.tolist() == [1.0, 1.0, 2.0, 3.0, 3.0, 3.0, 3.0, 3.0]
    assert case.bhat == pytest.approx(case.bed - case.x, rel=1e-14)


def test_rectangular_column_ends_are_out() -> None:
    h, phi = small(**{"scheme.h_bed": 0.01}).initial_state()  # ends at 1.125, a centre
    assert h.tolist() == [0.01, 0.01, 0.14, 0.14, 0.01, 0.01, 0.01, 0.01]
    assert phi.tolist() == [0.62] * 8
    h, _ = small(**{"column.start": 0.625, "column.length": 0.6}).initial_state()
    assert h.tolist() == [0.0, 0.0, 0.0, 0.14, 0.14, 0.0, 0.0, 0.0]


def test_profile_is_linear_zero_outside_and_at_least_h_bed() -> None:
    profile = {"x": [0.375, 0.875, 1.125], "h": [0.2, 0.4, 0.0], "phi": [0.5, 0.6, 0.7]}
    case = small(
        **{"column.start": None, "column.length": None, "column.profile": profile, "scheme.h_bed": 0.01, "title": "x"}
    )
    h, phi = case.initial_state()
    assert h == pytest.approx([0.01, 0.2, 0.3, 0.4, 0.01, 0.01, 0.01, 0.01], rel=1e-15)
    assert phi == pytest.approx([0.5, 0.5, 0.55, 0.6, 0.7, 0.7, 0.7, 0.7], rel=1e-15)
    assert h.dtype == phi.dtype == case.x.dtype == np.float64
    assert h.shape == phi.shape == (8,)


def test_a_profile_goes_with_the_columns_phi() -> None:
    assert Case().with_(**{"column.profile": PROFILE, "column.phi": 0.5}).initial_state()[1][0] == 0.5


def test_velocity_is_linear_and_zero_outside() -> None:
    assert Case().initial_velocity().tolist() == [0.0] * 1800
    profile = {"x": [0.375, 0.875], "h": [0.2, 0.4], "v": [1.0, -2.0]}
    case = small(**{"column.start": None, "column.length": None, "column.profile": profile})
    assert case.initial_velocity().tolist() == [0.0, 1.0, -0.5, -2.0, 0.0, 0.0, 0.0, 0.0]
