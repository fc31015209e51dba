"""Designs whose results are a known function of the parameters, as the dataset of a study would hold them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import xarray as xr

from warpgran.arrays import Array
from warpgran.case.case import Case
from warpgran.case.read_study import sensitivity_design
from warpgran.case.study import Study
from warpgran.run.simulate import simulate
from warpgran.schema import PER_RUN, SERIES, Status

KEYS = ("rheology.K", "rheology.K_tilde", "rheology.mu_wall", "rheology.channel_width", "column.height")
"""Keys that take any value between 0.1 and 0.2."""
TIMES = (0.0, 0.5, 1.0)

Function = Callable[[Array], Array]
"""Takes points in (0, 1), shape (..., d)."""


def study_of(d: int, **section: Any) -> Study:
    """A design of d parameters, uniform between 0.1 and 0.2."""
    case = Case().with_(**{"time.end": TIMES[-1], "time.series": list(TIMES)})
    return sensitivity_design(case, {key: {"low": 0.1, "high": 0.2} for key in KEYS[:d]}, **section)


def points_of(study: Study) -> Array:
    """The runs of a study as points in (0, 1), shape (runs, d)."""
    return (np.stack([study.values(key) for key in study.keys], axis=1) - 0.1) / 0.1


def result_of(study: Study, run_out: Function, front: Function | None = None) -> xr.Dataset:
    """A result in which all runs have stopped, with a run-out, and a front at TIMES, that are functions of the points.

    All other results are 0.
    """
    x, runs = points_of(study), len(study)
    data: dict[str, Any] = {name: ("run", np.zeros(runs)) for name in PER_RUN if name not in ("status", "failure")}
    data |= {name: (("run", "series_time"), np.zeros((runs, len(TIMES)))) for name in SERIES}
    data["failure"] = "run", np.full(runs, "")
    flags = {"flag_values": [int(s) for s in Status], "flag_meanings": " ".join(s.word for s in Status)}
    data["status"] = "run", np.full(runs, int(Status.OK)), flags
    data["run_out"] = "run", run_out(x)
    data["stop_time"] = "run", np.full(runs, 0.5)
    if front:
        data["front"] = ("run", "series_time"), front(x)
    coords: dict[str, Any] = {key: ("run", study.values(key)) for key in study.keys}
    coords |= {"run": np.arange(runs), "series_time": list(TIMES)}
    facts = {"sensitivity": study.design, "precision": "float64", "case_toml": study.base.to_toml(), "title": ""}
    by_run = {"case_toml": ("run", np.full(runs, facts["case_toml"], dtype=object))}
    return xr.Dataset(data, coords | by_run, facts)


def ishigami(x: Array) -> Array:
    """The function of Ishigami and Homma (1990) with a = 7, b = 0.1 on (-pi, pi)^3."""
    a, b, c = np.moveaxis(np.pi * (2.0 * x - 1.0), -1, 0)
    return np.sin(a) + 7.0 * np.sin(b) ** 2 + 0.1 * c**4 * np.sin(a)


def ishigami_indices() -> tuple[Array, Array]:
    """Its exact first-order and total indices."""
    a, b = 7.0, 0.1
    alone = 0.5 * (1.0 + b * np.pi**4 / 5.0) ** 2, a**2 / 8.0, 0.0
    pair = b**2 * np.pi**8 * (1.0 / 18.0 - 1.0 / 50.0)  # of the first and the third
    variance = sum(alone) + pair
    return np.array(alone) / variance, np.array([alone[0] + pair, alone[1], pair]) / variance


G = np.array([0.0, 0.5, 3.0, 9.0])
"""Coefficients of Sobol's g-function, the first the most important."""


def g_function(x: Array) -> Array:
    """Sobol's g-function, the product of (|4 x - 2| + a)/(1 + a) (Saltelli and Sobol, 1995)."""
    return np.prod((np.abs(4.0 * x - 2.0) + G) / (1.0 + G), axis=-1)


def g_indices() -> tuple[Array, Array]:
    """Its exact first-order and total indices."""
    alone = 1.0 / (3.0 * (1.0 + G) ** 2)
    variance = np.prod(1.0 + alone) - 1.0
    return alone / variance, alone * np.prod(1.0 + alone) / (1.0 + alone) / variance


def computed(study: Study) -> xr.Dataset:
    """The study computed on one thread."""
    return simulate(study, threads=1)
