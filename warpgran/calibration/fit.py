"""The second stage: the best fit by least squares, and what the data leave undetermined near it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from warpgran.arrays import Array
from warpgran.calibration.batches import Predict
from warpgran.calibration.error_model import ErrorModel, Likeliest
from warpgran.calibration.screening import at_shares, shares_at
from warpgran.case.distributions import Distribution
from warpgran.errors import ResultError

STEP = 0.01
"""Of the central differences, in shares of the prior: large enough that a time step more or less does not matter."""
EDGE = 1e-3
"""How near to the ends of the prior a fit goes, as a share of it."""
FAR = 1e3
"""Residual of a run that failed, in standard deviations."""
PRIOR_SD = 1.0 / np.sqrt(12.0)
"""Standard deviation of a share of the prior."""
LEAST_STEP, MOST_STEPS = 3e-3, 12
"""Of a fit: relative to the shares, and their number."""
ROUNDS = 2
"""Fits from each start: the second with the errors that the first has left."""


@dataclass(frozen=True)
class Fit:
    """A best fit.

    Attributes:
        names: The parameters.
        theta: The best point, shape (parameters,).
        prediction: There, shape (data,).
        log_likelihood: There.
        errors: The likeliest errors there.
        information: Fisher information J^T C^-1 J, the parameters in standard deviations of their priors.
        covariance: Of the parameters in their units, information of the prior included.
        units: Standard deviation of the prior of each parameter at the best point, in its unit.
        ends: Where each start has led, and its log-likelihood, shape (starts, parameters + 1).
    """

    names: tuple[str, ...]
    theta: Array
    prediction: Array
    log_likelihood: float
    errors: Likeliest
    information: Array
    covariance: Array
    units: Array
    ends: Array

    def combinations(self) -> list[tuple[float, Array]]:
        """Directions in the space of the parameters, the best determined first.

        Returns:
            For each the standard deviation that the data leave along it, over that of the prior, and its components in
            standard deviations of the prior.
        """
        values, vectors = np.linalg.eigh(self.information)
        return [
            (float(1.0 / np.sqrt(1.0 + max(value, 0.0))), vector)
            for value, vector in zip(values, vectors.T, strict=True)
        ][::-1]


def best_fit(
    predict: Predict,
    model: Callable[[Array], ErrorModel],
    priors: Mapping[str, Distribution],
    starts: Array,
) -> Fit:
    """Seek the best fit from several starts.

    Args:
        predict: Predictions of a batch of points.
        model: The error model near a prediction (data,).
        priors: Of the parameters; the fit stays within them.
        starts: Points to start from, shape (starts, parameters).

    Raises:
        ResultError: No start can be run.
    """
    if not len(starts):
        raise ResultError("no run of the screening ended cleanly, so that there is nowhere to start a fit from")
    found = [_from(predict, model, priors, start) for start in starts]
    ends = np.array([[*fit.theta, fit.log_likelihood] for fit in found])
    best = found[int(np.argmax(ends[:, -1]))]
    return Fit(**{**vars(best), "ends": ends})


def _from(
    predict: Predict, model: Callable[[Array], ErrorModel], priors: Mapping[str, Distribution], start: Array
) -> Fit:
    """The fit from one start."""
    from scipy.optimize import least_squares

    around = _Around(predict, priors)
    shares = np.clip(shares_at(priors, start[None])[0], EDGE, 1.0 - EDGE)
    for _ in range(ROUNDS):
        errors = model(around.prediction(shares)).likeliest(around.prediction(shares))
        found = least_squares(
            lambda u, errors=errors: around.residuals(u, errors),
            shares,
            jac=lambda u, errors=errors: around.jacobian(u, errors),
            bounds=(EDGE, 1.0 - EDGE),
            xtol=LEAST_STEP,
            ftol=1e-3,
            max_nfev=MOST_STEPS,
        )
        shares = found.x
    prediction = around.prediction(shares)
    errors = model(prediction).likeliest(prediction)
    slopes = around.jacobian(shares, errors) * PRIOR_SD
    information = slopes.T @ slopes
    units = around.units(shares)
    covariance = np.linalg.inv(information + np.eye(len(units))) * np.outer(units, units)
    log_likelihood = float(errors.model.log_likelihood(prediction[None])[0])
    theta = at_shares(priors, shares[None])[0]
    return Fit(tuple(priors), theta, prediction, log_likelihood, errors, information, covariance, units, np.empty(0))


class _Around:
    """Predictions at a point and at the points of the central differences around it, as one batch."""

    def __init__(self, predict: Predict, priors: Mapping[str, Distribution]) -> None:
        self._predict, self._priors = predict, priors
        self._known: dict[bytes, tuple[Array, Array]] = {}

    def _at(self, shares: Array) -> tuple[Array, Array]:
        """The prediction (data,), and its slopes (data, parameters) over shares of the prior; 0 where runs failed."""
        key = shares.tobytes()
        if key not in self._known:
            d = shares.size
            steps = np.concatenate([np.zeros((1, d)), STEP * np.eye(d), -STEP * np.eye(d)])
            points = np.clip(shares + steps, 0.5 * EDGE, 1.0 - 0.5 * EDGE)
            middle, *rest = self._predict(at_shares(self._priors, points))
            up, down = np.where(np.isfinite(rest), rest, middle).reshape(2, d, -1)
            width = np.array([points[1 + j, j] - points[1 + d + j, j] for j in range(d)])
            self._known[key] = middle, np.nan_to_num((up - down).T / width)
        return self._known[key]

    def prediction(self, shares: Array) -> Array:
        """At a point, shape (data,).

        Raises:
            ResultError: Its run failed.
        """
        found = self._at(shares)[0]
        if not np.isfinite(found).all():
            raise ResultError("the runs at the best fit failed")
        return found

    def residuals(self, shares: Array, errors: Likeliest) -> Array:
        """At a point, whitened, shape (data,)."""
        prediction = self._at(shares)[0]
        if not np.isfinite(prediction).all():
            return np.full(prediction.size, FAR)
        return np.asarray(errors.whitened(prediction[None])[0])

    def jacobian(self, shares: Array, errors: Likeliest) -> Array:
        """Of the whitened residuals, shape (data, parameters)."""
        slopes = self._at(shares)[1]
        value = errors.model.value
        return np.asarray(errors.whitened(value + slopes.T).T)

    def units(self, shares: Array) -> Array:
        """What a standard deviation of a share of the prior is at a point, in the unit of each parameter."""
        around = np.clip(np.stack([shares - STEP, shares + STEP]), 0.5 * EDGE, 1.0 - 0.5 * EDGE)
        low, high = at_shares(self._priors, around)
        return np.asarray((high - low) / (around[1] - around[0]) * PRIOR_SD)
