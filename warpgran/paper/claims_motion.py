"""Claims of section 4.3.1: thickness, speed and front of the packings, and when they stop."""

from __future__ import annotations

import numpy as np
import xarray as xr

from warpgran.analysis.fields import number
from warpgran.analysis.run_values import stop_time
from warpgran.paper.claim import Finding, at_angles, by_packing, claim
from warpgran.paper.measures import (
    GRAIN_TENTH,
    REST_SPEED,
    extent,
    front_of,
    front_zone,
    mass,
    mean,
    moving,
    over,
    solid_share,
)
from warpgran.paper.results import ANGLES, THREE, TWO, Results, at, collapse


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

    Spread of the three deposits' fronts over the extent of the mass, at h_c = 1 mm and 5 mm; holds if both are
    below 3 %.
    """
    shots = [at(collapse(r, 0, name), 1.8) for name in THREE]
    extents = [[extent(shot, level) for shot in shots] for level in (1e-3, 5e-3)]
    spread = [(max(e) - min(e)) / max(e) for e in extents]
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
    wall = number(shots[0], "grid.left")
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
    found = stop_time(one["series_time"].values, one["v_flow"].values, speed)
    return float("inf") if np.isnan(found) else found


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
    way = 1 - extent(early) / extent(late)
    return Finding(f"thickness {100 * h:.1f} %, front {100 * way:.1f} %", h < 0.05 and abs(way) < 0.05)


CLAIMS = (
    thickest_is_dense,
    same_front_at_0,
    dilatant_runs_farther,
    incompressible_between,
    same_speed_at_first,
    speeds_at_036,
    dense_front_faster,
    incompressible_slowest_late,
    dense_front_ahead,
    same_front_speed,
    stop_times,
    stops_before_experiment,
    front_creeps,
    full_stop,
    deposit_is_there,
)
