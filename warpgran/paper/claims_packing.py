"""Claims of section 4.3: what the initial packing does to the mass, its speed, its dilation and its forces."""

from __future__ import annotations

import numpy as np
import xarray as xr

from warpgran.derived import parameter
from warpgran.momentum import forces
from warpgran.paper.claim import Finding, claim
from warpgran.paper.measures import (
    GRAIN_TENTH,
    REST_SPEED,
    field,
    front_of,
    front_zone,
    mass,
    mean,
    moving,
    over,
    slow_regime,
    solid_share,
)
from warpgran.paper.results import ANGLES, PACKINGS, Results, at, collapse

THREE = tuple(PACKINGS)  # dense, loose, incompressible
TWO = ("dense", "loose")


def at_angles(values: dict[float, float], form: str = "{:.2f}", unit: str = "") -> str:
    """Values by slope, in words: `0: 4.2, 22: 10 %`."""
    return ", ".join(f"{angle:g}: {form.format(value)}" for angle, value in values.items()) + f" {unit}".rstrip()


def by_packing(values: dict[str, float], form: str = "{:.2f}", unit: str = "") -> str:
    """Values by packing, in words."""
    return ", ".join(f"{name} {form.format(value)}" for name, value in values.items()) + f" {unit}".rstrip()


# Mass profiles and velocities


@claim("4.3.1, Figs. 5, 6", "fig05 fig06")
def thickest_is_dense(r: Results) -> Finding:
    """At all instants and slopes the greatest thickness falls from the dense to the incompressible to the loose mass.

    Least of h_max(dense) - h_max(incompressible) and h_max(incompressible) - h_max(loose) over all samples (10 ms);
    until the collapse reaches the wall all three are the column's height, so it holds if neither is below minus a
    tenth of a grain, 0.07 mm.
    """
    least = {}
    for angle in ANGLES:
        dense, loose, neither = (collapse(r, angle, name)["h_max"].values for name in THREE)
        least[angle] = 1e3 * float(min((dense - neither).min(), (neither - loose).min()))
    return Finding(f"least difference {at_angles(least, '{:+.3f}', 'mm')}", min(least.values()) > -1e3 * GRAIN_TENTH)


@claim("4.3.1, Fig. 5", "fig05")
def same_front_at_0(r: Results) -> Finding:
    """At 0 degrees the three packings hardly differ near the front.

    Spread of the three deposits' fronts over the extent of the mass, at 1 mm and at 5 mm thickness; holds if both
    are below 3 %.
    """
    shots = [at(collapse(r, 0, name), 1.8) for name in THREE]
    wall = float(parameter(shots[0], "grid.left"))
    fronts = [[front_of(shot, level) for shot in shots] for level in (1e-3, 5e-3)]
    spread = [(max(f) - min(f)) / (max(f) - wall) for f in fronts]
    return Finding(f"{100 * spread[0]:.1f} % at 1 mm, {100 * spread[1]:.1f} % at 5 mm", max(spread) < 0.03)


@claim("4.3.1, Figs. 5, 6", "fig05 fig06")
def dilatant_runs_farther(r: Results) -> Finding:
    """At 10 degrees, and up to 0.48 s at 22 degrees, dense and loose masses run farther than the incompressible one.

    Least lead of their fronts (1 mm) over the incompressible one's, from 0.06 s on; holds if positive.
    """
    least = {}
    for angle, end in ((10.0, 1.8), (22.0, 0.48)):
        neither = collapse(r, angle, "incompressible")
        t = neither["series_time"].values
        when = (t > 0.055) & (t < end + 0.005)
        leads = [(collapse(r, angle, name)["front"] - neither["front"]).values[when].min() for name in TWO]
        least[angle] = 1e3 * float(min(leads))
    return Finding(at_angles(least, "{:+.1f}", "mm"), min(least.values()) > 0)


@claim("4.3.1, Fig. 6c,d", "fig06")
def incompressible_between(r: Results) -> Finding:
    """Later at 22 degrees the incompressible profile falls between the loose and the dense one.

    Part of the length of the mass where it does, at 1.38 s and 1.8 s; holds if both are above 90 %.
    """
    share = {}
    for t in (1.38, 1.8):
        dense, loose, neither = (at(collapse(r, 22, name), t) for name in THREE)
        where = mass(neither)
        h = [shot["h"].values[where] for shot in (loose, neither, dense)]
        share[t] = float(((h[0] <= h[1]) & (h[1] <= h[2])).mean())
    words = ", ".join(f"{100 * value:.0f} % at {t:g} s" for t, value in share.items())
    return Finding(words, min(share.values()) > 0.9)


@claim("4.3.1, Figs. 7a, 8a", "fig07 fig08")
def same_speed_at_first(r: Results) -> Finding:
    """At first (0.06 s) the speeds are alike with dilatancy and without.

    Greatest difference from the incompressible profile where both are thicker than 1 mm, over the greatest speed;
    holds if below 10 %.
    """
    worst = {}
    for angle in (0.0, 22.0):
        dense, loose, neither = (at(collapse(r, angle, name), 0.06) for name in THREE)
        v = neither["v"].values
        apart = [abs(s["v"].values - v)[mass(s) & mass(neither)].max() / v[mass(neither)].max() for s in (dense, loose)]
        worst[angle] = 100 * float(max(apart))
    return Finding(at_angles(worst, "{:.1f}", "%"), max(worst.values()) < 10)


@claim("4.3.1, Fig. 7b", "fig07")
def speeds_at_036(r: Results) -> Finding:
    """At 0 degrees and 0.36 s the incompressible mass is slowest near the front, between the others near the rear.

    Mean speed over 10 cm behind the shortest of the three fronts, and over the moving part from the rear to x = 0;
    holds if both.
    """
    shots = {name: at(collapse(r, 0, name), 0.36) for name in THREE}
    end = min(front_of(shot) for shot in shots.values())
    x = shots["dense"]["x"].values
    front = {name: 1e3 * mean(shot, "v", (x > end - 0.1) & (x < end)) for name, shot in shots.items()}
    behind = {name: 1e3 * mean(shot, "v", mass(shot) & (x < 0)) for name, shot in shots.items()}
    slowest = front["incompressible"] < min(front["dense"], front["loose"])
    between = min(behind["dense"], behind["loose"]) < behind["incompressible"] < max(behind["dense"], behind["loose"])
    words = f"front: {by_packing(front, '{:.0f}', 'mm/s')}; rear: {by_packing(behind, '{:.0f}', 'mm/s')}"
    return Finding(words, slowest and between)


@claim("4.3.1, Fig. 8c", "fig08")
def dense_front_faster(r: Results) -> Finding:
    """At 22 degrees and 1.38 s the rear is at rest, and the dense front zone is much faster than the loose one.

    How far from the back wall nothing is faster than 1 mm/s, and the mean speed over the last 10 cm; holds if the
    first is above 20 cm and dense is faster than loose by 25 % or more.
    """
    shots = [at(collapse(r, 22, name), 1.38) for name in TWO]
    wall = float(parameter(shots[0], "grid.left"))
    still = [float(over(shot, "x", moving(shot)).min()) - wall for shot in shots]
    speed = {name: mean(shot, "v", front_zone(shot, 0.1)) for name, shot in zip(TWO, shots, strict=True)}
    words = f"at rest over {100 * min(still):.0f} cm; {by_packing(speed, '{:.3f}', 'm/s')}"
    return Finding(words, min(still) > 0.2 and speed["dense"] > 1.25 * speed["loose"])


@claim("4.3.1, Fig. 8d", "fig08")
def incompressible_slowest_late(r: Results) -> Finding:
    """At 22 degrees and 1.8 s dense and loose masses are both faster than the incompressible one.

    Mean speed over the last 10 cm; holds if both are faster.
    """
    shots = {name: at(collapse(r, 22, name), 1.8) for name in THREE}
    speed = {name: 1e3 * mean(shot, "v", front_zone(shot, 0.1)) for name, shot in shots.items()}
    return Finding(by_packing(speed, "{:.1f}", "mm/s"), speed["incompressible"] < min(speed["dense"], speed["loose"]))


@claim("4.3.1, Fig. 9a, conclusion", "fig09")
def dense_front_ahead(r: Results) -> Finding:
    """At all slopes the front of the dense mass is always slightly ahead of that of the loose one.

    Least lead over all samples from 0.1 s on, with the front at 1 mm and at 5 mm, and the lead at the end (1 mm);
    holds if no lead is negative.
    """
    least, last, thick = {}, {}, {}
    for angle in ANGLES:
        dense, loose = (collapse(r, angle, name) for name in TWO)
        lead = 1e3 * (dense["front"] - loose["front"]).values
        late = dense["series_time"].values > 0.105
        least[angle], last[angle] = float(lead[late].min()), float(lead[-1])
        at_5 = [collapse(r, angle, name, source="fronts")["front"].values for name in TWO]
        thick[angle] = 1e3 * float((at_5[0] - at_5[1])[late].min())
    words = f"least lead {at_angles(least, '{:+.1f}', 'mm')}; at 5 mm {at_angles(thick, '{:+.1f}', 'mm')}; "
    return Finding(words + f"at 1.8 s {at_angles(last, '{:+.1f}', 'mm')}", min(*least.values(), *thick.values()) >= 0)


@claim("4.3.1, Fig. 9b", "fig09")
def same_front_speed(r: Results) -> Finding:
    """Below 22 degrees the fronts of dense and loose masses have almost the same speed.

    Mean difference over all samples until the dense one stops, over the mean speed; holds if below 5 %.
    """
    apart = {}
    for angle in ANGLES[:3]:
        dense, loose = (collapse(r, angle, name) for name in TWO)
        going = dense["series_time"].values < np.nan_to_num(float(dense["stop_time"]), nan=1.8)
        a, b = dense["front_speed"].values[going], loose["front_speed"].values[going]
        apart[angle] = 100 * float(abs(a - b).mean() / abs(b).mean())
    return Finding(at_angles(apart, "{:.1f}", "%"), max(apart.values()) < 5)


def _stop(one: xr.Dataset, speed: float) -> float:
    """First sample after which nothing thicker than 1 mm is faster than so much [s]; infinite if there is none."""
    t, v = one["series_time"].values, one["v_flow"].values
    fast = np.flatnonzero(~(v < speed))
    return float(t[fast[-1] + 1]) if fast.size and fast[-1] + 1 < t.size else float("inf")


STOP = "First sample after which nothing thicker than 1 mm moves faster than 1 mm/s, 0.1 mm/s and 0.01 mm/s. "


@claim("4.3.1", "fig09", shared=STOP, paper="0.48 s, 0.66 s")
def stop_times(r: Results) -> Finding:
    """The simulated mass stops at 0.48 s at 0 degrees and at 0.66 s at 10 degrees.

    Holds if the paper's instant lies no more than 0.03 s outside this range.
    """
    words, holds = [], True
    for angle, said in ((0.0, 0.48), (10.0, 0.66)):
        one = collapse(r, angle, "dense")
        times = [_stop(one, REST_SPEED / n) for n in (1, 10, 100)]
        words.append(f"{angle:g}: " + ", ".join(f"{t:.2f}" for t in times) + " s")
        holds &= times[0] - 0.03 <= said <= times[-1] + 0.03
    return Finding("; ".join(words), holds)


@claim("4.3.1", "fig09", paper="0.66 s, 1.02 s")
def stops_before_experiment(r: Results) -> Finding:
    """The simulated mass stops before the experiment (0.66 s at 0 degrees, 1.02 s at 10 degrees).

    First sample after which nothing thicker than 1 mm is faster than 1 mm/s; holds if earlier.
    """
    times = {angle: _stop(collapse(r, angle, "dense"), REST_SPEED) for angle in (0.0, 10.0)}
    return Finding(at_angles(times, "{:.2f}", "s"), times[0.0] < 0.66 and times[10.0] < 1.02)


@claim("4.3.1, Fig. 8d", "fig08")
def front_creeps(r: Results) -> Finding:
    """At 22 degrees and 1.8 s, when the experiment has stopped, almost all is at rest, but the front still creeps.

    Part of the solid slower than 1 mm/s, and the speed of the front; holds if the first is above 80 % and the
    second above 1 mm/s.
    """
    one = collapse(r, 22, "dense")
    shot = at(one, 1.8)
    still, speed = 1 - solid_share(shot, moving(shot), mass(shot)), float(one["front_speed"].values[-1])
    return Finding(f"{100 * still:.0f} % at rest, front {1e3 * speed:.0f} mm/s", still > 0.8 and speed > REST_SPEED)


@claim("4.3.1", "fig09", shared=STOP, paper="19 s, 40 s")
def full_stop(r: Results) -> Finding:
    """At 22 degrees all motion ends after more than 7.5 s, at about 40 s; from 19 s on it is slower than 1 mm/s.

    Holds if the first is between 7.5 s and 40 s.
    """
    one = r.run("stopping", angle=22)
    times = [_stop(one, REST_SPEED / n) for n in (1, 10, 100)]
    words = ", ".join(f"{t:.1f} s" if np.isfinite(t) else "after 40 s" for t in times)
    return Finding(f"{words}; {1e3 * float(one['v_flow'].values[-1]):.4f} mm/s at 40 s", 7.5 < times[0] <= 40)


@claim("4.3.1, Fig. 6d", "fig06")
def deposit_is_there(r: Results) -> Finding:
    """At 22 degrees the deposit is almost the profile of 1.8 s.

    Greatest difference of h between 40 s and 1.8 s over the greatest thickness, and way of the front over the
    extent; holds if both are below 5 %.
    """
    one = r.run("stopping", angle=22)
    early, late = at(one, 1.8), at(one, 40.0)
    h = float(abs(late["h"].values - early["h"].values).max() / late["h"].values.max())
    way = (front_of(late) - front_of(early)) / (front_of(late) - float(parameter(one, "grid.left")))
    return Finding(f"thickness {100 * h:.1f} %, front {100 * way:.1f} %", h < 0.05 and abs(way) < 0.05)


# The slow regime of the front


REGIME = (
    "Least mean deceleration of the front over 0.1 s while it is between 0.1 and 0.5 m/s, over its mean deceleration "
    "down to 0.5 m/s, with the front at 1 mm and at 5 mm. "
)


def regime(r: Results, packing: str, K: float | None = None) -> tuple[str, float, float]:
    """How nearly steady the front gets at 22 degrees, with the front at 1 mm and at 5 mm."""
    both = [collapse(r, 22, packing, K, source) for source in ("collapses", "fronts")]
    thin, thick = (slow_regime(one["series_time"].values, one["front_speed"].values) for one in both)
    return f"{packing}{'' if K is None else f' K = {K:g}'} {thin:.2f} and {thick:.2f}", thin, thick


@claim("4.3.1, Figs. 9b, 20b", "fig09 fig20", shared=REGIME)
def dense_slow_regime(r: Results) -> Finding:
    """At 22 degrees the front of the dense mass passes from its deceleration into a slow, almost steady regime.

    Holds if both are below 0.25.
    """
    words, thin, thick = regime(r, "dense")
    return Finding(words, max(thin, thick) < 0.25)


@claim("4.3.1, 5, Figs. 9b, 20b", "fig09 fig20", shared=REGIME)
def no_slow_regime(r: Results) -> Finding:
    """The loose mass (K = 4.09) and the incompressible one have no such regime.

    Holds if all are above 0.5.
    """
    found = [regime(r, "loose"), regime(r, "incompressible")]
    values = [value for _, thin, thick in found for value in (thin, thick)]
    return Finding("; ".join(words for words, _, _ in found), min(values) > 0.5)


@claim("4.4, Fig. 20b", "fig20", shared=REGIME)
def loose_slow_regime(r: Results) -> Finding:
    """The loose mass has the slow regime at K = 1, and not at K = 8.

    Holds if both are below 0.25 at K = 1 and above 0.5 at K = 8.
    """
    one, eight = regime(r, "loose", 1.0), regime(r, "loose", 8.0)
    return Finding(f"{one[0]}; {eight[0]}", max(one[1:]) < 0.25 and min(eight[1:]) > 0.5)


@claim("4.4, Fig. 21b", "fig21")
def regime_dilates(r: Results) -> Finding:
    """At 1.2 s the front dilates in the dense mass and in the loose one at K = 1; at larger K the loose contracts.

    Mean dilatancy angle over the last 5 cm; holds if all signs are those.
    """
    found = {}
    for name in TWO:
        for K in (1.0, 4.09, 8.0):
            shot = at(collapse(r, 22, name, K), 1.2)
            found[name, K] = mean(shot, "psi", front_zone(shot))
    words = ", ".join(f"{name} K = {K:g}: {psi:+.2f}" for (name, K), psi in found.items())
    dilates = {key for key, psi in found.items() if psi > 0}
    return Finding(f"{words} degrees", dilates == {*(("dense", K) for K in (1.0, 4.09, 8.0)), ("loose", 1.0)})


# Dilatancy and friction


@claim("4.3.2, Figs. 10c, 12c", "fig10 fig12", paper="8 degrees")
def psi_at_first(r: Results) -> Finding:
    """At first dilatancy angles are about 8 degrees at most.

    Greatest |psi| of the mass at 0.06 s, and of its part thicker than 5 mm, both packings, 0 and 22 degrees; holds
    if between 7 and 9 degrees.
    """
    shots = [at(collapse(r, angle, name), 0.06) for angle in (0, 22) for name in TWO]
    most, thick = (max(abs(over(shot, "psi", mass(shot, level))).max() for shot in shots) for level in (1e-3, 5e-3))
    return Finding(f"{most:.1f} degrees, {thick:.1f} where h > 5 mm", bool(7 < most < 9))


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

    Greatest relative change of the volume (h > 1 mm); holds if it grows from slope to slope and is 9 to 11 % at 22
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


# Forces

FORCES = ("f_acc", "f_inert", "f_press", "f_grav", "f_fric")


def force_means(r: Results, angle: float, t: float, packing: str = "dense") -> dict[str, float]:
    """Mean amount of each force over the moving mass, as part of the largest."""
    one = collapse(r, angle, packing, source="forces")
    shot, found = at(one, t), at(forces(one), t)
    amounts = {name: float(np.nanmean(abs(found[name].values[moving(shot)]))) for name in FORCES}
    return {name: amount / max(amounts.values()) for name, amount in amounts.items()}


FORCE = "Mean amount of each force over the moving dense mass, the largest being 1. "


@claim("4.3.3, Fig. 15a,c", "fig15", shared=FORCE)
def all_forces_at_first(r: Results) -> Finding:
    """At the beginning (0.06 s) all forces matter.

    Holds if all (but gravity at 0 degrees, which is none) are above 0.1.
    """
    found = {angle: force_means(r, angle, 0.06) for angle in (0.0, 22.0)}
    least = [v for angle, parts in found.items() for name, v in parts.items() if (angle, name) != (0.0, "f_grav")]
    words = "; ".join(f"{angle:g}: {by_packing(parts)}" for angle, parts in found.items())
    return Finding(words, min(least) > 0.1)


@claim("4.3.3, Fig. 15b", "fig15", shared=FORCE)
def pressure_against_friction(r: Results) -> Finding:
    """Later at 0 degrees (0.36 s) pressure gradient and friction balance, with some acceleration.

    Holds if these two are above 0.5 and the others below.
    """
    parts = force_means(r, 0, 0.36)
    holds = min(parts["f_press"], parts["f_fric"]) > 0.5 > max(parts["f_acc"], parts["f_inert"], parts["f_grav"])
    return Finding(by_packing(parts), holds)


@claim("4.3.3, Fig. 15d", "fig15", shared=FORCE)
def gravity_against_friction(r: Results) -> Finding:
    """Later at 22 degrees (1.38 s) gravity and friction balance, with some pressure gradient.

    Holds if these two are above 0.5 and the others below.
    """
    parts = force_means(r, 22, 1.38)
    holds = min(parts["f_grav"], parts["f_fric"]) > 0.5 > max(parts["f_acc"], parts["f_inert"], parts["f_press"])
    return Finding(by_packing(parts), holds)


@claim("4.3.3, Fig. 15d", "fig15")
def acceleration_against_inertia(r: Results) -> Finding:
    """There acceleration and inertia balance each other.

    Mean amount of their sum over the sum of their mean amounts, moving dense mass at 22 degrees; the paper gives no
    instant: holds if below 0.5 at 0.48 or at 1.38 s.
    """
    one = collapse(r, 22, "dense", source="forces")
    found, ratios = forces(one), {}
    for t in (0.48, 1.38):
        acc, inert = (at(found, t)[name].values[moving(at(one, t))] for name in ("f_acc", "f_inert"))
        ratios[t] = float(np.nanmean(abs(acc + inert)) / (np.nanmean(abs(acc)) + np.nanmean(abs(inert))))
    return Finding(", ".join(f"{ratio:.2f} at {t:g} s" for t, ratio in ratios.items()), min(ratios.values()) < 0.5)


@claim("4.3.3, Fig. 15", "fig15")
def dilatancy_on_forces(r: Results) -> Finding:
    """Dilatancy changes the friction and the pressure gradient most.

    Mean difference of each force between dense and loose over the mass, over the largest such difference, at 0.06
    and 0.36 s (0 degrees), 0.06 and 1.38 s (22 degrees); holds if those two are the largest every time.
    """
    words, holds = [], True
    for angle, t in ((0, 0.06), (0, 0.36), (22, 0.06), (22, 1.38)):
        ones = [collapse(r, angle, name, source="forces") for name in TWO]
        shots, found = [at(one, t) for one in ones], [at(forces(one), t) for one in ones]
        both = mass(shots[0]) & mass(shots[1])
        apart = {n: float(np.nanmean(abs(found[0][n].values - found[1][n].values)[both])) for n in FORCES}
        most = max(apart.values())
        words.append(f"{angle:g} at {t:g} s: " + ", ".join(f"{n} {v / most:.2f}" for n, v in apart.items()))
        holds &= set(sorted(apart, key=lambda n: apart[n])[-2:]) == {"f_press", "f_fric"}
    return Finding("; ".join(words), holds)


CLAIMS = (
    thickest_is_dense, same_front_at_0, dilatant_runs_farther, incompressible_between, same_speed_at_first,
    speeds_at_036, dense_front_faster, incompressible_slowest_late, dense_front_ahead, same_front_speed, stop_times,
    stops_before_experiment, front_creeps, full_stop, deposit_is_there, dense_slow_regime, no_slow_regime,
    loose_slow_regime, regime_dilates, psi_at_first, psi_at_036, psi_small_at_22, front_dilates_at_first,
    front_contracts_late, contracts_at_024, contracts_before_rest, memory_is_lost, friction_rises_at_first,
    friction_falls_late, friction_rises_at_22, friction_rises_without_dilatancy, dilation_grows, dilation_lasts,
    loose_is_compressed, all_forces_at_first, pressure_against_friction, gravity_against_friction,
    acceleration_against_inertia, dilatancy_on_forces,
)  # fmt: skip
