"""Rank correlation: which parameter moves which result."""

from __future__ import annotations

import numpy as np

from warpgran.arrays import Array


def rank_correlation(a: Array, b: Array) -> float:
    """Spearman's correlation of two arrays over the entries where both are known: that of their ranks, ties averaged.

    Returns:
        A number in [-1, 1]; 0 where one of them does not vary.
    """
    known = np.isfinite(a) & np.isfinite(b)
    ranks = [_ranks(values[known]) for values in (a, b)]
    a, b = (rank - rank.mean() if rank.size else rank for rank in ranks)
    norm = float(np.sqrt((a @ a) * (b @ b)))
    return float(a @ b) / norm if norm > 0 else 0.0


def _ranks(values: Array) -> Array:
    """Ranks from 0, the mean rank for equal values."""
    _, which, counts = np.unique(values, return_inverse=True, return_counts=True)
    return np.asarray((np.cumsum(counts) - (counts + 1) / 2)[which])
