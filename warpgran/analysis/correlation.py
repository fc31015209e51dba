"""Rank correlation: which parameter moves which result."""

from __future__ import annotations

import numpy as np

from warpgran.arrays import Array


def rank_correlation(a: Array, b: Array) -> float:
    """Spearman's correlation of two arrays over the entries where both are finite, ties averaged.

    Returns:
        A number in [-1, 1]; 0 where one of them does not vary.
    """
    import pandas as pd

    both = pd.DataFrame({"a": a, "b": b}, dtype=float).replace([np.inf, -np.inf], np.nan)
    found = float(both.corr("spearman").loc["a", "b"])
    return 0.0 if np.isnan(found) else found
