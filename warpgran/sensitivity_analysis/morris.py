"""Elementary effects of Morris's design: how strong a parameter is, and how much that depends on the others.

An effect is the change of an output when one parameter jumps by half of its probability, per whole probability: for a
linear output of a uniform parameter, the change over the whole range (Morris, Technometrics 33, 161, 1991). mu* is the
mean of its amounts (Campolongo et al., Environ. Model. Softw. 22, 1509, 2007).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from warpgran.arrays import Array
from warpgran.case.sensitivity_design import JUMP
from warpgran.errors import ResultError
from warpgran.sensitivity_analysis.sobol import Estimate, bootstrap


class MorrisEffects(NamedTuple):
    """Statistics of the effects over the trajectories, each (outputs, parameters), in the units of the output."""

    mu_star: Estimate
    mu: Array
    sigma: Array


def morris(y: Array, values: Array, seed: int) -> MorrisEffects:
    """Statistics of the elementary effects of many outputs.

    Args:
        y: Outputs of the runs, shape (trajectories, d + 1, outputs).
        values: Of the parameters, shape (trajectories, d + 1, d).
        seed: Of the resamples.

    Raises:
        ResultError: Two runs that follow each other do not differ in one parameter, as if it held too few values.
    """
    effect = effects(y, values)

    def statistic(index: Array, axis: int = -1) -> Array:
        del axis  # the last
        return np.stack([np.abs(effect[row]).mean(axis=0) for row in index], axis=-1)

    low, high = bootstrap(statistic, y.shape[0], seed)
    mean = np.abs(effect).mean(axis=0)
    return MorrisEffects(Estimate(mean.T, low.T, high.T), effect.mean(axis=0).T, effect.std(axis=0, ddof=1).T)


def effects(y: Array, values: Array) -> Array:
    """Elementary effects, shape (trajectories, parameters, outputs)."""
    steps = np.diff(values, axis=1)
    moved = steps != 0.0
    if not ((moved.sum(axis=1) == 1).all() and (moved.sum(axis=2) == 1).all()):
        run = int(np.argmax((moved.sum(axis=2) != 1).ravel()))
        raise ResultError(f"step {run} of the design does not change one parameter alone; do all hold many values?")
    slope = np.diff(y, axis=1) / (JUMP * np.sign(steps.sum(axis=2)))[:, :, None]
    step_of = moved.argmax(axis=1)  # of each parameter
    return np.take_along_axis(slope, step_of[:, :, None], axis=1)
