"""Sobol indices of Saltelli's design, first and total order, with bootstrap intervals.

The estimators are those of `scipy.stats.sobol_indices` (Saltelli et al., Comput. Phys. Commun. 181, 259, 2010, table 2
b and f), to which they agree to rounding. That function refuses numbers of samples that are no power of 2, as they are
when some are left out, and its bootstrap takes no seed. Here indices are ratios of weighted means, so that a resample
is a row of weights, and all of them, of all times, one product of matrices.
"""

from __future__ import annotations

import warnings
from typing import Any, NamedTuple

import numpy as np

from warpgran.arrays import Array

CONFIDENCE = 0.95
RESAMPLES = 999
AT_ONCE = 2**24
"""Most numbers of the products that are made at once, for a few outputs."""


class Estimate(NamedTuple):
    """A quantity with the ends of its interval, arrays of one shape."""

    value: Array
    low: Array
    high: Array


class SobolIndices(NamedTuple):
    """Indices, each (outputs, parameters); NaN where the output does not vary."""

    first_order: Estimate
    total_order: Estimate


def sobol(y: Array, seed: int, rounding: float = 1e-9) -> SobolIndices:
    """Indices of many outputs.

    Args:
        y: Outputs of the runs, shape (samples, d + 2, outputs): of A, B, and A with one parameter from B each.
        seed: Of the resamples.
        rounding: An output whose standard deviation is below this share of its size does not vary.
    """
    samples, blocks, outputs = y.shape
    step = max(1, AT_ONCE // (samples * blocks))
    parts = [_some(y[:, :, k : k + step], seed, rounding) for k in range(0, outputs, step)]
    joined = [[np.concatenate(ends) for ends in zip(*order, strict=True)] for order in zip(*parts, strict=True)]
    return SobolIndices(*(Estimate(*order) for order in joined))


def _some(y: Array, seed: int, rounding: float) -> SobolIndices:
    size = np.abs(y).max(axis=(0, 1))
    varies = y[:, :2].std(axis=(0, 1)) > rounding * size
    centred = (y - y[:, :2].mean(axis=(0, 1))) / np.where(varies, size, 1.0)
    terms = _terms(centred)

    def statistic(index: Array, axis: int = -1) -> Array:
        del axis  # the last
        return _indices(_weights(index), *terms)

    n = y.shape[0]
    value = np.where(varies, statistic(np.arange(n)[None])[..., 0], np.nan)
    low, high = np.where(varies, bootstrap(statistic, n, seed), np.nan)
    each = (Estimate(value[i].T, low[i].T, high[i].T) for i in range(2))
    return SobolIndices(*each)


def _terms(y: Array) -> tuple[Array, Array, Array]:
    """The terms whose means over the samples give both orders of indices (samples, 2, d, outputs), and the variance."""
    A, B, AB = y[:, :1], y[:, 1:2], y[:, 2:]
    both = np.stack([B * (AB - A), 0.5 * (A - AB) ** 2], axis=1)
    return both, y[:, :2].mean(axis=1), (y[:, :2] ** 2).mean(axis=1)


def _indices(weights: Array, both: Array, mean: Array, square: Array) -> Array:
    """Indices of weighted samples, shape (2, d, outputs, resamples)."""
    variance = weights @ square - (weights @ mean) ** 2
    numerators = (weights @ both.reshape(both.shape[0], -1)).reshape(-1, *both.shape[1:])
    with np.errstate(divide="ignore", invalid="ignore"):  # of outputs that do not vary
        return np.moveaxis(numerators / variance[:, None, None], 0, -1)


def _weights(index: Array) -> Array:
    """How often each sample is among the samples of a row, as a share; shape (rows, samples)."""
    n = index.shape[-1]
    return np.stack([np.bincount(row, minlength=n) for row in index]) / n


def bootstrap(statistic: Any, n: int, seed: int) -> tuple[Array, Array]:
    """Ends of the percentile intervals of a statistic of samples, which are resampled with replacement.

    Args:
        statistic: Takes rows of numbers of samples, and gives an array whose last dimension are the rows.
        n: Samples.
        seed: Of the resamples.

    Returns:
        The lower and the upper ends; NaN where a resample has no value, as when all but a few samples are alike.
    """
    from scipy import stats

    # Of few samples some resamples do not vary, and their indices are infinite; the standard error of all, which scipy
    # computes beside the ends, has no value then.
    with warnings.catch_warnings(), np.errstate(invalid="ignore"):
        warnings.simplefilter("ignore", stats.DegenerateDataWarning)
        found = stats.bootstrap(
            (np.arange(n),), statistic, n_resamples=RESAMPLES, vectorized=True, method="percentile",
            confidence_level=CONFIDENCE, random_state=np.random.default_rng(seed),
        )  # fmt: skip
    return found.confidence_interval.low, found.confidence_interval.high
