"""Energy (2.7) without dilatancy, which nothing may add to: dam breaks between walls, followed step by step."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np

from warpgran.arrays import Array
from warpgran.case.case import Case
from warpgran.figures.style import TIME_LABEL
from warpgran.run.simulate import simulate_quietly
from warpgran.verification.check import CheckOptions, CheckResult, Row, paragraphs
from warpgran.verification.grids import PHI, centres, coulomb, starting_from
from warpgran.verification.plots import COLOURS, panels

CELLS = 200
END, EVERY = 0.5, 5e-4
"""End, and interval of the samples, s: shorter than any step would be, so that each step is sampled."""
DEPTHS = (0.1, (0.0, 0.02, 0.05))
"""Of the layers to the left and to the right of the dam, m."""
ANGLES = (0.0, 22.0)
JUMPS = (PHI, 0.5)
"""Volume fraction to the right of the dam; to the left it is PHI."""
FRICTIONS = (0.0, 0.3)
MOST = {0.0: {1: (1e-13, 1e-13), 2: (1e-4, 1e-3)}, 0.3: {1: (1e-6, 1e-5), 2: (1e-6, 1e-5)}}
"""Largest gain in a step and sum of gains, over the first energy, by friction and order."""
SINGLE = 1e-5
"""What rounding adds to these in float32."""


def dam(order: int, mu: float, depth: float, angle: float, phi: float) -> Case:
    """A dam break over a plane between walls, sampled at every step."""
    x = centres(-0.5, 0.5, CELLS)
    left = x < 0.0
    changes: dict[str, Any] = {
        **coulomb(mu),
        "slope.angle": angle,
        "scheme.left": "wall",
        "scheme.right": "wall",
        "time.end": END,
        "time.snapshots": [END],
        "time.series": {"every": EVERY},
    } | ({"scheme.xi": [0.0, 0.0, 0.0]} if order == 1 else {})
    return starting_from(order, np.where(left, DEPTHS[0], depth), 0.0, np.where(left, PHI, phi), -0.5, 0.5, **changes)


def gains(energy: Array) -> tuple[float, float, float]:
    """Largest gain from sample to sample, sum of all gains, and change from first to last, of the largest first energy.

    energy: shape (runs, samples).
    """
    rises = np.maximum(np.diff(energy, axis=1), 0.0) / np.abs(energy[:, :1])
    last = (energy[:, -1] - energy[:, 0]) / np.abs(energy[:, 0])
    return float(rises.max()), float(rises.sum(axis=1).max()), float(last.max())


def energy(options: CheckOptions) -> CheckResult:
    """What dam breaks gain of energy in a step, in sum, and from their start to their end."""
    rows = []
    figure, (ax,) = panels(1)
    slack = SINGLE if options.precision == "float32" else 0.0
    for n, mu in enumerate(FRICTIONS):
        cases = [dam(options.order, mu, *drawn) for drawn in product(DEPTHS[1], ANGLES, JUMPS)]
        data = simulate_quietly(cases, device=options.device, precision=options.precision)
        found = data["energy"].values
        most = (*(bound + slack for bound in MOST[mu][options.order]), slack)
        what = ("largest gain in a step", "sum of all gains", "last energy less the first")
        for words, value, bound in zip(what, gains(found), most, strict=True):
            compared = f"energy, mu = {mu:g}: {words}, of the first"
            rows.append(Row(compared, value, "-", f"<= {bound:g}", value <= bound))
        t = data["series_time"].values
        lines = ax.plot(t, ((found - found[:, :1]) / np.abs(found[:, :1])).T, color=COLOURS[n], linewidth=0.8)
        lines[0].set_label(f"mu = {mu:g}")
    ax.set(xlabel=TIME_LABEL, ylabel="change of energy, of the first (-)")
    ax.legend()
    figure.set_label("Energy of the dam breaks, without friction and with it.")
    runs = len(FRICTIONS) * len(DEPTHS[1]) * len(ANGLES) * len(JUMPS)
    text = paragraphs(f"""
        Without dilatancy (tan psi = 0) the model can only lose energy (2.7): at jumps, and to friction. {runs} dam
        breaks between walls, {DEPTHS[0]:g} m over 0, 2 and 5 cm, on the flat and on 22 degrees, with and without a
        jump of phi and friction, are sampled at every step. The paper proves the inequality for order 1 in continuous
        time (Theorem B.1, v): without friction no step gains. With friction, which is implicit in time, a step may
        gain some hundred-millionths, where a layer comes to rest. Order 2 has no such proof: without friction its
        first steps, at the jump, may add some millionths each. None may end above its start.
        """)
    return CheckResult("Energy of dam breaks", text, tuple(rows), {"energy": figure})
