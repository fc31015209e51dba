"""Independent proposals of the sampler: a mixture of Student kernels around known points."""

from __future__ import annotations

import numpy as np
from scipy.linalg import cholesky
from scipy.special import logsumexp

from warpgran.arrays import Array

FREEDOM = 8.0
"""Degrees of freedom of the kernels: their tails reach beyond those of the points, as an independent proposal must."""
WIDTHS = (0.3, 0.45, 0.65, 1.0)
"""Kernel widths to choose from, in standard deviations of the points; at 1 all kernels are the same one."""


class Mixture:
    """Student kernels around weighted points that are shrunk toward their mean (West 1993).

    A kernel of width b is drawn around mean + sqrt(1 - b^2) (point - mean), so that the mixture has the mean and the
    covariance of the points whatever its width: one Student density where the points look like one, and something
    that bends with them or falls apart into islands where they do. The width is the one of WIDTHS that gives each
    point the highest density from all others.

    Attributes:
        mean, factor: mean (d,) and Cholesky factor (d, d) of the covariance of the points.
        width: of a kernel, in standard deviations.
    """

    def __init__(self, points: Array, weights: Array):
        """From points (n, d) and their weights (n,), which need not add up to 1.

        Raises:
            numpy.linalg.LinAlgError: The points lie in a plane or are too few.
        """
        # A rejected move repeats its point: repeats are one point, or each would be the best predictor of the other.
        points, which = np.unique(points, axis=0, return_inverse=True)
        weights = np.bincount(which.ravel(), weights, len(points))
        points, weights = points[weights > 0.0], weights[weights > 0.0]
        self._weights = weights / weights.sum()
        self.mean = self._weights @ points
        deviations = points - self.mean
        covariance = (deviations.T * self._weights) @ deviations / (1.0 - self._weights @ self._weights)
        self.factor = cholesky(covariance, lower=True)
        self._whitening = np.linalg.inv(self.factor).T  # a triangular solve wakes all threads of BLAS, each time
        self._white = self.whiten(points)
        scores = [self._weights @ self._log_density(self._white, width, others_alone=True) for width in WIDTHS]
        self.width = WIDTHS[int(np.argmax(scores))]

    def whiten(self, points: Array) -> Array:
        """Points (n, d) in coordinates in which the mixture has mean 0 and covariance 1."""
        return (points - self.mean) @ self._whitening

    def log_density(self, points: Array) -> Array:
        """Log density (n,) at points (n, d), up to a constant."""
        return self._log_density(self.whiten(points), self.width)

    def draw(self, n: int, rng: np.random.Generator) -> Array:
        """Points (n, d) from the mixture."""
        centres = self._white[rng.choice(len(self._weights), n, p=self._weights)]
        stretch = np.sqrt(FREEDOM / rng.chisquare(FREEDOM, (n, 1)))
        steps = _student_scale(self.width) * stretch * rng.standard_normal(centres.shape)
        return self.mean + (np.sqrt(1.0 - self.width**2) * centres + steps) @ self.factor.T

    def _log_density(self, white: Array, width: float, others_alone: bool = False) -> Array:
        """At whitened points; with `others_alone` these are the mixture's own, and each leaves out its own kernel."""
        d = white.shape[1]
        scale = _student_scale(width)
        away = (white[:, None] - np.sqrt(1.0 - width**2) * self._white) / scale
        logs = -0.5 * (FREEDOM + d) * np.log1p((away**2).sum(axis=2) / FREEDOM) + np.log(self._weights)
        if others_alone:
            np.fill_diagonal(logs, -np.inf)
        return logsumexp(logs, axis=1) - d * np.log(scale)


def _student_scale(width: float) -> float:
    """Scale of a Student variable whose standard deviation is `width`."""
    return width * float(np.sqrt((FREEDOM - 2.0) / FREEDOM))
