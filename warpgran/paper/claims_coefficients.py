"""Claims of sections 4.2, 4.4 and 4.5: experiments, the dilation coefficient K, and friction at the side walls."""

from __future__ import annotations

import numpy as np
import xarray as xr

from warpgran.analysis.correlation import rank_correlation
from warpgran.arrays import Array
from warpgran.paper.claim import Finding, claim
from warpgran.paper.measures import extent, field, front_of, front_zone, mass, mean, over, rear, same_cells
from warpgran.paper.results import K_PAPER, Results, at, collapse

FOUR = (0.0, 1.0, K_PAPER, 8.0)
TWO = ("dense", "loose")


def by_K(values: dict[float, float], form: str = "{:.2f}", unit: str = "") -> str:
    """Values by K, in words."""
    return ", ".join(f"K = {K:g}: {form.format(value)}" for K, value in values.items()) + f" {unit}".rstrip()


def apart(a: xr.Dataset, b: xr.Dataset, name: str = "h") -> float:
    """Mean difference of a field of two snapshots over the mass."""
    p, q = same_cells(a, b, name)
    return float(abs(p - q).mean())


@claim("4.2, 4.3.1", "fig05 fig06 fig09", paper="15 to 40 %, 25 %")
def against_experiments(r: Results) -> Finding:
    """Against experiments the front is too far by 15 to 40 % at 22 degrees, the thickness too small by up to 25 %.

    The profiles measured in the laboratory are not public.
    """
    return Finding("no laboratory data", None)


@claim("4.4, Fig. 16a", "fig16")
def thickness_saturates(r: Results) -> Finding:
    """At 0 degrees and 0.36 s the thickness changes with K up to about 4, and hardly beyond.

    Mean change of h over the mass from K = 4.09 to 8, over that from 0 to 4.09; holds if below 0.25 in both
    packings.
    """
    ratio = {}
    for name in TWO:
        shots = {K: at(collapse(r, 0, name, K), 0.36) for K in FOUR}
        ratio[name] = apart(shots[8.0], shots[K_PAPER]) / apart(shots[K_PAPER], shots[0.0])
    return Finding(", ".join(f"{name} {value:.2f}" for name, value in ratio.items()), max(ratio.values()) < 0.25)


@claim("4.4, Fig. 16b", "fig16")
def fastest_at_K_1(r: Results) -> Finding:
    """At 0 degrees and 0.36 s the greatest speed of the dense mass rises from K = 0 to 1 and falls for 4.09 and 8.

    Greatest speed where h_c > 1 mm, and where h_c > 5 mm; holds if both do so.
    """
    words, holds = [], True
    for level, name in ((1e-3, "1 mm"), (5e-3, "5 mm")):
        shots = {K: at(collapse(r, 0, "dense", K), 0.36) for K in FOUR}
        top = {K: 1e3 * float(over(shot, "v", mass(shot, level)).max()) for K, shot in shots.items()}
        words.append(f"h_c > {name}: {by_K(top, '{:.0f}', 'mm/s')}")
        holds &= top[1.0] > top[0.0] and top[1.0] > top[K_PAPER] > top[8.0]
    return Finding("; ".join(words), holds)


@claim("4.4, Fig. 16b", "fig16")
def rear_speed_opposite(r: Results) -> Finding:
    """At the rear it is the opposite: slower at K = 1 than at 0, faster for 4.09 and 8.

    Mean speed of the dense mass from the wall to x = -5 cm, 0 degrees, 0.36 s; holds if it falls and then rises so.
    """
    shots = {K: at(collapse(r, 0, "dense", K), 0.36) for K in FOUR}
    speed = {K: 1e3 * mean(s, "v", mass(s) & (s["x"].values < -0.05)) for K, s in shots.items()}
    return Finding(by_K(speed, "{:.1f}", "mm/s"), speed[1.0] < speed[0.0] and speed[1.0] < speed[K_PAPER] < speed[8.0])


@claim("4.4, Fig. 17a", "fig17")
def phi_at_rear(r: Results) -> Finding:
    """With K the volume fraction of the rear falls in the dense packing and rises in the loose one.

    Mean phi over the moving part of the column's place (x < 0), 0 degrees, 0.36 s; holds if so from each K to the
    next.
    """
    words, holds = [], True
    for name, sign in (("dense", -1), ("loose", 1)):
        shots = {K: at(collapse(r, 0, name, K), 0.36) for K in FOUR}
        phi = {K: mean(shot, "phi", mass(shot) & (shot["x"].values < 0)) for K, shot in shots.items()}
        words.append(f"{name} {by_K(phi, '{:.4f}')}")
        holds &= bool(np.all(sign * np.diff(list(phi.values())) > 0))
    return Finding("; ".join(words), holds)


@claim("4.4, Fig. 17b", "fig17")
def psi_at_rear(r: Results) -> Finding:
    """With K dilatancy angles at the rear grow, up in the dense and down in the loose packing, also from 4.09 to 8.

    Mean psi over the first 10 cm, 0 degrees, 0.36 s; holds if so from each K to the next.
    """
    words, holds = [], True
    for name, sign in (("dense", 1), ("loose", -1)):
        shots = {K: at(collapse(r, 0, name, K), 0.36) for K in FOUR}
        psi = {K: mean(shot, "psi", rear(shot)) for K, shot in shots.items()}
        words.append(f"{name} {by_K(psi, '{:+.1f}')}")
        holds &= bool(np.all(sign * np.diff(list(psi.values())) > 0))
    return Finding("; ".join(words) + " degrees", holds)


@claim("4.4, Fig. 17c", "fig17")
def friction_with_K(r: Results) -> Finding:
    """With K the friction of the dense mass rises at the rear and falls near the front.

    Mean mu over the first 10 cm and over the last 5 cm, 0 degrees, 0.36 s; holds if so from each K to the next.
    Also near the front at 0.42 s.
    """
    shots = {K: at(collapse(r, 0, "dense", K), 0.36) for K in FOUR}
    later = {K: at(collapse(r, 0, "dense", K), 0.42) for K in FOUR}
    behind = {K: mean(shot, "mu", rear(shot)) for K, shot in shots.items()}
    ahead, then = ({K: mean(s, "mu", front_zone(s)) for K, s in group.items()} for group in (shots, later))
    holds = bool(np.all(np.diff(list(behind.values())) > 0) and np.all(np.diff(list(ahead.values())) < 0))
    words = f"rear {by_K(behind)}; front {by_K(ahead, '{:.3f}')}; at 0.42 s {by_K(then, '{:.3f}')}"
    return Finding(words, holds)


@claim("4.4, Fig. 18", "fig18")
def dilation_with_K(r: Results) -> Finding:
    """The dilation of the dense mass grows with K; at 22 degrees hardly any more beyond K = 4.

    Greatest relative change of the volume; holds if it grows from each K to the next at 0 and 22 degrees, and from
    4.09 to 8 by less than 5 % of itself at 22 degrees.
    """
    words, holds = [], True
    for angle in (0, 22):
        most = {K: 100 * float(collapse(r, angle, "dense", K)["volume_change"].max()) for K in FOUR}
        words.append(f"{angle} degrees: {by_K(most, '{:.2f}', '%')}")
        holds &= bool(np.all(np.diff(list(most.values())) > 0))
    holds &= most[8.0] < 1.05 * most[K_PAPER]
    return Finding("; ".join(words), holds)


@claim("4.4, Fig. 19a", "fig19")
def front_insensitive_to_K(r: Results) -> Finding:
    """At 22 degrees (0.48 s) front position and shape hardly depend on K > 1.

    Difference of the fronts (1 mm) at K = 4.09 and 8 over the extent of the mass, and greatest difference of h over
    the last 20 cm over the greatest thickness, both packings; holds if both are below 3 %. Also from K = 1 to 4.09.
    """

    def change(a: float, b: float) -> tuple[float, float]:
        pairs = [[at(collapse(r, 22, name, K), 0.48) for K in (a, b)] for name in TWO]
        found = [_front_change(*pair) for pair in pairs]
        return max(way for way, _ in found), max(shape for _, shape in found)

    beyond, before = change(K_PAPER, 8.0), change(1.0, K_PAPER)
    words = "front {:.1f} %, thickness {:.1f} %"
    found = [words.format(*(100 * value for value in values)) for values in (beyond, before)]
    return Finding(f"{found[0]}; from K = 1: {found[1]}", max(beyond) < 0.03)


def _front_change(a: xr.Dataset, b: xr.Dataset) -> tuple[float, float]:
    """Way of the front over the extent, and greatest difference of h over the last 20 cm over the greatest h."""
    extents = extent(a), extent(b)
    near = a["x"].values > min(front_of(a), front_of(b)) - 0.2
    shape = abs(a["h"].values - b["h"].values)[near].max() / a["h"].values.max()
    return abs(extents[0] - extents[1]) / max(extents), float(shape)


@claim("4.4, Fig. 19b", "fig19")
def loose_speed_sensitive(r: Results) -> Finding:
    """At 22 degrees (0.48 s) K > 4 changes the speeds of the loose mass more than those of the dense one.

    Mean change of v over the mass from K = 4.09 to 8; holds if larger in the loose one.
    """
    pairs = {name: [at(collapse(r, 22, name, K), 0.48) for K in (K_PAPER, 8.0)] for name in TWO}
    change = {name: 1e3 * apart(a, b, "v") for name, (a, b) in pairs.items()}
    words = ", ".join(f"{name} {value:.1f}" for name, value in change.items())
    return Finding(f"{words} mm/s", change["loose"] > change["dense"])


@claim("4.4, Fig. 20b", "fig20")
def regime_and_K(r: Results) -> Finding:
    """In the slow regime the front speed of the dense mass depends little on K > 1, that of the loose one strongly.

    Greatest spread of the front speed (5 mm) of K = 1, 4.09 and 8 from 1.0 to 1.4 s, over its mean; holds if that
    of the loose mass is at least twice that of the dense one.
    """
    spread = {}
    for name in TWO:
        ones = [collapse(r, 22, name, K, "fronts") for K in FOUR[1:]]
        t = ones[0]["series_time"].values
        speed = np.stack([one["front_speed"].values for one in ones])[:, (t > 0.995) & (t < 1.405)]
        spread[name] = 100 * float((speed.max(axis=0) - speed.min(axis=0)).max() / speed.mean())
    words = ", ".join(f"{name} {value:.0f}" for name, value in spread.items())
    return Finding(f"{words} %", spread["loose"] >= 2 * spread["dense"])


# Side walls


def walls(r: Results, angle: float, K: float = K_PAPER) -> tuple[xr.Dataset, xr.Dataset]:
    """The dense mass without friction at the walls and with it."""
    without, with_ = (r.run("walls", angle=angle, K=K, mu_wall=mu) for mu in (0.0, 0.18))
    return without, with_


@claim("4.5, Fig. 22", "fig22")
def walls_steepen(r: Results) -> Finding:
    """Wall friction steepens the mass: it is thicker at the rear, and ends earlier.

    Greatest thickness and front of the deposit, with over without, at K = 4.09; holds if the thickness grows and
    the front falls back at 0 and 22 degrees. At 0 degrees the top of the column stays as it was: there the mean
    thickness of the first 10 cm counts.
    """
    words, holds = [], True
    for angle in (0, 22):
        shots = [at(one, 1.8) for one in walls(r, angle)]
        behind = [mean(shot, "h", rear(shot)) for shot in shots]
        rise, way = behind[1] / behind[0] - 1, extent(shots[1]) / extent(shots[0]) - 1
        words.append(f"{angle}: rear {100 * rise:+.1f} %, extent {100 * way:+.1f} %")
        holds &= rise > 0 > way
    return Finding("; ".join(words), holds)


@claim("4.5, Fig. 22", "fig22")
def walls_change_all(r: Results) -> Finding:
    """Wall friction changes the whole mass, not only its rear, even at 0 degrees.

    Mean change of h over the front half of the deposit, over that of the rear half, at K = 4.09 and 0 degrees;
    holds if above 0.5.
    """
    a, b = (at(one, 1.8) for one in walls(r, 0))
    x, h = a["x"].values, abs(a["h"].values - b["h"].values)
    middle = (x[0] + front_of(a)) / 2
    ratio = float(h[mass(a) & (x > middle)].mean() / h[mass(a) & (x <= middle)].mean())
    return Finding(f"{ratio:.2f}", ratio > 0.5)


@claim("4.5, Fig. 22", "fig22")
def walls_like_dilatancy(r: Results) -> Finding:
    """At 0 degrees wall friction and dilatancy change the thickness by amounts of the same order.

    Mean change of h of the deposit by wall friction (K = 4.09) over that by dilatancy (K from 0 to 4.09, no walls);
    holds if between 1/3 and 3.
    """
    without, with_ = (at(one, 1.8) for one in walls(r, 0))
    ratio = apart(with_, without) / apart(without, at(walls(r, 0, 0.0)[0], 1.8))
    return Finding(f"{ratio:.2f}", 1 / 3 < ratio < 3)


@claim("4.5, Fig. 23", "fig23")
def walls_change_degree(r: Results) -> Finding:
    """Wall friction does not change volume fraction, dilatancy angle and friction in kind.

    Rank correlation over the mass of each field with and without, at 0 degrees and 0.36 s; holds if all are above
    0.9.
    """
    shots = [at(one, 0.36) for one in walls(r, 0)]
    both = mass(shots[0]) & mass(shots[1])
    found = {name: _correlation(shots, name, both) for name in ("phi", "psi", "mu")}
    return Finding(", ".join(f"{name} {value:.2f}" for name, value in found.items()), min(found.values()) > 0.9)


def _correlation(shots: list[xr.Dataset], name: str, where: Array) -> float:
    a, b = (field(shot, name)[where] for shot in shots)
    return rank_correlation(a, b)


@claim(
    "4.5, Fig. 24",
    "fig24",
    paper="a few percent",
)
def walls_lower_dilation(r: Results) -> Finding:
    """Wall friction lowers the dilation of the mass by a few percent.

    Greatest relative change of the volume, K = 4.09; holds if it falls by 1 to 20 % of itself at 0 and 22 degrees.
    """
    words, holds = [], True
    for angle in (0, 22):
        most = [100 * float(one["volume_change"].max()) for one in walls(r, angle)]
        fall = 1 - most[1] / most[0]
        words.append(f"{angle} degrees: {most[0]:.2f} to {most[1]:.2f} %, {100 * fall:.0f} % less")
        holds &= 0.01 < fall < 0.2
    return Finding("; ".join(words), holds)


@claim("4.5, Fig. 25", "fig25")
def walls_change_regime(r: Results) -> Finding:
    """At 22 degrees wall friction changes the front speed strongly in the slow regime after the deceleration.

    Mean change of the front speed (1 mm) from 1.0 to 1.4 s, over its mean without walls, K = 4.09; holds if above
    30 % and above that before (0.1 to 0.5 s).
    """
    without, with_ = (one for one in walls(r, 22))
    t, change = without["series_time"].values, abs((with_["front_speed"] - without["front_speed"]).values)

    def part(begin: float, end: float) -> float:
        then = (t > begin - 0.005) & (t < end + 0.005)
        return float(change[then].mean() / without["front_speed"].values[then].mean())

    late, early = part(1.0, 1.4), part(0.1, 0.5)
    return Finding(f"{100 * late:.0f} %, before {100 * early:.0f} %", late > 0.3 and late > early)


CLAIMS = (
    against_experiments, thickness_saturates, fastest_at_K_1, rear_speed_opposite, phi_at_rear, psi_at_rear,
    friction_with_K, dilation_with_K, front_insensitive_to_K, loose_speed_sensitive, regime_and_K, walls_steepen,
    walls_change_all, walls_like_dilatancy, walls_change_degree, walls_lower_dilation, walls_change_regime,
)  # fmt: skip
