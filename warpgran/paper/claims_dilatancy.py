"""Claims of section 4.3.2: dilatancy angle, volume fraction, friction and volume."""

from __future__ import annotations

import numpy as np
import xarray as xr

from warpgran.paper.claim import Finding, at_angles, by_packing, claim
from warpgran.paper.measures import REST_SPEED, field, front_of, front_zone, mass, mean, moving, over, solid_share
from warpgran.paper.results import ANGLES, TWO, Results, at, collapse


@claim("4.3.2, Figs. 10c, 12c", "fig10 fig12", paper="8 degrees")
def psi_at_first(r: Results) -> Finding:
    """At first dilatancy angles are about 8 degrees at most.

    Greatest |psi| of the mass at 0.06 s, and where h_c > 5 mm, both packings, 0 and 22 degrees; holds
    if between 7 and 9 degrees.
    """
    shots = [at(collapse(r, angle, name), 0.06) for angle in (0, 22) for name in TWO]
    most, thick = (max(abs(over(shot, "psi", mass(shot, level))).max() for shot in shots) for level in (1e-3, 5e-3))
    return Finding(f"{most:.1f} degrees, {thick:.1f} where h_c > 5 mm", bool(7 < most < 9))


@claim(
    "4.3.2, Fig. 10d",
    "fig10",
    paper="16 degrees",
)
def psi_at_036(r: Results) -> Finding:
    """At 0 degrees and 0.36 s they reach 16 degrees near the front, in contraction.

    Least psi of the last 5 cm of the mass, both packings; holds if between -12 and -20 degrees. Also at 0.42 s.
    """

    def least(t: float) -> float:
        shots = [at(collapse(r, 0, name), t) for name in TWO]
        return min(float(over(shot, "psi", front_zone(shot)).min()) for shot in shots)

    return Finding(f"{least(0.36):.1f} degrees; {least(0.42):.1f} at 0.42 s", -20 < least(0.36) < -12)


@claim("4.3.2, Fig. 12c,d", "fig12")
def psi_small_at_22(r: Results) -> Finding:
    """At 22 degrees dilatancy angles in the moving mass are mostly below 1 degree.

    Part of the moving solid with |psi| < 1 degree at 0.06, 0.48 and 1.38 s, the less of dense and loose; holds if
    above one half at all of them.
    """
    share = {}
    for t in (0.06, 0.48, 1.38):
        shots = [at(collapse(r, 22, name), t) for name in TWO]
        share[t] = min(solid_share(s, abs(field(s, "psi")) < 1, moving(s)) for s in shots)
    words = ", ".join(f"{100 * value:.0f} % at {t:g} s" for t, value in share.items())
    return Finding(words, min(share.values()) > 0.5)


@claim("4.3.2, 5, Figs. 10c, 11, 13", "fig10 fig11 fig13")
def front_dilates_at_first(r: Results) -> Finding:
    """At first (0.06 s) the front dilates at all slopes in both packings.

    Mean psi over the last 5 cm; holds if positive in all.
    """
    words, holds = [], True
    for name in TWO:
        shots = {angle: at(collapse(r, angle, name), 0.06) for angle in ANGLES}
        psi = {angle: mean(shot, "psi", front_zone(shot)) for angle, shot in shots.items()}
        words.append(f"{name} {at_angles(psi, '{:+.1f}')}")
        holds &= min(psi.values()) > 0
    return Finding("; ".join(words) + " degrees", holds)


@claim("4.3.2, Fig. 10d", "fig10 fig11")
def front_contracts_late(r: Results) -> Finding:
    """At 0 degrees and 0.36 s the front contracts in both packings.

    Mean psi over the last 5 cm; holds if negative in both.
    """
    shots = {name: at(collapse(r, 0, name), 0.36) for name in TWO}
    psi = {name: mean(shot, "psi", front_zone(shot)) for name, shot in shots.items()}
    return Finding(by_packing(psi, "{:+.1f}", "degrees"), max(psi.values()) < 0)


def _contracting(shot: xr.Dataset) -> tuple[float, float]:
    """Parts of the moving solid and of the length of the moving mass with psi < 0."""
    contracts, moves = field(shot, "psi") < 0, moving(shot)
    return solid_share(shot, contracts, moves), float(contracts[moves].mean())


@claim("4.3.2, Fig. 11b", "fig11")
def contracts_at_024(r: Results) -> Finding:
    """At 0 degrees and 0.24 s almost the whole mass contracts in both packings.

    Part of the moving solid, and of the length of the moving mass, with psi < 0; holds if the first is above 80 %
    in both.
    """
    found = {name: _contracting(at(collapse(r, 0, name), 0.24)) for name in TWO}
    words = ", ".join(f"{name} {100 * a:.0f} % (length {100 * b:.0f} %)" for name, (a, b) in found.items())
    return Finding(words, min(a for a, _ in found.values()) > 0.8)


@claim("4.3.2, Fig. 13f", "fig13")
def contracts_before_rest(r: Results) -> Finding:
    """At 22 degrees almost the whole mass contracts before it stops.

    Part of the moving solid with psi < 0 at 1.38 s; holds if above 80 % in both packings.
    """
    found = {name: 100 * _contracting(at(collapse(r, 22, name), 1.38))[0] for name in TWO}
    return Finding(by_packing(found, "{:.0f}", "%"), min(found.values()) > 80)


@claim("4.3.2, Figs. 10b, 12b", "fig10 fig12")
def memory_is_lost(r: Results) -> Finding:
    """Only the rear keeps its initial volume fraction: elsewhere dense and loose become alike.

    Part of the length of the mass where their phi differ by less than 0.01, at 0.36 s (0 degrees) and 0.48 s (22
    degrees); holds if above one half, and if they still differ by more than 0.03 at the wall.
    """
    alike, wall = {}, {}
    for angle, t in ((0.0, 0.36), (22.0, 0.48)):
        dense, loose = (at(collapse(r, angle, name), t) for name in TWO)
        apart = abs(dense["phi"].values - loose["phi"].values)
        alike[angle] = 100 * float((apart < 0.01)[mass(dense) & mass(loose)].mean())
        wall[angle] = float(apart[0])
    words = f"{at_angles(alike, '{:.0f}', '%')}; at the wall {at_angles(wall, '{:.3f}')}"
    return Finding(words, min(alike.values()) > 50 and min(wall.values()) > 0.03)


def _friction_rise(shot: xr.Dataset) -> float:
    """Friction in the last 1 cm of the mass less that 10 cm behind the front."""
    x, end = shot["x"].values, front_of(shot)
    behind = mass(shot) & (abs(x - (end - 0.1)) < 0.005)
    return mean(shot, "mu", front_zone(shot, 0.01)) - mean(shot, "mu", behind)


FRICTION = "Mean mu of the last 1 cm less that 10 cm behind the front, dense and loose. "


@claim("4.3.2, Fig. 10e", "fig10", shared=FRICTION)
def friction_rises_at_first(r: Results) -> Finding:
    """At 0 degrees and 0.06 s friction rises toward the front.

    Holds if positive.
    """
    rise = {name: _friction_rise(at(collapse(r, 0, name), 0.06)) for name in TWO}
    return Finding(by_packing(rise, "{:+.2f}"), min(rise.values()) > 0)


@claim("4.3.2, 5, Fig. 10f", "fig10", shared=FRICTION)
def friction_falls_late(r: Results) -> Finding:
    """At 0 degrees and 0.36 s contraction makes friction fall to much smaller values at the front.

    Holds if negative in both. Also at 0.42 s.
    """
    rises = {t: {name: _friction_rise(at(collapse(r, 0, name), t)) for name in TWO} for t in (0.36, 0.42)}
    words = "; ".join(f"{by_packing(rise, '{:+.2f}')} at {t:g} s" for t, rise in rises.items())
    return Finding(words, max(rises[0.36].values()) < 0)


@claim("4.3.2, 5, Fig. 12e,f", "fig12", shared=FRICTION)
def friction_rises_at_22(r: Results) -> Finding:
    """At 22 degrees friction rises toward the front, for the mu(I) effect dominates.

    At 0.06, 0.48 and 1.38 s; holds if positive in all.
    """
    rise = [_friction_rise(at(collapse(r, 22, name), t)) for t in (0.06, 0.48, 1.38) for name in TWO]
    return Finding(f"{min(rise):+.2f} to {max(rise):+.2f}", min(rise) > 0)


@claim("4.3.2", "fig10 fig12")
def friction_rises_without_dilatancy(r: Results) -> Finding:
    """Without dilatancy friction always rises toward the front.

    Mean mu of the last 1 cm less that 10 cm behind the front of the incompressible mass, at all slopes and all
    snapshots where the front moves; holds if positive.
    """
    rises = []
    for angle in ANGLES:
        one = collapse(r, angle, "incompressible")
        shots = [at(one, t) for t in one["time"].values if t > 0]
        rises += [_friction_rise(shot) for shot in shots if mean(shot, "v", front_zone(shot, 0.01)) > REST_SPEED]
    least = min(rises, default=float("nan"))
    return Finding(f"least {least:+.3f}", least > 0)


@claim("4.3.2, Fig. 14", "fig14", paper="10 %")
def dilation_grows(r: Results) -> Finding:
    """In the dense packing the mean dilation of the mass grows with the slope, reaching almost 10 % at 22 degrees.

    Greatest relative change of the volume (h_c > 1 mm); holds if it grows from slope to slope and is 9 to 11 % at 22
    degrees.
    """
    most = {angle: 100 * float(collapse(r, angle, "dense")["volume_change"].max()) for angle in ANGLES}
    values = list(most.values())
    return Finding(at_angles(most, "{:.1f}", "%"), bool(np.all(np.diff(values) > 0)) and 9 <= values[-1] <= 11)


@claim("4.3.2, Fig. 14", "fig14")
def dilation_lasts(r: Results) -> Finding:
    """The dilation lasts longer on a steeper slope.

    When the volume of the dense mass is greatest; holds if later from slope to slope.
    """
    ones = {angle: collapse(r, angle, "dense") for angle in ANGLES}
    when = {a: float(one["series_time"].values[one["volume_change"].values.argmax()]) for a, one in ones.items()}
    return Finding(at_angles(when, "{:.2f}", "s"), bool(np.all(np.diff(list(when.values())) > 0)))


@claim("4.3.2, Fig. 14", "fig14")
def loose_is_compressed(r: Results) -> Finding:
    """The loose mass is compressed at all slopes.

    Relative change of the volume at the end; holds if negative.
    """
    last = {angle: 100 * float(collapse(r, angle, "loose")["volume_change"].values[-1]) for angle in ANGLES}
    return Finding(at_angles(last, "{:+.1f}", "%"), max(last.values()) < 0)


CLAIMS = (
    psi_at_first,
    psi_at_036,
    psi_small_at_22,
    front_dilates_at_first,
    front_contracts_late,
    contracts_at_024,
    contracts_before_rest,
    memory_is_lost,
    friction_rises_at_first,
    friction_falls_late,
    friction_rises_at_22,
    friction_rises_without_dilatancy,
    dilation_grows,
    dilation_lasts,
    loose_is_compressed,
)
