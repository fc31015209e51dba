"""Claims of section 4.3.3: the balance of forces."""

from __future__ import annotations

import numpy as np

from warpgran.analysis.forces import forces
from warpgran.paper.claim import Finding, by_packing, claim
from warpgran.paper.measures import mass, moving
from warpgran.paper.results import TWO, Results, at, collapse

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


def balance(r: Results, angle: float, t: float, *pair: str) -> Finding:
    """Whether two forces are above 0.5 of the largest and the others below."""
    parts = force_means(r, angle, t)
    others = (part for name, part in parts.items() if name not in pair)
    return Finding(by_packing(parts), min(parts[name] for name in pair) > 0.5 > max(others))


@claim("4.3.3, Fig. 15b", "fig15", shared=FORCE)
def pressure_against_friction(r: Results) -> Finding:
    """Later at 0 degrees (0.36 s) pressure gradient and friction balance, with some acceleration.

    Holds if these two are above 0.5 and the others below.
    """
    return balance(r, 0, 0.36, "f_press", "f_fric")


@claim("4.3.3, Fig. 15d", "fig15", shared=FORCE)
def gravity_against_friction(r: Results) -> Finding:
    """Later at 22 degrees (1.38 s) gravity and friction balance, with some pressure gradient.

    Holds if these two are above 0.5 and the others below.
    """
    return balance(r, 22, 1.38, "f_grav", "f_fric")


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
    all_forces_at_first,
    pressure_against_friction,
    gravity_against_friction,
    acceleration_against_inertia,
    dilatancy_on_forces,
)
