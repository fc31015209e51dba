"""A parabolic cap that slides down a slope and stays one."""

from __future__ import annotations

import numpy as np

from warpgran.case.case import Case
from warpgran.verification import exact
from warpgran.verification.check import CheckOptions, CheckResult, paragraphs
from warpgran.verification.grids import (
    PHI,
    Computed,
    G,
    centres,
    compare,
    coulomb,
    falling,
    of_constant_phi,
    starting_from,
)
from warpgran.verification.plots import against_exact

H_0, LENGTH = 0.06, 0.5
"""Thickness at the middle and half of the length of the cap, m."""
LEAST = {1: 0.9, 2: 1.5}
"""Order asked for, by the order of the scheme: its two ends are kinks."""


def cap(options: CheckOptions) -> CheckResult:
    """The cap of Savage and Hutter."""
    theta, delta, left, right, times = np.radians(35.0), np.radians(20.0), -1.0, 3.0, (0.2, 0.8)
    g_c, m = float(G * np.cos(theta)), exact.acceleration(theta, delta, G)

    def start(cells: int) -> Case:
        h = exact.cap(centres(left, right, cells), 0.0, H_0, LENGTH, m, g_c).h
        return starting_from(
            options.order, h, 0.0, PHI, left, right, **{"slope.angle": 35.0}, **coulomb(float(np.tan(delta)))
        )

    found = compare(options, start, of_constant_phi(lambda x, t: exact.cap(x, t, H_0, LENGTH, m, g_c)), times, 200)
    rows = [found.row(name, at, LEAST[options.order], 0.05) for name in ("h", "h v") for at in range(2)]
    lag = [(grid.x.size, _lag(grid, m, times)) for grid in found.grids]
    rows.append(
        falling(f"missing momentum, at t = {times[1]:g} s, of mass times m t", "-", lag, LEAST[options.order], 0.05)
    )
    text = paragraphs("""
        Slope of 35 degrees, friction angle of 20 degrees: the cap h = h_0 (1 - (x/L)^2), h_0 = 6 cm, L = 0.5 m,
        slides from rest and spreads, and stays a parabola (Savage and Hutter, 1989, with an earth-pressure
        coefficient of 1): h = h_0/G (1 - s^2), s = (x - m t^2/2)/(L G), v = m t + s L G', G'' = 2 g_c h_0/(L^2 G^2).
        All of it moves downhill, since m = g_c (tan(theta) - tan(delta)) is larger than 2 g_c h_0/L. The solution is
        smooth but for the kinks of h at its two ends: order 1 is expected, 0.9 asked; of order 2, which the kinks
        cost some of it, 1.5.

        What makes up most of the error of order 1 is that gravity less friction acts too weakly on thin layers. Both
        enter by the hydrostatic reconstruction, which gives a cell g_c phi (h^2 - (h - z)^2)/2 = g_c phi z (h - z/2)
        for a step z = dx (tan(theta) - tan(delta)), and g_c phi h^2/2 where z > h, instead of g_c phi z h: short by
        z/(2 h), first order in dx, but large where a cell is long against its layer's thickness (Delestre, Cordier,
        Darboux and James, 2012, for hydrostatic reconstruction at large). The last row measures it: without it the
        momentum of the whole would be mass times m t to rounding. Order 2 has the force within a cell beside that at
        its faces, and does not lack it.
        """)
    caption = f"The cap after {times[0]:g} s and {times[1]:g} s on a slope of 35 degrees."
    figure = against_exact(found, rows, ("h", "v"), caption)
    return CheckResult("Parabolic cap on a slope (Savage and Hutter)", text, tuple(rows), {"cap": figure})


def _lag(grid: Computed, m: float, times: tuple[float, float]) -> float:
    """Share of the momentum of the whole cap that is missing at the last time."""
    return abs(1.0 - float((grid.h[1] * grid.v[1]).sum() / (grid.h[1].sum() * m * times[1])))
