"""Where the front of a profile is."""

import numpy as np
import pytest

from warpgran.analysis.front import front

X = np.array([0.5, 1.5, 2.5, 3.5])


@pytest.mark.parametrize(
    ("h", "expected"),
    [
        ([1.0, 0.5, 0.0, 0.0], 2.0),
        ([0.0, 0.5, 0.0, 0.3], 3.5),  # the last cell is thick
        ([0.5, 0.0, 1.0, 0.0], 3.25),  # the foremost of two
        ([0.2, 0.1, 0.0, 0.0], np.nan),
    ],
)
def test_front_is_linear_between_centres(h: list[float], expected: float) -> None:
    np.testing.assert_equal(front(X, np.array(h), 0.25), expected)
