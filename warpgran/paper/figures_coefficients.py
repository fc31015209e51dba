"""Figs. 16 to 25 of the paper: the dilation coefficient K, and friction at the side walls."""

from __future__ import annotations

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from warpgran.figures.style import THIN
from warpgran.paper.figures_packing import draw_forces
from warpgran.paper.laboratory import Laboratory
from warpgran.paper.measures import front_of
from warpgran.paper.panels import (
    DASHES,
    Style,
    against_time,
    along,
    draw_profile,
    draw_series,
    finish,
    head,
    shades,
    sheet,
)
from warpgran.paper.picture import picture
from warpgran.paper.results import K_PAPER, TWO, Results, at, collapse

COEFFICIENTS = (0.0, 1.0, K_PAPER, 8.0)
SHADES = dict(zip(COEFFICIENTS, shades(4), strict=True))
WALLS = {0.0: "no wall friction", 0.18: r"$\mu_\mathrm{w}$ = 0.18"}


def all_K(ax: Axes, r: Results, angle: float, t: float, name: str) -> None:
    """A field at one instant for every K: dense full, loose dashed."""
    for packing in TWO:
        for K, colour in SHADES.items():
            shot = at(collapse(r, angle, packing, K), t)
            draw_profile(ax, shot, name, f"K = {K:g}, {packing}", color=colour, linestyle=DASHES[packing])
    if name == "psi":
        ax.axhline(0.0, **THIN)
    if name == "h":
        ax.set_ylim(bottom=0.0)
    head(ax, f"{angle:g}°, $t$ = {t:g} s")


def series_of_K(ax: Axes, r: Results, angle: float, name: str, source: str = "collapses") -> None:
    """A series for every K: dense full, loose dashed."""
    for packing in TWO:
        for K, colour in SHADES.items():
            one, label = collapse(r, angle, packing, K, source), f"K = {K:g}, {packing}"
            draw_series(ax, one, name, label, color=colour, linestyle=DASHES[packing])
    against_time([ax])


def thickness_and_velocity(r: Results, lab: Laboratory, angle: int, t: float) -> Figure:
    """Figs. 16 and 19: for every K at one slope and instant."""
    figure, axes = sheet(1, 2, 2.5)
    for ax, name in zip(axes.flat, ("h", "v"), strict=True):
        all_K(ax, r, angle, t, name)
    lab.profile(axes[0, 0], angle, t)
    along(axes)
    return finish(figure, list(axes.flat))


@picture
def fig16(r: Results, lab: Laboratory) -> Figure:
    """Thickness and velocity for four K at 0 degrees.

    (a) Thickness and (b) velocity at 0 degrees and 0.36 s for K = 0, 1, 4.09 and 8, dense (full lines) and loose
    (dashed), no walls.
    """
    return thickness_and_velocity(r, lab, 0, 0.36)


@picture
def fig17(r: Results, lab: Laboratory) -> Figure:
    """Dilatancy, friction and forces for four K at 0 degrees.

    At 0 degrees and 0.36 s for K = 0, 1, 4.09 and 8, dense (full lines) and loose (dashed), no walls: (a) volume
    fraction, (b) dilatancy angle, (c) effective friction, (d) pressure gradient (above) and friction force (below).
    """
    figure, axes = sheet(2, 2)
    for ax, name in zip(axes.flat, ("phi", "psi", "mu"), strict=False):
        all_K(ax, r, 0, 0.36, name)
    for packing in TWO:
        for K, colour in SHADES.items():
            one = collapse(r, 0, packing, K, "forces")
            ax = axes[1, 1]
            before = len(ax.lines)
            draw_forces(ax, one, 0.36, ("f_press", "f_fric"), linestyle=DASHES[packing])
            for line in ax.lines[before : before + 2]:
                line.set(color=colour, label="_")
    head(axes[1, 1], "0°, $t$ = 0.36 s")
    along(axes)
    return finish(figure, list(axes.flat))


@picture
def fig18(r: Results, lab: Laboratory) -> Figure:
    """Volume change for four K.

    Change of the volume of the mass for K = 0, 1, 4.09 and 8 at (a) 0 degrees and (b) 22 degrees, dense (full
    lines) and loose (dashed), no walls. (The paper has no K = 1 here.)
    """
    figure, axes = sheet(1, 2, 2.5)
    for ax, angle in zip(axes.flat, (0, 22), strict=True):
        series_of_K(ax, r, angle, "volume_change")
        lab.volume(ax, angle)
        head(ax, f"{angle}°")
    axes[0, 0].set_xlim(0.0, 0.8)
    return finish(figure, list(axes.flat))


@picture
def fig19(r: Results, lab: Laboratory) -> Figure:
    """Thickness and velocity for four K at 22 degrees.

    (a) Thickness and (b) velocity at 22 degrees and 0.48 s for K = 0, 1, 4.09 and 8, dense (full lines) and loose
    (dashed), no walls.
    """
    return thickness_and_velocity(r, lab, 22, 0.48)


@picture
def fig20(r: Results, lab: Laboratory) -> Figure:
    """Front position and velocity for four K at 22 degrees.

    (a) Front position and (b) front velocity at 22 degrees for K = 0, 1, 4.09 and 8, dense (full lines) and loose
    (dashed), no walls. The front is where h_c = 1 mm. (c), not in the paper: the velocity of the front at h_c = 5 mm,
    where the thin foot that runs ahead of the mass is left out.
    """
    figure, axes = sheet(3, 1, 2.1, sharex=True)
    for ax, name, source in zip(
        axes.flat, ("front", "front_speed", "front_speed"), ("collapses", "collapses", "fronts"), strict=True
    ):
        series_of_K(ax, r, 22, name, source)
        (lab.front if name == "front" else lab.front_speed)(ax, 22)
    for ax in axes[:2, 0]:
        ax.set_xlabel("")
    for ax in axes[1:, 0]:
        ax.set_ylim(0.0, 1.6)
    head(axes[2, 0], r"front at $h_\mathrm{c}$ = 5 mm")
    return finish(figure, list(axes.flat), 2)


@picture
def fig21(r: Results, lab: Laboratory) -> Figure:
    """Forces and dilatancy near the front at 22 degrees.

    Near the front at 22 degrees and 1.2 s, no walls: (a) forces at K = 4.09, colours as in Fig. 15, dense (full
    lines) and loose (dotted); (b) dilatancy angle for K = 0, 1, 4.09 and 8, dense (full lines) and loose (dashed),
    cut off at 3 degrees. Drawn where h_c > 1 mm.
    """
    figure, axes = sheet(2, 1, 2.4)
    for packing, line in (("dense", "-"), ("loose", ":")):
        draw_forces(axes[0, 0], collapse(r, 22, packing, K_PAPER, "forces"), 1.2, linestyle=line)
    all_K(axes[1, 0], r, 22, 1.2, "psi")
    ends = [front_of(at(collapse(r, 22, packing, K), 1.2)) for packing in TWO for K in COEFFICIENTS]
    for ax in axes.flat:
        ax.set_xlim(min(ends) - 0.15, max(ends) + 0.01)
    axes[0, 0].set_ylim(-0.065, 0.065)
    axes[1, 0].set_ylim(-1.5, 3.0)
    handles, names = axes[0, 0].get_legend_handles_labels()
    axes[0, 0].legend(handles[:5], names[:5], ncols=3, loc="lower right")
    head(axes[0, 0], "22°, $t$ = 1.2 s")
    along(axes)
    return finish(figure, list(axes.flat), 2, of=[axes[1, 0]])


def with_walls(r: Results, angle: float) -> dict[str, tuple[xr.Dataset, Style]]:
    """The dense mass with dilatancy and without, with wall friction and without; and how each is drawn."""
    found: dict[str, tuple[xr.Dataset, Style]] = {}
    for K, colour in ((K_PAPER, "#c0392b"), (0.0, "black")):
        for mu, line in ((0.0, "-"), (0.18, (0, (4, 1.8)))):
            one = r.run("walls", angle=angle, K=K, mu_wall=mu)
            found[f"K = {K:g}, {WALLS[mu]}"] = (one, {"color": colour, "linestyle": line})
    return found


@picture
def fig22(r: Results, lab: Laboratory) -> Figure:
    """Thickness with wall friction.

    Thickness with friction at the side walls (dashed) and without (full lines), dense packing, K = 0 and 4.09, at 0
    degrees (0.24 and 0.66 s) and 22 degrees (0.48 and 1.8 s). The paper does not give the instants.
    """
    figure, axes = sheet(2, 2)
    for ax, (angle, t) in zip(axes.T.flat, ((0, 0.24), (0, 0.66), (22, 0.48), (22, 1.8)), strict=True):
        for label, (one, style) in with_walls(r, angle).items():
            draw_profile(ax, at(one, t), "h", label, **style)
        lab.profile(ax, angle, t)
        ax.set_ylim(bottom=0.0)
        head(ax, f"{angle}°, $t$ = {t:g} s")
    along(axes)
    return finish(figure, list(axes.T.flat), 2)


@picture
def fig23(r: Results, lab: Laboratory) -> Figure:
    """Dilatancy and friction with wall friction.

    Volume fraction, dilatancy angle, effective friction (with the term of the walls) and velocity at 0 degrees and
    0.36 s, with friction at the side walls (dashed) and without (full lines), dense packing, K = 0 and 4.09. The
    caption of the paper does not name the fields; its text names the first three.
    """
    figure, axes = sheet(2, 2)
    for ax, name in zip(axes.flat, ("phi", "psi", "mu", "v"), strict=True):
        for label, (one, style) in with_walls(r, 0).items():
            draw_profile(ax, at(one, 0.36), name, label, **style)
    along(axes)
    return finish(figure, list(axes.flat), 2)


@picture
def fig24(r: Results, lab: Laboratory) -> Figure:
    """Volume change with wall friction.

    Change of the volume of the mass with friction at the side walls (dashed) and without (full lines), dense
    packing, K = 0 and 4.09, at (a) 0 degrees and (b) 22 degrees.
    """
    figure, axes = sheet(1, 2, 2.4)
    for ax, angle in zip(axes.flat, (0, 22), strict=True):
        for label, (one, style) in with_walls(r, angle).items():
            draw_series(ax, one, "volume_change", label, **style)
        lab.volume(ax, angle)
        head(ax, f"{angle}°")
    against_time(list(axes.flat))
    axes[0, 0].set_xlim(0.0, 0.8)
    return finish(figure, list(axes.flat), 2)


@picture
def fig25(r: Results, lab: Laboratory) -> Figure:
    """Front velocity with wall friction.

    Front velocity at 22 degrees with friction at the side walls (dashed) and without (full lines), dense packing, K
    = 0 and 4.09. The front is where h_c = 1 mm.
    """
    figure, axes = sheet(1, 1, 2.6)
    for label, (one, style) in with_walls(r, 22).items():
        draw_series(axes[0, 0], one, "front_speed", label, **style)
    lab.front_speed(axes[0, 0], 22)
    axes[0, 0].set_ylim(top=2.0)
    against_time([axes[0, 0]])
    return finish(figure, [axes[0, 0]], 2)


PICTURES = (fig16, fig17, fig18, fig19, fig20, fig21, fig22, fig23, fig24, fig25)
