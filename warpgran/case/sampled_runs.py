"""Which runs of a large study stand for all of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np


def sampled_runs(columns: Mapping[str, Sequence[Any]], runs: int, most: int) -> list[int]:
    """Runs of a study to be examined: all of them, or of more than `most` about as many, in increasing order.

    Args:
        columns: Values by run of each swept key.
        runs: Number of runs.
        most: How many may be examined.

    Returns:
        Of a large study the first and the last run, those where a key has its least and its greatest value, the first
        run with each of its words, and others at equal distances.
    """
    if runs <= most:
        return list(range(runs))
    chosen = set(np.linspace(0, runs - 1, most).round().astype(int).tolist())
    for values in columns.values():
        numbers = np.asarray(values)
        if numbers.dtype.kind in "iuf":
            chosen |= {int(numbers.argmin()), int(numbers.argmax())}
        else:
            chosen |= set(np.unique([str(value) for value in values], return_index=True)[1].tolist())
    return sorted(chosen)
