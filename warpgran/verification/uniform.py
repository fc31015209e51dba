"""Uniform layers, where nothing varies along the slope: the dilatancy alone, and the steady flow."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from warpgran.arrays import Array
from warpgran.case.case import Case
from warpgran.figures.style import TIME_LABEL
from warpgran.physics.first_order import friction
from warpgran.physics.laws import phi_equilibrium, shear
from warpgran.physics.state import Fields
from warpgran.verification import exact
from warpgran.verification.check import CheckOptions, CheckResult, Row, paragraphs
from warpgran.verification.grids import SMOOTH, G, computed, falling, starting_from
from warpgran.verification.plots import COLOURS, LABELS, MARKS, errors, panels

LENGTH = 0.4
"""Length of the layers, m, whose ends are joined."""


def layer(order: int, cells: int, h: float, v: float, phi: float, times: Sequence[float], **changes: Any) -> Case:
    """A uniform layer without ends."""
    joined = {"scheme.left": "periodic", "scheme.right": "periodic"}
    seen = {"time.end": float(times[-1]), "time.snapshots": [float(t) for t in times]}
    return starting_from(order, np.full(cells, h), v, phi, 0.0, LENGTH, **joined, **seen, **changes)


FORMS: dict[int, dict[str, dict[str, Any]]] = {
    1: {"rational form": {"scheme.relaxation": "rational"}, "exponential form": {"scheme.relaxation": "exponential"}},
    2: {"midpoint": {}},
}
"""Forms of the relaxation, by the order of the scheme."""


def relaxation(options: CheckOptions) -> CheckResult:
    """Dilatancy alone: a loose layer that slides without friction."""
    mass, v, phi_0 = 0.02, 1.0, 0.45
    times = np.linspace(0.0, 0.05, 6)
    r = Case().rheology

    def phi(t: Array) -> Array:
        return exact.dilatancy(t, phi_0, mass, v, r.K, r.K_tilde, r.phi_stat, r.grain_diameter, G)

    figure, (curves, orders) = panels(2)
    fine = np.linspace(0.0, times[-1], 101)
    curves.plot(1e3 * fine, phi(fine), color="0.72", linewidth=2.6, label="exact")
    curves.axhline(phi(np.array([np.inf]))[0], color="0.5", linewidth=0.7, linestyle="--")
    rows, drift = [], 0.0
    for n, (form, changes) in enumerate(FORMS[options.order].items()):
        found = []
        for cells in options.cells(32):
            case = layer(options.order, cells, mass / phi_0, v, phi_0, times.tolist(), **changes)
            one = computed(case.with_(**{"rheology.mu1": 0.0, "rheology.mu2": 0.0}), options)
            found.append((cells, float(np.abs(one.phi - phi(times)[:, None]).max())))
            drift = max(drift, float(np.abs(one.v / v - 1.0).max()))
            if len(found) == 1:
                style, label = MARKS[n], f"{form}, {cells} cells"
                curves.plot(1e3 * times, one.phi[:, 0], style, color=COLOURS[n], markersize=4, label=label)
        rows.append(
            falling(f"{form}, phi, largest error up to {times[-1]:g} s", "-", found, SMOOTH[options.order], 0.01)
        )
    still = 1e-12 if options.precision == "float64" else 1e-4
    rows.append(Row("v, which must stay as it is: relative change", drift, "-", f"<= {still:g}", drift <= still))
    curves.set(xlabel="time $t$ (ms)", ylabel=LABELS["phi"])
    curves.legend(loc="lower right")
    errors(orders, rows)
    figure.set_label(
        "(a) Volume fraction of the loose layer; dashed, the equilibrium. (b) Largest error over the instants of (a)."
    )
    text = paragraphs(f"""
        A uniform layer of phi h = {100 * mass:g} cm and phi = {phi_0:g}, below the equilibrium, slides at {v:g} m/s
        on a horizontal bed with mu1 = mu2 = 0. Its friction max(0, tan(psi)) is 0, since it contracts, so that v
        stays as it is, and the whole scheme comes down to the dilatancy law phi' = -phi gamma K (phi - phi_eq(I)). At
        a given mass and velocity that is solved in closed form (warpgran.verification.exact.dilatancy).

        Order 1: the step (3.17), and (3.18) too, takes gamma, I and phi_eq from its beginning: first order in dt,
        hence in dx by the CFL condition; 0.9 is asked. Order 2 takes the midpoint rule: 1.9 is asked. The coarse
        grids take only about ten steps in the time in which phi gets there.
        """)
    return CheckResult("Dilatancy of a layer of constant velocity", text, tuple(rows), {"relaxation": figure})


STARTS = {"loose from rest": (0.0, 0.55), "dense and slow": (0.5, 0.60), "fast": (2.0, 0.58)}
"""Velocity over the steady one, and volume fraction."""
EARLY, LATE = 0.4, 30.0
"""Until when the way to the steady state is compared, and when it must have been reached, s."""


def steady(options: CheckOptions) -> CheckResult:
    """The uniform layer that flows steadily between the angles of mu1 and mu2."""
    angle, thickness = 28.0, 0.02
    r = Case().rheology
    goal = exact.uniform_flow(
        thickness, float(np.radians(angle)), r.mu1, r.mu2, r.I0, r.grain_diameter, r.K_tilde, r.phi_stat, G
    )
    mass = goal.phi * goal.h
    times = np.array([0.0, 0.1, 0.2, 0.3, EARLY, *np.linspace(0.6, 4.0, 18), LATE])
    early = (times > 0.0) & (times <= EARLY)
    fine = np.unique([*times[early], *np.linspace(0.0, times[-2], 401)])
    near = 1e-10 if options.precision == "float64" else 1e-3
    figure, (speed, fraction, orders) = panels(3)
    rows = []
    for n, (words, (share, phi_0)) in enumerate(STARTS.items()):
        found: list[tuple[int, float]] = []
        path = np.empty((2, 0))
        for cells in options.cells(16):
            case = layer(
                options.order, cells, mass / phi_0, share * goal.v, phi_0, times.tolist(), **{"slope.angle": angle}
            )
            one = computed(case, options)
            if not found:
                path = _in_time(case, fine, mass, share * goal.v, phi_0)
                for ax, exact_values, values in ((speed, path[0], one.v), (fraction, path[1], one.phi)):
                    ax.plot(fine, exact_values, color="0.72", linewidth=2.6, label="exact" if n == 0 else None)
                    ax.plot(times[:-1], values[:-1, 0], MARKS[n], color=COLOURS[n], markersize=2.5, label=words)
            there = path[0, np.isin(fine, times[early])]
            found.append((cells, float(np.abs(one.v[early] - there[:, None]).max() / goal.v)))
        rows.append(
            falling(f"{words}, v up to {EARLY:g} s, relative to the steady v", "-", found, SMOOTH[options.order], 0.01)
        )
        off = max(
            float(np.abs(a[-1] / b - 1.0).max()) for a, b in ((one.h, goal.h), (one.v, goal.v), (one.phi, goal.phi))
        )
        reached = f"{words}, h, v and phi at {LATE:g} s, relative to the steady ones"
        rows.append(Row(reached, off, "-", f"<= {near:g}", off <= near))
    for ax, value, name in ((speed, goal.v, "v"), (fraction, goal.phi, "phi")):
        ax.axhline(value, color="0.5", linewidth=0.7, linestyle="--")
        ax.set(xlabel=TIME_LABEL, ylabel=LABELS[name])
    speed.legend(fontsize=6.5)
    errors(orders, rows)
    figure.set_label(
        f"(a), (b) Three layers on their way to the steady flow (dashed) at {angle:g} degrees, the coarsest grid on "
        "the exact curves. (c) Errors on the way."
    )
    text = paragraphs(f"""
        On a slope of {angle:g} degrees, between atan(mu1) and atan(mu2), a uniform layer flows steadily at the
        inertial number I = I0 (tan(theta) - mu1)/(mu2 - tan(theta)), phi = phi_eq(I) and v = 2/5 (I h/d) sqrt(phi g_c
        h): here v = {goal.v:.4f} m/s and phi = {goal.phi:.4f} for h = {100 * goal.h:g} cm. All of the model's laws
        take part: mu(I), phi_eq(I), the dilatancy law and its friction. Rheology and scheme are the defaults; the
        ends are joined.

        Three layers of the same mass start elsewhere: loose and at rest, denser and slower, faster. All must come to
        the steady flow to rounding (1e-10; 1e-3 in float32, which loses what changes by less than its last place in a
        step), for it is a steady state of the scheme too. On the way they are compared with the solution of the two
        ordinary differential equations for v and phi (DOP853 of scipy to 1e-12, with the laws of the NumPy
        reference): 0.9 is asked of order 1, 1.9 of order 2. The dense layer is pushed because at rest it would stay
        there: its friction mu1 + K (phi - phi_stat) is above tan(theta).
        """)
    return CheckResult("Steady uniform flow", text, tuple(rows), {"steady": figure})


def _in_time(case: Case, times: Array, mass: float, v_0: float, phi_0: float) -> Array:
    """v [m/s] and phi of a uniform layer that slides downhill, at times [s]: shape (2, times); to 1e-11."""
    slope = np.tan(np.radians(case.slope.angle))

    def rates(t: float, y: Array) -> tuple[float, float]:
        v, phi = y[:1], y[1:]
        h = mass / phi
        gamma, I = shear(h, v, phi, case)
        tan_psi = case.rheology.K * (phi - phi_equilibrium(I, case))
        mu = friction(Fields(h, v, phi), case)
        return float((case.g_c * (slope - mu))[0]), float((-phi * gamma * tan_psi)[0])

    span = (float(times[0]), float(times[-1]))
    return np.asarray(solve_ivp(rates, span, (v_0, phi_0), "DOP853", times, rtol=1e-12, atol=1e-13).y)
