"""Rank correlation."""

import numpy as np
import pytest

from warpgran.analysis.correlation import rank_correlation


def test_rank_correlation_by_hand() -> None:
    a = np.array([1.0, 2.0, 3.0, 4.0])
    assert rank_correlation(a, np.exp(a)) == pytest.approx(1.0)
    assert rank_correlation(a, -(a**3)) == pytest.approx(-1.0)
    # Ranks 0 1 2 3 and 0.5 0.5 2 3: sum of squared deviations 5 and 4.5, of products 4.5.
    assert rank_correlation(a, np.array([1.0, 1.0, 5.0, 9.0])) == pytest.approx(4.5 / np.sqrt(5.0 * 4.5))
    assert rank_correlation(a, np.array([np.nan, 2.0, 1.0, np.inf])) == pytest.approx(-1.0)
    assert rank_correlation(a, np.ones(4)) == 0.0
    assert rank_correlation(a, np.full(4, np.nan)) == 0.0
