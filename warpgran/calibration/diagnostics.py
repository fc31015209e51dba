"""Convergence of a posterior: R-hat and effective sample sizes by Vehtari et al. (2021), Bayesian Analysis 16.

scipy has neither; ArviZ, which has both, would bring a stack of packages for two formulas. The tests compare with it.
"""

from __future__ import annotations

import numpy as np
from scipy.fft import irfft, rfft
from scipy.special import ndtri
from scipy.stats import rankdata

from warpgran.arrays import Array


def r_hat(draws: Array) -> float:
    """Rank-normalized split R-hat of one quantity, the greater one of bulk and tails.

    Args:
        draws: (chains, draws), at least four draws.

    Returns:
        1 where all halves of the chains agree; infinity where they are constant and differ, 1 where all are equal.
    """
    halves = _split(draws)
    return max(_plain_r_hat(_normal_scores(halves)), _plain_r_hat(_normal_scores(abs(halves - np.median(halves)))))


def effective_size(draws: Array) -> float:
    """Effective number of draws for the bulk of the distribution, of one quantity (chains, draws)."""
    return _size(_normal_scores(_split(draws)))


def tail_size(draws: Array) -> float:
    """Effective number of draws for the 5 % and the 95 % quantile: the lesser one; of one quantity (chains, draws)."""
    return min(_size(_split((draws <= np.quantile(draws, q)).astype(float))) for q in (0.05, 0.95))


def _split(draws: Array) -> Array:
    """The halves of the chains, as chains; an odd middle draw is left out."""
    half = draws.shape[1] // 2
    return np.concatenate([draws[:, :half], draws[:, -half:]])


def _normal_scores(draws: Array) -> Array:
    """Normal quantiles of the ranks among all draws, ties sharing theirs."""
    ranks = rankdata(draws, axis=None).reshape(draws.shape)
    return ndtri((ranks - 0.375) / (draws.size + 0.25))


def _plain_r_hat(draws: Array) -> float:
    """Square root of the variance of all draws over that within the chains."""
    n = draws.shape[1]
    within = draws.var(axis=1, ddof=1).mean()
    between = draws.mean(axis=1).var(ddof=1)
    if within == 0.0:
        return 1.0 if between == 0.0 else np.inf
    return float(np.sqrt((n - 1) / n + between / within))


def _size(draws: Array) -> float:
    """Effective number of draws by autocorrelation, summed as long as pairs are positive and fall (Geyer 1992)."""
    chains, n = draws.shape
    if np.ptp(draws) == 0.0:
        return float(draws.size)
    deviations = draws - draws.mean(axis=1, keepdims=True)
    power = abs(rfft(deviations, 2 * n, axis=1)) ** 2
    covariance = irfft(power, 2 * n, axis=1)[:, :n].mean(axis=0) / n
    within = covariance[0] * n / (n - 1)
    whole = within * (n - 1) / n + draws.mean(axis=1).var(ddof=1)
    correlation = 1.0 - (within - covariance) / whole
    correlation[0] = 1.0
    pairs = correlation[: n - n % 2].reshape(-1, 2).sum(axis=1)
    end = int(np.argmax(pairs <= 0.0)) if (pairs <= 0.0).any() else pairs.size
    time = -1.0 + 2.0 * np.minimum.accumulate(pairs[:end]).sum()
    if 2 * end < n:
        time += max(correlation[2 * end], 0.0)
    return float(chains * n / max(time, 1.0 / np.log10(chains * n)))
