"""The runs that a `[sensitivity]` section asks for: Saltelli's design, or Morris's.

Runs of one base sample, or of one trajectory, follow each other, so that what was computed of an interrupted study is
whole samples, and the first 2^k samples are a design themselves.
"""

from __future__ import annotations

from array import array
from collections.abc import Sequence
from typing import Any

import numpy as np

from warpgran.arrays import Array
from warpgran.case.sensitivity_section import Sensitivity
from warpgran.case.sweep_section import KINDS

HALF_BIT = 2.0**-31
"""Half of the distance of Sobol points in an axis: the points stay off 0 and 1, where a normal value is infinite."""
JUMP = 0.5
"""Step of Morris's design, in probability: it leads from every place in [0, 1) to another, up or down."""


def design_values(section: Sensitivity) -> dict[str, Sequence[Any]]:
    """Values of every key by run; keys of whole numbers take the nearest one."""
    points = (saltelli if section.method == "sobol" else trajectories)(section.size, len(section.over), section.seed)
    columns: dict[str, Sequence[Any]] = {}
    for (key, distribution), u in zip(section.over.items(), points.reshape(-1, len(section.over)).T, strict=True):
        values = distribution.ppf(u)
        columns[key] = [round(value) for value in values.tolist()] if KINDS[key] is int else array("d", values)
    return columns


def saltelli(n: int, d: int, seed: int) -> Array:
    """Points of Saltelli's design (Saltelli et al., Comput. Phys. Commun. 181, 259, 2010).

    Args:
        n: Base samples, a power of 2.
        d: Parameters.
        seed: Of the scrambled Sobol points in 2 d dimensions, whose halves are A and B.

    Returns:
        Points in (0, 1), shape (n, d + 2, d): A, B, then A with each one of the parameters taken from B.
    """
    from scipy.stats import qmc

    both = qmc.Sobol(2 * d, seed=np.random.default_rng(seed)).random(n) + HALF_BIT
    A, B = both[:, :d], both[:, d:]
    points = np.repeat(A[:, None, :], d + 2, axis=1)
    points[:, 1] = B
    i = np.arange(d)
    points[:, 2 + i, i] = B
    return points


def trajectories(r: int, d: int, seed: int) -> Array:
    """Points of Morris's design (Morris, Technometrics 33, 161, 1991), one parameter changed at a time.

    Each trajectory starts at a point of a Latin hypercube, where Morris draws a level of a grid, so that all effects
    together cover every parameter evenly. Each parameter then jumps by half of its probability, in random order.

    Args:
        r: Trajectories.
        d: Parameters.
        seed: Of starts and orders.

    Returns:
        Points in (0, 1), shape (r, d + 1, d).
    """
    from scipy.stats import qmc

    rng = np.random.default_rng(seed)
    points = np.repeat(qmc.LatinHypercube(d, seed=rng).random(r)[:, None, :], d + 1, axis=1)
    rank = np.argsort(rng.random((r, d)), axis=1)
    jumped = np.arange(d + 1)[None, :, None] > rank[:, None, :]
    return np.where(jumped, np.where(points < JUMP, points + JUMP, points - JUMP), points)
