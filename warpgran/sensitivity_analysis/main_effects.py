"""Main effects: mean and spread of an output where one parameter has a value, whatever the others are."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from warpgran.arrays import Array

PER_BIN = 64
"""Fewest independent runs of a bin that are aimed at."""
MOST_BINS = 16
SPREAD = (0.05, 0.95)
"""Shares of the runs of a bin that lie below its low and its high line."""


class MainEffects(NamedTuple):
    """By bins of equal probability of each parameter.

    Attributes:
        at: Mean value of the parameter, (parameters, bins).
        mean: Of the output, (outputs, parameters, bins).
        low, high: 5 and 95 percent of the output, of the same shape.
    """

    at: Array
    mean: Array
    low: Array
    high: Array


def main_effects(y: Array, values: Array) -> MainEffects:
    """Main effects from the runs of A and B, which are independent of each other.

    Args:
        y: Outputs, (samples, d + 2, outputs).
        values: Of the parameters, (samples, d + 2, d).
    """
    y, values = y[:, :2].reshape(-1, y.shape[2]), values[:, :2].reshape(-1, values.shape[2])
    bins = int(np.clip(len(y) // PER_BIN, 2, MOST_BINS))
    parts = [np.array_split(np.argsort(column, kind="stable"), bins) for column in values.T]
    at = np.array([[values[part, i].mean() for part in each] for i, each in enumerate(parts)])
    mean = np.array([[y[part].mean(axis=0) for part in each] for each in parts])
    spread = np.array([[np.quantile(y[part], SPREAD, axis=0) for part in each] for each in parts])
    return MainEffects(at, np.moveaxis(mean, 2, 0), *np.moveaxis(spread, (2, 3), (0, 1)))
