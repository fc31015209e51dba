"""Elementary effects: exact ones, and those of another program."""

from __future__ import annotations

import numpy as np
import pytest
from helpers.designs import ishigami

from warpgran.case.sensitivity_design import trajectories
from warpgran.errors import ResultError
from warpgran.sensitivity_analysis.morris import effects, morris


def test_a_linear_model_has_one_effect_of_each_parameter() -> None:
    x = trajectories(10, 3, seed=1)
    weights = np.array([3.0, -2.0, 0.0])
    found = morris((x @ weights)[:, :, None], x, seed=1)
    np.testing.assert_allclose(found.mu[0], weights, atol=1e-12)
    np.testing.assert_allclose(found.sigma[0], 0.0, atol=1e-12)
    for end in found.mu_star:
        np.testing.assert_allclose(end[0], np.abs(weights), atol=1e-12)


def test_effects_are_of_the_range_whatever_its_units() -> None:
    u = trajectories(10, 2, seed=1)
    values = 5.0 + 1e-3 * u
    found = morris((1e3 * (values[..., 0] - 5.0))[:, :, None], values, seed=1)
    np.testing.assert_allclose(found.mu[0], [1.0, 0.0], atol=1e-9)


def test_a_product_has_effects_that_depend_on_the_other() -> None:
    x = trajectories(4000, 2, seed=1)
    found = morris((x[..., 0] * x[..., 1])[:, :, None], x, seed=1)
    np.testing.assert_allclose(found.mu[0], 0.5, atol=0.02)  # the mean of the other
    np.testing.assert_allclose(found.sigma[0], 1.0 / np.sqrt(12.0), atol=0.02)  # and its standard deviation


def test_a_symmetric_hill_cancels_in_mu_alone() -> None:
    x = trajectories(2000, 1, seed=1)
    found = morris(((x[..., 0] - 0.5) ** 2)[:, :, None], x, seed=1)
    np.testing.assert_allclose(found.mu[0], 0.0, atol=0.02)
    np.testing.assert_allclose(found.mu_star.value[0], 0.25, atol=0.02)  # the mean of 2 |u - 1/4| for u in (0, 1/2)


def test_the_same_as_salib() -> None:
    analyse = pytest.importorskip("SALib.analyze.morris").analyze
    x = trajectories(50, 3, seed=1)
    y = ishigami(x)
    ours = morris(y[:, :, None], x, seed=1)
    problem = {"num_vars": 3, "names": list("abc"), "bounds": [[0.0, 1.0]] * 3}
    theirs = analyse(problem, x.reshape(-1, 3), y.ravel(), num_levels=4, seed=1)
    scale = (2.0 / 3.0) / 0.5  # they take the step of 4 levels
    np.testing.assert_allclose(ours.mu[0] / scale, np.asarray(theirs["mu"], dtype=float), rtol=1e-9)
    np.testing.assert_allclose(ours.mu_star.value[0] / scale, np.asarray(theirs["mu_star"], dtype=float), rtol=1e-9)
    np.testing.assert_allclose(ours.sigma[0] / scale, np.asarray(theirs["sigma"], dtype=float), rtol=1e-9)


def test_intervals_narrow_with_more_trajectories() -> None:
    def width(r: int) -> float:
        x = trajectories(r, 3, seed=1)
        _, low, high = morris(ishigami(x)[:, :, None], x, seed=1).mu_star
        return float((high - low).mean())

    assert width(400) == pytest.approx(width(25) / 4, rel=0.5)


def test_runs_that_are_no_trajectory_are_refused() -> None:
    x = trajectories(4, 2, seed=1)
    x[2, 1] = x[2, 0]
    with pytest.raises(ResultError, match="step 4 of the design does not change one parameter alone"):
        effects(x[..., :1], x)
