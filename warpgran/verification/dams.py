"""Dam breaks: without friction, and on slopes steeper and less steep than the friction angle."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from warpgran.arrays import Array
from warpgran.case.case import Case
from warpgran.verification import exact
from warpgran.verification.check import CheckOptions, CheckResult, Row, paragraphs
from warpgran.verification.grids import PHI, G, centres, compare, coulomb, falling, of_constant_phi, starting_from
from warpgran.verification.plots import against_exact

H_0 = 0.1
"""Thickness behind the dams, m."""
LEAST = {"h": {1: 0.5, 2: 0.9}, "h v": {1: 0.5, 2: 0.9}}
"""Order of accuracy asked for at jumps and fronts, by the order of the scheme."""
CRITICAL = 0.8
"""The same once the whole layer has passed the speed of its waves."""
RATE = (
    "A first-order scheme can be relied on for order 1/2 in L1 where the solution has jumps or kinks (proven for "
    "scalar equations), and is nearer to 1 the finer the grid; asked is 1/2. Of order 2, which places a jump to a cell "
    "and a front as well, 0.9 is asked."
)


def dam(order: int, h_l: float, h_r: float, left: float, right: float, **changes: Any) -> Callable[[int], Case]:
    """Cases of so many cells with a dam at x = 0, which must be the edge of a cell."""

    def start(cells: int) -> Case:
        x = centres(left, right, cells)
        return starting_from(order, np.where(x < 0.0, h_l, h_r), 0.0, PHI, left, right, **changes)

    return start


def ritter(options: CheckOptions) -> CheckResult:
    """Ritter's dam break, onto a dry bed."""
    times = (0.2, 0.6)
    start = dam(options.order, H_0, 0.0, -0.8, 1.6, **coulomb(0.0))
    found = compare(options, start, of_constant_phi(lambda x, t: exact.ritter(x, t, H_0, G)), times, 96)
    rows = tuple(found.row(name, at, LEAST[name][options.order], 0.05) for name in ("h", "h v") for at in range(2))
    text = paragraphs(f"""
        A mass of h = {100 * H_0:g} cm on the left of x = 0 is let go on a dry horizontal bed, without friction and
        dilatancy: h = (2 c_0 - x/t)^2/(9 g), v = 2/3 (c_0 + x/t) between -c_0 t and 2 c_0 t (Ritter, 1892). What is
        asked of the scheme is the dry front, where h, c and the momentum vanish together.

        {RATE}
        """)
    caption = f"Ritter's dam break after {times[0]:g} s and {times[1]:g} s."
    figure = against_exact(found, rows, ("h", "v"), caption)
    return CheckResult("Dam break on a dry bed (Ritter)", text, rows, {"ritter": figure})


def stoker(options: CheckOptions) -> CheckResult:
    """Stoker's dam break, onto a thin layer."""
    times, h_r = (0.2, 0.6), 0.02
    start = dam(options.order, H_0, h_r, -1.0, 1.0, **coulomb(0.0))
    found = compare(options, start, of_constant_phi(lambda x, t: exact.stoker(x, t, H_0, h_r, G)), times, 100)
    rows = tuple(found.row(name, at, LEAST[name][options.order], 0.05) for name in ("h", "h v") for at in range(2))
    text = paragraphs(f"""
        The same onto a layer of {100 * h_r:g} cm at rest: a rarefaction, a uniform state and a bore (Stoker, 1957).
        What is asked is the height and the speed of the bore, which conservation alone decides.

        {RATE}
        """)
    caption = f"Stoker's dam break after {times[0]:g} s and {times[1]:g} s."
    return CheckResult(
        "Dam break on a layer (Stoker)", text, rows, {"stoker": against_exact(found, rows, ("h", "v"), caption)}
    )


def sliding(options: CheckOptions) -> CheckResult:
    """Dam break with Coulomb friction on a slope steeper than the friction angle."""
    theta, delta, left, right, times = np.radians(30.0), np.radians(20.0), -2.5, 2.5, (0.2, 0.6)
    g_c, m = float(G * np.cos(theta)), exact.acceleration(theta, delta, G)
    c_0 = np.sqrt(g_c * H_0)

    def span(t: float) -> tuple[float, float]:
        return float(left + c_0 * t + 0.5 * m * t**2 + 0.3), right

    start = dam(options.order, H_0, 0.0, left, right, **{"slope.angle": 30.0}, **coulomb(float(np.tan(delta))))
    flow = of_constant_phi(lambda x, t: exact.sliding_dam(x, t, H_0, m, g_c))
    found = compare(options, start, flow, times, 125, span)
    rows = tuple(
        found.row(name, at, LEAST[name][options.order] if at == 0 else min(LEAST[name][options.order], CRITICAL), 0.05)
        for name in ("h", "h v")
        for at in range(2)
    )
    head = 0.5 * m * times[1] ** 2 - c_0 * times[1], 0.3
    rows += tuple(
        found.row(
            name, 1, LEAST[name][options.order], 0.05, f", farther than {head[1]:g} m from the head of the fan", head
        )
        for name in ("h", "h v")
    )
    text = paragraphs(f"""
        Slope of 30 degrees, friction angle of 20 degrees, constant: all slides, the mass behind the dam too, and
        Ritter's solution holds in the frame of the acceleration m = g cos(theta) (tan(theta) - tan(delta))
        (Mangeney, Heinrich and Roche, 2000): h = (2 c_0 - x/t + m t/2)^2/(9 g cos(theta)), v = 2/3 (c_0 + x/t + m t)
        between m t^2/2 - c_0 t and m t^2/2 + 2 c_0 t.

        The exact mass has no upper end. The computed one begins at x = -2.5 m, where the first cell feels no
        gravity; compared is what no wave from there has reached, x > -2.2 m + c_0 t + m t^2/2.

        At t = c_0/m = 0.5 s the whole layer behind the dam moves as fast as its waves, and those that run uphill stand
        still in the grid. The flux of order 2 has next to no dissipation then: the kink at the head of the fan leaves
        ripples of a few cells' length, 1 % of the thickness, which are damped slowly once the moment has passed. They
        fall with dx, but not as fast: the order of h is 1.0 up to 2000 cells and 0.7 to 4000. Asked at 0.6 s is 0.8,
        and {LEAST["h"][2]:g} of all that is not beside the head.

        {RATE}
        """)
    caption = f"Dam break on a slope of 30 degrees with friction of 20 degrees after {times[0]:g} s and {times[1]:g} s."
    figure = against_exact(found, rows, ("h", "v"), caption)
    return CheckResult("Dam break steeper than the friction angle", text, rows, {"sliding": figure})


VISCOSITY: dict[int, dict[str, dict[str, Any]]] = {
    1: {", xi = 0": {"scheme.xi": [0.0, 0.0, 0.0]}, ", default xi": {"scheme.xi": [2.0, 2.0, 5.0]}},
    2: {"": {}},
}
"""Of which only order 1 has any."""


def braked(options: CheckOptions) -> CheckResult:
    """Dam break with Coulomb friction on a slope less steep than the friction angle, until it rests."""
    theta, delta = np.radians(15.0), np.radians(25.0)
    g_c, m = float(G * np.cos(theta)), exact.acceleration(theta, delta, G)
    solution = exact.BrakedDam(H_0, m, g_c, steps=1200)
    reach, stop = solution.run_out, solution.stop_time
    times = (0.25 * stop, 0.6 * stop, 1.2 * stop)
    flow = of_constant_phi(solution.at)
    rows: tuple[Row, ...] = ()
    figures: dict[str, Figure] = {}
    for words, viscosity in VISCOSITY[options.order].items():
        changes = {"slope.angle": 15.0, **viscosity, **coulomb(float(np.tan(delta)))}
        found = compare(options, dam(options.order, H_0, 0.0, -0.6 * reach, 1.4 * reach, **changes), flow, times, 200)
        mine = [found.row("h", at, LEAST["h"][options.order], 0.05, words) for at in range(3)]
        mine += [found.row("h v", at, LEAST["h v"][options.order], 0.05, words) for at in range(2)]
        moving = [(g.x.size, _still_moving(g.h[2], g.v[2], g.h[0], g.v[0])) for g in found.grids]
        compared = f"remaining flow, the sum of h |v| at t = {times[2]:.3g} s over that at {times[0]:.3g} s{words}"
        mine.append(falling(compared, "-", moving, LEAST["h v"][options.order], 0.05))
        rows += tuple(mine)
        if not figures:
            caption = (
                "Dam break on a slope of 15 degrees with friction of 25 degrees while it flows and when it has stopped "
                f"({', '.join(f'{t:.3g}' for t in times)} s), without viscosity."
            )
            figures["braked"] = against_exact(found, mine[:-1], ("h", "v"), caption)
    x = np.linspace(-0.6 * reach, 1.4 * reach, 20001)
    right = [solution.at(x, t).h for t in times[:2]]
    naive, later = (
        float(np.abs(exact.sliding_dam(x, t, H_0, m, g_c).h - h).sum() / h.sum())
        for t, h in zip(times, right, strict=False)
    )
    text = paragraphs(f"""
        Slope of 15 degrees, friction angle of 25 degrees: the front follows x = 2 c_0 t - |m| t^2/2 and stops at t =
        2 c_0/|m| = {stop:.3f} s, x = 2 h_0/(tan(delta) - tan(theta)) = {reach:.3f} m. For the rest the formula of
        the steeper slope cannot be used: it would have friction push the resting mass uphill. Friction holds that
        mass, and every point of the fan learns of it by a characteristic (the problem of Faccanoni and Mangeney,
        2013). Used here all the same, the formula would be off by {100 * naive:.1f} % of the thickness in L1 at t =
        {times[0]:.3g} s and by {100 * later:.1f} % at {times[1]:.3g} s.

        The exact solution is computed by the hodograph transform, in which the equations are linear
        (exact.BrakedDam); it conserves mass to 2e-6. The mass begins to stop at its upper end, x =
        {solution.edge:.3f} m, after {solution.arrest:.3f} s, and every point keeps the thickness at which it
        stopped. On coarse grids the thin front overshoots and stops late, for the reason that the sliding cap shows.
        This asks of the scheme all that a granular collapse does: a static mass that yields, a dry front, and
        arrest.

        {RATE}
        """)
    return CheckResult("Dam break less steep than the friction angle", text, rows, figures)


def _still_moving(h: Array, v: Array, h_before: Array, v_before: Array) -> float:
    return float(np.abs(h * v).sum() / np.abs(h_before * v_before).sum())
