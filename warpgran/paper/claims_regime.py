"""Claims of sections 4.3.1 and 4.4 on the slow regime of the front at 22 degrees."""

from __future__ import annotations

from warpgran.paper.claim import Finding, claim
from warpgran.paper.measures import front_zone, mean, slow_regime
from warpgran.paper.results import TWO, Results, at, collapse

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


CLAIMS = (
    dense_slow_regime,
    no_slow_regime,
    loose_slow_regime,
    regime_dilates,
)
