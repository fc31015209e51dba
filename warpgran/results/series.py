"""Where each series of the schema comes from: a scalar that the engines sample, or a function of those."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from warpgran.arrays import Array
from warpgran.case.case import Case
from warpgran.schema import SERIES
from warpgran.solve.finished import SCALARS


class Samples(NamedTuple):
    """What the engines sample of some runs.

    Attributes:
        cases: Of the runs.
        t: Of the samples [s], shape (samples,).
        scalars: By the names of SCALARS, each (runs, samples).
    """

    cases: Sequence[Case]
    t: Array
    scalars: dict[str, Array]


def front_speed(samples: Samples) -> Array:
    """Front speed [m/s]: second-order differences of the samples; NaN of a single one."""
    front = samples.scalars["front"]
    return np.gradient(front, samples.t, axis=1) if samples.t.size > 1 else np.full_like(front, np.nan)


def volume_change(samples: Samples) -> Array:
    """Relative change of the volume where the compacted thickness exceeds h_front [-]; NaN if it was 0 at first."""
    volume = np.array([_initial_volume(case) for case in samples.cases])[:, None]
    return samples.scalars["volume"] / volume - 1.0


def outflow(samples: Samples) -> Array:
    """Share of the solid that has left through the ends since t = 0 [-]; NaN if there was none.

    It is the balance of the mass: within the grid both schemes conserve it to rounding, and nothing flows in through an
    open end. Rounding leaves some 1e-15 of it in float64 and up to 3e-5 in float32, of either sign.
    """
    mass = np.array([_initial_mass(case) for case in samples.cases])[:, None]
    return 1.0 - samples.scalars["mass"] / mass


def _initial_mass(case: Case) -> float:
    """Volume of solid per unit width [m2] at t = 0, on the cells that the run starts on; NaN if there is none."""
    start = case.refined(case.scheme.start_levels)
    h, phi = start.initial_state()
    return float((phi * h).sum() * start.dx) or float("nan")


def _initial_volume(case: Case) -> float:
    """Volume per unit width [m2] of the cells that start with more than h_front, compacted; NaN if there are none.

    The same as the series at t = 0: of a run that starts on finer cells, from their means over its own cells.
    """
    start, a = case.refined(case.scheme.start_levels), case.scheme.alpha - 1.0
    h, phi = start.initial_state()
    U0, U2 = (each.reshape(case.grid.cells, -1).mean(axis=1) for each in (phi * h, phi**a * phi * h))
    thick = U0 / case.rheology.phi_stat > case.h_front
    return float((U0[thick] * (U0[thick] / U2[thick]) ** (1.0 / a)).sum() * case.dx) or float("nan")


DERIVED: dict[str, Callable[[Samples], Array]] = {
    "front_speed": front_speed,
    "volume_change": volume_change,
    "outflow": outflow,
}


def check_sources() -> None:
    """Make sure that every series of the schema has a source.

    Raises:
        NotImplementedError: One has none.
    """
    missing = [name for name in SERIES if name not in (*SCALARS, *DERIVED)]
    if missing:
        raise NotImplementedError(f"no engine samples the series {', '.join(missing)}, and no function computes it")


def series(samples: Samples) -> dict[str, Array]:
    """Every series of the schema by name, each (runs, samples)."""
    return {name: DERIVED[name](samples) if name in DERIVED else samples.scalars[name] for name in SERIES}
