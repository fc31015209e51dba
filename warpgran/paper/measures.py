"""What the claims measure, in SI units, on one run of a result or one snapshot of it.

The mass is where the compacted thickness h_c = phi h/phi_stat > h_front (1 mm), as for the front and the volume of the
series; it moves where it is faster than 1 mm/s; the front zone is its last 5 cm, the rear its first 10 cm. What is
measured of the thickness as such is of h.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from warpgran.analysis.fields import derive, number
from warpgran.analysis.front import compacted, front, thick
from warpgran.arrays import Array
from warpgran.paper.results import NotComputedError

FRONT_ZONE = 0.05  # m
REAR = 0.10  # m
REST_SPEED = 1e-3  # m s-1
GRAIN_TENTH = 7e-5  # m, a tenth of a grain


def mass(shot: xr.Dataset, thicker: float | None = None) -> Array:
    """Cells thicker than h_front, or than so much [m], compacted."""
    return np.asarray(thick(shot) if thicker is None else compacted(shot) > thicker)


def front_of(shot: xr.Dataset, level: float = 1e-3) -> float:
    """The largest x where the compacted thickness falls through a level [m]."""
    return front(shot["x"].values, compacted(shot).values, level)


def extent(shot: xr.Dataset, level: float = 1e-3) -> float:
    """Distance from the back wall to the front [m]."""
    return front_of(shot, level) - number(shot, "grid.left")


def moving(shot: xr.Dataset) -> Array:
    """Cells of the mass that move."""
    return mass(shot) & (abs(shot["v"].values) > REST_SPEED)


def front_zone(shot: xr.Dataset, length: float = FRONT_ZONE) -> Array:
    """Cells of the mass no farther than so much behind the front."""
    return mass(shot) & (shot["x"].values > front_of(shot) - length)


def rear(shot: xr.Dataset) -> Array:
    """Cells of the mass next to the back wall."""
    x = shot["x"].values
    return mass(shot) & (x < x[0] + REAR)


def over(shot: xr.Dataset, name: str, where: Array) -> Array:
    """A field of the result, or derived from it, over some cells.

    Raises:
        NotComputedError: There are none.
    """
    if not where.any():
        raise NotComputedError("there is no such part of the mass")
    return field(shot, name)[where]


def mean(shot: xr.Dataset, name: str, where: Array) -> float:
    """Mean of a field of the result, or derived from it, over some cells.

    Raises:
        NotComputedError: There are none.
    """
    return float(over(shot, name, where).mean())


def field(shot: xr.Dataset, name: str) -> Array:
    """A field of the result, or derived from it: psi in degrees."""
    return np.asarray((shot if name in shot else derive(shot, name))[name].values)


def solid_share(shot: xr.Dataset, of: Array, among: Array) -> float:
    """Part of the solid of some cells that is in others."""
    solid = shot["phi"].values * shot["h"].values
    return float(solid[of & among].sum() / solid[among].sum()) if solid[among].sum() > 0 else float("nan")


def rise(shot: xr.Dataset, length: float = 0.1) -> float:
    """How much the thickness rises toward the front within the last 10 cm, all rises together [m].

    A profile that falls to the front has none; an oscillation has the sum of its amplitudes. The film whose solid is
    thinner than a tenth of a grain is left out.
    """
    h, x = shot["h"].values, shot["x"].values
    zone = mass(shot, GRAIN_TENTH) & (x > front_of(shot, GRAIN_TENTH) - length)
    return float(np.clip(np.diff(h[zone]), 0.0, None).sum())


def same_cells(a: xr.Dataset, b: xr.Dataset, name: str) -> tuple[Array, Array]:
    """A field of two runs on one grid, where either is part of the mass.

    Raises:
        NotComputedError: Neither has any.
    """
    either = mass(a) | mass(b)
    return over(a, name, either), over(b, name, either)


def slow_regime(t: Array, speed: Array) -> float:
    """How nearly steady the front gets after its deceleration.

    Returns:
        The least mean deceleration over 0.1 s while the front is slower than 0.5 m/s and faster than 0.1 m/s, over the
        mean deceleration from its greatest speed down to 0.5 m/s. 0 and below: it stops decelerating; 1: it
        decelerates on as before. NaN where it is never so long in that range.
    """
    top = int(np.nanargmax(speed))
    slow = np.flatnonzero((speed < 0.5) & (np.arange(t.size) > top))
    if slow.size == 0:
        return float("nan")
    entry = int(slow[0])
    before = (speed[top] - speed[entry]) / (t[entry] - t[top])
    span = round(0.1 / float(np.median(np.diff(t))))
    starts = [n for n in range(entry, t.size - span) if speed[n : n + span + 1].min() > 0.1]
    rates = [(speed[n] - speed[n + span]) / (t[n + span] - t[n]) for n in starts]
    return float(min(rates) / before) if rates else float("nan")
