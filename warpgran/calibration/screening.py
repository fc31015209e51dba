"""The first stage: Sobol points of the prior, whose runs are kept as an ordinary result file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from warpgran.arrays import Array
from warpgran.calibration.experiments import Experiments
from warpgran.case.distributions import Distribution


def sobol_points(priors: Mapping[str, Distribution], count: int, seed: int) -> Array:
    """Scrambled Sobol points of the prior, shape (count, parameters)."""
    from scipy.stats import qmc

    shares = qmc.Sobol(len(priors), seed=np.random.default_rng(seed)).random(count)
    return at_shares(priors, shares)


def at_shares(priors: Mapping[str, Distribution], shares: Array) -> Array:
    """Points below whose coordinates lie shares in (0, 1) of the prior; shape of the shares, (points, parameters)."""
    return np.stack([prior.ppf(u) for prior, u in zip(priors.values(), shares.T, strict=True)], axis=1)


def shares_at(priors: Mapping[str, Distribution], theta: Array) -> Array:
    """Shares of the prior below the coordinates of points, shape of theta, (points, parameters)."""
    return np.stack([prior.law.cdf(x) for prior, x in zip(priors.values(), theta.T, strict=True)], axis=1)


@dataclass(frozen=True)
class Screening:
    """What the first stage has found.

    Attributes:
        theta: Points of the prior, shape (points, parameters).
        predictions: Their predictions, shape (points, data); NaN where a run failed.
    """

    theta: Array
    predictions: Array

    @property
    def failed(self) -> int:
        """Points of which a run failed, or could not be made."""
        return int((~np.isfinite(self.predictions).all(axis=1)).sum())

    def best(self, log_likelihood: Array, count: int) -> Array:
        """The points of the largest likelihoods, the best first, shape (count, parameters)."""
        order = np.argsort(-log_likelihood, kind="stable")
        return self.theta[order[: min(count, int(np.isfinite(log_likelihood).sum()))]]

    def beyond_reach(self, experiments: Experiments, deviation: Array) -> Array:
        """Measurements that no point of the prior comes within three deviations of: (data,) of bool.

        Args:
            experiments: What was measured.
            deviation: Standard deviation of each measurement, shape (data,), without the error of the model.
        """
        whole = self.predictions[np.isfinite(self.predictions).all(axis=1)]
        value = experiments.value
        over, under = whole.min(axis=0) - value, value - whole.max(axis=0)
        return np.asarray(np.maximum(over, under) > 3.0 * deviation)
