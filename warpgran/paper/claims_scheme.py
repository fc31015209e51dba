"""Claims of sections 2 and 3: the forms of the equilibrium volume fraction, and the numerical viscosity."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import xarray as xr

from warpgran.analysis.fields import number
from warpgran.analysis.front import front
from warpgran.paper.claim import Finding, claim
from warpgran.paper.measures import GRAIN_TENTH, front_of, mass, over, rise, same_cells
from warpgran.paper.results import NotComputedError, Results, at, collapse

INSTANT = 1.38  # s, of Fig. 2


def form(r: Results, angle: float, law: str, N: float = 1.0) -> xr.Dataset:
    """The dense column with one form of the equilibrium volume fraction."""
    return r.run("regularization", angle=angle, phi_eq=law, phi_eq_N=N)


def greatest_rise(one: xr.Dataset) -> tuple[float, float]:
    """The greatest rise of the thickness toward the front [m] over the snapshots while the mass moves, and when [s]."""
    times = [float(t) for t in one["time"].values if 0.0 < t and not t > float(one["stop_time"])]
    rises = [rise(at(one, t)) for t in times]
    n = int(np.argmax(rises))
    return rises[n], times[n]


@claim("2, Fig. 2a", "fig02")
def linear_law_negative(r: Results) -> Finding:
    """At 22 degrees and 1.38 s the linear law (2.9) gives a negative equilibrium volume fraction near the front.

    Least phi_stat - K_tilde I where h_c > 1 mm; holds if it is below 0.
    """
    one = at(form(r, 22, "f2"), INSTANT)
    stat, slope = (number(one, f"rheology.{name}") for name in ("phi_stat", "K_tilde"))
    x, values = one["x"].values[mass(one)], stat - slope * over(one, "I", mass(one))
    negative = values < 0
    behind = front_of(one) - x[negative].min() if negative.any() else 0.0
    return Finding(f"down to {values.min():.2f}, negative over the last {1e3 * behind:.0f} mm", bool(negative.any()))


def _stable(r: Results, angle: float, law: str, N: float = 1.0) -> tuple[str, bool]:
    """At 22 degrees at the instant of Fig. 2, else at the worst one."""
    one = form(r, angle, law, N)
    most, when = greatest_rise(one)
    name = f"{law}{f' N={N:g}' if law == 'f2' else ''}"
    if angle == 0:
        return f"{name}: {1e3 * most:.2f} mm, at {when:.2f} s", most < GRAIN_TENTH
    then = rise(at(one, INSTANT))
    return f"{name}: {1e3 * then:.2f} mm (at most {1e3 * most:.2f} mm, at {when:.2f} s)", then < GRAIN_TENTH


RISE = (
    "All rises of h toward the front in the last 10 cm together, at 0 degrees at the worst snapshot before rest, at 22 "
    "degrees at 1.38 s; stable: below a tenth of a grain, 0.07 mm."
)


@claim("2, Fig. 2c", "fig02", shared=RISE)
def f0_oscillates(r: Results) -> Finding:
    """At 0 degrees (f0) makes the thickness oscillate near the front."""
    words, stable = _stable(r, 0, "f0")
    return Finding(words, not stable)


@claim("2, Fig. 2c", "fig02", shared=RISE)
def f1_oscillates_a_little(r: Results) -> Finding:
    """At 0 degrees (f1) still gives small instabilities near the front."""
    words, stable = _stable(r, 0, "f1")
    return Finding(words, not stable)


@claim("2, Fig. 2c", "fig02", shared=RISE)
def f2_does_not_oscillate(r: Results) -> Finding:
    """At 0 degrees (f2) with N = 1 gives no oscillation."""
    return Finding(*_stable(r, 0, "f2"))


@claim("2, Fig. 2d", "fig02", shared=RISE)
def all_stable_at_22(r: Results) -> Finding:
    """At 22 degrees all forms give a stable thickness."""
    found = [_stable(r, 22, law, N) for law, N in (("f0", 1), ("f1", 1), ("f2", 1), ("f2", 2), ("f2", 5))]
    return Finding("; ".join(words for words, _ in found), all(stable for _, stable in found))


@claim("2, Fig. 2", "fig02")
def f2_tends_to_f1(r: Results) -> Finding:
    """(f2) with N = 5 is nearly (f1).

    Greatest difference of h over the greatest h at 22 degrees and 1.38 s; holds if below 1 %. Also the most over
    all snapshots and both slopes.
    """

    def apart(angle: float, t: float) -> float:
        a, b = (at(form(r, angle, law, 5 if law == "f2" else 1), t) for law in ("f2", "f1"))
        return _apart(a, b)

    then = apart(22, INSTANT)
    times = [float(t) for t in form(r, 0, "f1")["time"].values if t > 0]
    most = max(apart(angle, t) for angle in (0, 22) for t in times)
    return Finding(f"{100 * then:.2f} % at 1.38 s, at most {100 * most:.2f} %", then < 0.01)


def _apart(a: xr.Dataset, b: xr.Dataset) -> float:
    """Greatest difference of the thickness of two snapshots over the greatest thickness."""
    p, q = same_cells(a, b, "h")
    return float(abs(p - q).max() / q.max())


def _both(r: Results, angle: float) -> tuple[xr.Dataset, xr.Dataset]:
    """The dense mass with the viscosity and without.

    Raises:
        NotComputedError: The scheme has none.
    """
    with_ = collapse(r, angle, "dense")
    if number(with_, "scheme.order") == 2:
        raise NotComputedError("the scheme of order 2 has no viscosity")
    return with_, r.run("no_viscosity", angle=angle)


def _front_moves(r: Results, angle: float, place: Callable[[xr.Dataset], float]) -> dict[float, float]:
    """How far the viscosity moves the front, taken at this place, over the extent of the mass, by instant."""
    a, b = _both(r, angle)
    left = number(a, "grid.left")
    times = [float(t) for t in a["time"].values if t > 0]
    extents = [[place(at(one, t)) - left for one in (a, b)] for t in times]
    return {round(t, 6): abs(p - q) / q for t, (p, q) in zip(times, extents, strict=True)}


def _where_h_is(level: float) -> Callable[[xr.Dataset], float]:
    """The largest x of a snapshot where h itself falls through a level [m]."""
    return lambda shot: front(shot["x"].values, shot["h"].values, level)


@claim("3.3, Fig. 3", "fig03", paper="0.43 %")
def viscosity_at_22(r: Results) -> Finding:
    """At 22 degrees the viscosity moves the front by 0.43 % of the extent of the mass.

    Front with and without, over the distance from the back wall to the front, at 1.38 s, at 1.8 s and at
    the worst snapshot. The paper gives no instant; holds if it is below 1 % at the first two.
    """
    moves = _front_moves(r, 22, front_of)
    worst = max(moves, key=lambda t: moves[t])
    late = moves[1.38], moves[1.8]
    words = (
        f"{100 * late[0]:.2f} % at 1.38 s, {100 * late[1]:.2f} % at 1.8 s, {100 * moves[worst]:.1f} % at {worst:g} s"
    )
    return Finding(words, max(late) < 0.01)


@claim("3.3, Fig. 3", "fig03", paper="9.1 %")
def viscosity_at_0(r: Results) -> Finding:
    """At 0 degrees the viscosity moves the front by up to 9.1 % of the extent, and only where h <= 0.5 mm.

    The same at h = 0.07 mm (a tenth of a grain), 0.5 mm and 1 mm, the most over all snapshots. Holds if it is
    between half and twice 9.1 % in the film and below 1 % at 1 mm.
    """
    film, half, one = (max(_front_moves(r, 0, _where_h_is(level)).values()) for level in (GRAIN_TENTH, 5e-4, 1e-3))
    words = f"{100 * film:.1f} % at 0.07 mm, {100 * half:.1f} % at 0.5 mm, {100 * one:.1f} % at 1 mm"
    return Finding(words, 0.091 / 2 < film < 2 * 0.091 and one < 0.01)


@claim("3.3, Fig. 3", "fig03")
def viscosity_on_profiles(r: Results) -> Finding:
    """The viscosity has almost no influence on the thickness profiles at either slope.

    Greatest difference of h over the greatest h, at the worst snapshot; holds if below 1 %.
    """
    found = {}
    for angle in (0, 22):
        a, b = _both(r, angle)
        found[angle] = max(_apart(at(a, t), at(b, t)) for t in a["time"].values if t > 0)
    words = ", ".join(f"{100 * value:.1f} % at {angle} degrees" for angle, value in found.items())
    return Finding(words, max(found.values()) < 0.01)


CLAIMS = (
    linear_law_negative,
    f0_oscillates,
    f1_oscillates_a_little,
    f2_does_not_oscillate,
    all_stable_at_22,
    f2_tends_to_f1,
    viscosity_at_22,
    viscosity_at_0,
    viscosity_on_profiles,
)
