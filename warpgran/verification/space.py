"""The space of runs over which properties are checked: what validation accepts, cut to finite ranges.

A point of it is a vector of numbers in [0, 1), one an axis, so that quasi-random points and hypothesis both draw from
this one description. Lengths are drawn as ratios, so that a run of any size is a short one.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpgran.case.between_keys import MOST_RELAXATION
from warpgran.case.case import Case
from warpgran.solve.variant import SINGLE_ALPHA
from warpgran.verification.check import scheme


@dataclass(frozen=True)
class Axis:
    """One direction of the space.

    Attributes:
        name: The key of the run file, or words for a number that several keys are made of.
        low, high: Ends of the range.
        log: Whether equal parts of the logarithm are equally likely.
        choices: Equally likely values, instead of a range.
    """

    name: str
    low: float = 0.0
    high: float = 0.0
    log: bool = False
    choices: tuple[Any, ...] = ()

    def at(self, u: float) -> Any:
        """The value at u in [0, 1)."""
        if self.choices:
            return self.choices[int(u * len(self.choices))]
        if self.log:
            return self.low * (self.high / self.low) ** u
        return self.low + u * (self.high - self.low)


AXES = (
    Axis("rheology.mu1", 0.0, 1.2),
    Axis("mu2 - mu1", 0.0, 1.0),
    Axis("rheology.I0", 1e-3, 10.0, log=True),
    Axis("rheology.grain_diameter", 1e-6, 1.0, log=True),
    Axis("rheology.K", 0.0, 100.0),
    Axis("part of K", 1e-4, 1.0, log=True),
    Axis("incompressible", choices=(True, False, False, False, False)),
    Axis("rheology.K_tilde", 1e-3, 10.0, log=True),
    Axis("rheology.phi_stat", 0.05, 0.85),
    Axis("rheology.phi_eq", choices=("f0", "f1", "f2", "f2 with N = 1")),
    Axis("rheology.phi_eq_N", 0.2, 20.0, log=True),
    Axis("rheology.mu_wall", 0.0, 1.0),
    Axis("rheology.channel_width", 0.01, 10.0, log=True),
    Axis("slope.angle", -80.0, 80.0),
    Axis("slope.gravity", 1.0, 30.0, log=True),
    Axis("height over scale", 1.0, 10.0, log=True),
    Axis("height over length", 0.05, 20.0, log=True),
    Axis("grid over column", 1.0, 5.0),
    Axis("place of the column", 0.0, 1.0),
    Axis("column.phi", 0.05, 0.85),
    Axis("grid.cells", 10.0, 300.0, log=True),
    Axis("scheme.alpha", choices=(2.0, 2.0, 1.2, 1.5, 3.0, 10.0)),
    Axis("scheme.lambda", choices=(0.0, 0.0, 0.5, 1.0)),
    Axis("scheme.cfl", 0.05, 0.5),
    Axis("scheme.relaxation", choices=("rational", "exponential")),
    Axis("xi1", 0.0, 10.0),
    Axis("xi2/xi1", 0.0, 1.0),
    Axis("xi3", 0.0, 10.0),
    Axis("h_min/d", 1e-3, 10.0, log=True),
    Axis("h_bed/height", choices=(0.0, 0.0, 1e-6, 1e-3, 0.3)),
    Axis("ends", choices=(("wall", "wall"), ("wall", "open"), ("open", "wall"), ("open", "open"), ("periodic",) * 2)),
)
"""The paper's viscosity is not among the choices: phi passes 1 under it, which ends a run as diverged.
So may phi above 0.85, since the transport lets it pass its initial maximum by up to a tenth on steep slopes."""

SCALES = (1e-3, 1e-2, 1e-1, 1.0, 10.0)
"""Lowest column height of a batch, m; the highest is ten times that. A batch has one end, so one scale."""

STEP_LIMIT = 20_000


def case_at(point: Sequence[float] | np.ndarray, scale: float, order: int, precision: str = "float64") -> Case:
    """The case at a point.

    Args:
        point: A number in [0, 1) for each of AXES.
        scale: One of SCALES, m; the run lasts as long as a grain takes to fall 1.5 times that.
        order: Of the scheme. Axes of stabilization and relaxation have no part in order 2.
        precision: Precision of the run, which limits alpha.
    """
    v = {axis.name: axis.at(u) for axis, u in zip(AXES, point, strict=True)}
    changes = {name: value for name, value in v.items() if "." in name}
    if v["rheology.phi_eq"] == "f2 with N = 1":
        changes |= {"rheology.phi_eq": "f2", "rheology.phi_eq_N": 1.0}
    height = scale * v["height over scale"]
    length = height / v["height over length"]
    right = length * v["grid over column"]
    cells = round(v["grid.cells"])
    h_min = v["h_min/d"] * v["rheology.grain_diameter"]
    K = 0.0 if v["incompressible"] else v["rheology.K"] * v["part of K"]
    if order == 1 and v["scheme.relaxation"] == "exponential":  # as far as it is accepted
        most = 0.99 * MOST_RELAXATION[v["rheology.phi_eq"][:2]]
        K = min(K, most * h_min * cells / (2.5 * v["scheme.cfl"] * right))
    if precision == "float32":
        changes["scheme.alpha"] = min(changes["scheme.alpha"], SINGLE_ALPHA)
    end = math.sqrt(3.0 * scale / 9.81)
    changes |= {
        "rheology.mu2": v["rheology.mu1"] + v["mu2 - mu1"],
        "rheology.K": K,
        "column.height": height,
        "column.length": length,
        "column.start": (right - length) * v["place of the column"],
        "grid.left": 0.0,
        "grid.right": right,
        "grid.cells": cells,
        **scheme(order),
        "scheme.xi": [v["xi1"], v["xi1"] * v["xi2/xi1"], v["xi3"]],
        "scheme.h_min": h_min,
        "scheme.h_bed": v["h_bed/height"] * height,
        "scheme.h_front": 0.01 * height,
        "scheme.left": v["ends"][0],
        "scheme.right": v["ends"][1],
        "time.end": end,
        "time.snapshots": [end],
        "time.series": {"every": end / 8.0},
        "time.step_limit": STEP_LIMIT,
    }
    if order == 2:
        for key in ("scheme.lambda", "scheme.relaxation", "scheme.xi"):
            del changes[key]
    return Case().with_(**changes)
