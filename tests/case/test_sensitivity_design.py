"""The points of Saltelli's and of Morris's design, and the values that are made of them."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from warpgran.case.sensitivity_design import JUMP, design_values, saltelli, trajectories
from warpgran.case.sensitivity_section import read_sensitivity


def test_each_run_of_a_base_sample_takes_one_parameter_from_the_other_half() -> None:
    points = saltelli(16, 3, seed=1)
    assert points.shape == (16, 5, 3)
    A, B = points[:, 0], points[:, 1]
    for i in range(3):
        changed = points[:, 2 + i] != A
        assert (changed == (np.arange(3) == i)).all()
        assert (points[:, 2 + i, i] == B[:, i]).all()


def test_both_halves_together_are_balanced() -> None:
    points = saltelli(64, 2, seed=3)
    both = np.concatenate([points[:, 0], points[:, 1]], axis=1)
    for column in both.T:  # one point in each of 64 equal parts
        assert sorted(np.floor(column * 64).astype(int).tolist()) == list(range(64))


def test_fewer_samples_are_the_first_of_more() -> None:
    assert (saltelli(32, 2, seed=5)[:8] == saltelli(8, 2, seed=5)).all()


@pytest.mark.parametrize("points", [saltelli, trajectories])
def test_the_seed_decides(points: object) -> None:
    assert callable(points)
    assert (points(8, 3, 1) == points(8, 3, 1)).all()
    assert (points(8, 3, 1) != points(8, 3, 2)).any()


@pytest.mark.parametrize("points", [saltelli(256, 3, seed=1), trajectories(256, 3, seed=1)])
def test_points_lie_inside(points: np.ndarray) -> None:
    assert points.min() > 0.0
    assert points.max() < 1.0


def test_a_trajectory_moves_each_parameter_once_by_half() -> None:
    points = trajectories(50, 4, seed=1)
    assert points.shape == (50, 5, 4)
    steps = np.diff(points, axis=1)
    moved = steps != 0.0
    assert (moved.sum(axis=1) == 1).all()  # each parameter once
    assert (moved.sum(axis=2) == 1).all()  # one parameter at a time
    np.testing.assert_allclose(np.abs(steps[moved]), JUMP, rtol=1e-15)
    first = moved[:, 0].argmax(axis=1)
    assert set(first.tolist()) == {0, 1, 2, 3}  # in random order


def test_trajectories_start_in_every_part_of_each_range() -> None:
    starts = trajectories(10, 2, seed=1)[:, 0]
    for column in starts.T:
        assert sorted(np.floor(column * 10).astype(int).tolist()) == list(range(10))


def test_values_follow_their_distributions() -> None:
    over = {
        "rheology.K": {"low": 0.0, "high": 8.0},
        "rheology.grain_diameter": {"low": 1e-4, "high": 1e-2, "scale": "log"},
        "rheology.mu1": {"mean": 0.48, "sd": 0.02},
        "grid.cells": {"low": 99.6, "high": 102.4},
    }
    values = design_values(read_sensitivity({"over": over, "samples": 256}))
    assert [len(column) for column in values.values()] == [256 * 6] * 4
    laws = {
        "rheology.K": stats.uniform(0.0, 8.0),
        "rheology.grain_diameter": stats.loguniform(1e-4, 1e-2),
        "rheology.mu1": stats.norm(0.48, 0.02),
    }
    for key, law in laws.items():
        base = np.array(values[key])[0::6]
        assert stats.kstest(base, law.cdf).statistic < 1 / 256 + 1e-6  # as even as 256 points can be
    assert {type(value) for value in values["grid.cells"]} == {int}
    assert set(values["grid.cells"]) == {100, 101, 102}
