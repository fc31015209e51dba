"""The best fit of a model whose answer is known: linear in its parameters."""

from __future__ import annotations

import numpy as np
import pytest

from warpgran.calibration.error_model import ErrorModel
from warpgran.calibration.experiments import Experiment, Experiments, Observed
from warpgran.calibration.fit import Fit, best_fit
from warpgran.calibration.screening import Screening, at_shares, shares_at, sobol_points
from warpgran.case.case import Case
from warpgran.case.distributions import Distribution
from warpgran.errors import ResultError

T = np.linspace(0.0, 1.0, 12)
SIGMA = 0.05
SLOPES = np.stack([np.ones(12), T, 0.5 * T + 1e-3 * T**2])  # the third does what the second does
TRUTH = np.array([0.3, 1.2, -0.4])
PRIORS = {
    "a": Distribution(low=-1.0, high=2.0),
    "b": Distribution(mean=1.0, sd=1.0),
    "c": Distribution(low=-1.0, high=1.0),
}
NOISE = np.random.default_rng(8).normal(0.0, SIGMA, 12)


def experiments(value: np.ndarray) -> Experiments:
    observed = (Observed("front", T, np.full(12, np.nan), value, np.full(12, SIGMA)),)
    return Experiments(Case(), (Experiment("0°", {}, observed),))


def fitted(predict: object = lambda theta: theta @ SLOPES, starts: np.ndarray | None = None) -> Fit:
    measured = experiments(TRUTH @ SLOPES + NOISE)
    model = ErrorModel(measured)
    starts = sobol_points(PRIORS, 4, 1) if starts is None else starts
    return best_fit(predict, lambda prediction: model, PRIORS, starts)  # type: ignore[arg-type]


def test_fit_is_that_of_linear_least_squares_in_what_is_determined() -> None:
    fit = fitted()
    line = np.linalg.lstsq(SLOPES[:2].T, TRUTH @ SLOPES + NOISE, rcond=None)[0]
    assert fit.theta[0] == pytest.approx(line[0], abs=0.1 * SIGMA)
    assert fit.theta[1] + 0.5 * fit.theta[2] == pytest.approx(line[1], abs=0.1 * SIGMA)
    assert fit.ends.shape == (4, 4)
    assert fit.log_likelihood == fit.ends[:, -1].max()


def test_the_combination_that_the_data_leave_open_is_found() -> None:
    fit = fitted()
    ratios = [ratio for ratio, _ in fit.combinations()]
    assert ratios == sorted(ratios) and ratios[1] < 0.3 and ratios[2] > 0.95
    moved = fit.combinations()[2][1] * fit.units  # b and c, which undo each other
    assert abs(moved[0]) < 0.02
    assert moved[1] / moved[2] == pytest.approx(-0.5, rel=0.05)


def test_covariance_is_that_of_the_information_and_the_prior() -> None:
    fit = fitted()
    assert fit.units == pytest.approx([3.0 / np.sqrt(12.0), fit.units[1], 2.0 / np.sqrt(12.0)], rel=1e-6)
    errors = fit.errors.model.kinds["front"]
    node, noise = fit.errors.nodes["front"]
    whitened = errors.whitened(-SLOPES, node, noise)
    expected = np.linalg.inv(whitened @ whitened.T + np.diag(fit.units**-2.0))
    assert np.diag(fit.covariance) == pytest.approx(np.diag(expected), rel=0.02)


def test_failed_runs_are_walked_around() -> None:
    def predict(theta: np.ndarray) -> np.ndarray:
        return np.where(theta[:, :1] > 1.0, np.nan, theta @ SLOPES)

    fit = fitted(predict, np.array([[0.9, 0.0, 0.0]]))
    assert fit.theta[0] == pytest.approx(0.3, abs=0.15)
    with pytest.raises(ResultError, match="nowhere to start a fit from"):
        fitted(predict, np.empty((0, 3)))


def test_shares_and_points_of_the_prior_are_inverse() -> None:
    theta = sobol_points(PRIORS, 16, 3)
    assert at_shares(PRIORS, shares_at(PRIORS, theta)) == pytest.approx(theta, rel=1e-9)
    assert np.array_equal(theta, sobol_points(PRIORS, 16, 3)) and not np.array_equal(theta, sobol_points(PRIORS, 16, 4))


def test_screening_tells_what_the_prior_cannot_reach() -> None:
    predictions = np.array([[0.0, 1.0], [0.5, 2.0], [np.nan, np.nan]])
    found = Screening(np.array([[1.0], [2.0], [3.0]]), predictions)
    assert found.failed == 1
    measured = Experiments(
        Case(), (Experiment("0°", {}, (Observed("front", T[:2], T[:2], np.array([0.6, 3.0]), None),)),)
    )
    assert found.beyond_reach(measured, np.array([0.1, 0.1])).tolist() == [False, True]
    assert found.best(np.array([-5.0, -1.0, -np.inf]), 3).tolist() == [[2.0], [1.0]]
