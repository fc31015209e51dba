"""Figs. 5 to 15 of the paper: what the initial packing does."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from warpgran.analysis.forces import forces
from warpgran.figures.style import THIN
from warpgran.paper.laboratory import Laboratory
from warpgran.paper.measures import mass
from warpgran.paper.panels import DASHES, against_time, along, draw_series, finish, head, profiles, shades, sheet
from warpgran.paper.picture import picture
from warpgran.paper.results import ANGLES, PACKINGS, TWO, Results, at, collapse

GIVEN = {0: (0.06, 0.36, 0.48, 0.66), 10: (0.06, 0.36, 0.66, 1.02), 22: (0.06, 0.48, 1.38, 1.8)}  # s
FORCES = {
    "f_acc": ("#e69f00", r"$f_\mathrm{acc}$"),
    "f_inert": ("#1fa3c9", r"$f_\mathrm{inert}$"),
    "f_press": ("#2a8f4f", r"$f_\mathrm{press}$"),
    "f_grav": ("#6a3d9a", r"$f_\mathrm{grav}$"),
    "f_fric": ("#c2185b", r"$f_\mathrm{fric}$"),
}


def three(ax: Axes, r: Results, angle: float, t: float, name: str) -> None:
    """A field of the three packings at one instant."""
    profiles(ax, {packing: at(collapse(r, angle, packing), t) for packing in PACKINGS}, name)
    head(ax, f"{angle:g}°, $t$ = {t:g} s")


@picture
def fig05(r: Results, lab: Laboratory) -> Figure:
    """Thickness at 0 and 10 degrees.

    Thickness of initially dense and loose masses (K = 4.09) and without dilatancy (K = 0), no walls, at 0 degrees
    (left) and 10 degrees (right). The paper does not give the instants; the last are those at which the experiments
    stopped.
    """
    figure, axes = sheet(4, 2, 1.55)
    for column, angle in zip(axes.T, (0, 10), strict=True):
        for ax, t in zip(column, GIVEN[angle], strict=True):
            three(ax, r, angle, t, "h")
            lab.profile(ax, angle, t)
            ax.set_xlim(-0.2, (0.4, 0.55)[angle // 10])
    along(axes)
    return finish(figure, list(axes.T.flat))


@picture
def fig06(r: Results, lab: Laboratory) -> Figure:
    """Thickness at 22 degrees.

    Thickness of initially dense and loose masses (K = 4.09) and without dilatancy (K = 0), no walls, at 22 degrees;
    the inset of (d) compares 1.8 s with 40 s for the dense mass.
    """
    figure, axes = sheet(2, 2)
    for ax, t in zip(axes.flat, GIVEN[22], strict=True):
        three(ax, r, 22, t, "h")
        lab.profile(ax, 22, t)
    creep = r.run("stopping", angle=22)
    inset = axes[1, 1].inset_axes((0.4, 0.57, 0.57, 0.4))
    axes[1, 1].set_ylim(top=7.0)
    for t, style in ((1.8, "-"), (40.0, ":")):
        shot = at(creep, t)
        inset.plot(shot["x"], 100 * shot["h"].where(shot["h"] > 1e-3), "k", linestyle=style, label=f"{t:g} s")
    inset.legend(fontsize=6.5, loc="upper right")
    inset.tick_params(labelsize=6.5)
    inset.set_ylim(bottom=0.0)
    inset.set_xticks([0.0, 0.5, 1.0])
    along(axes)
    return finish(figure, list(axes.flat))


@picture
def fig07(r: Results, lab: Laboratory) -> Figure:
    """Velocity at 0 degrees.

    Velocity at 0 degrees, at 0.06 s and 0.36 s; no walls. Drawn where h_c > 1 mm.
    """
    figure, axes = sheet(1, 2, 2.3)
    for ax, t in zip(axes.flat, (0.06, 0.36), strict=True):
        three(ax, r, 0, t, "v")
    along(axes)
    return finish(figure, list(axes.flat))


@picture
def fig08(r: Results, lab: Laboratory) -> Figure:
    """Velocity at 22 degrees.

    Velocity at 22 degrees, at 0.06, 0.48, 1.38 and 1.8 s; no walls. Drawn where h_c > 1 mm.
    """
    figure, axes = sheet(2, 2)
    for ax, t in zip(axes.flat, GIVEN[22], strict=True):
        three(ax, r, 22, t, "v")
    along(axes)
    return finish(figure, list(axes.flat))


@picture
def fig09(r: Results, lab: Laboratory) -> Figure:
    """Front position and velocity.

    (a) Front position and (b) front velocity at the four slopes, dense (full lines) and loose (dashed), K = 4.09,
    no walls. The front is where h_c = 1 mm. (c), not in the paper: the velocity of the front at h_c = 5 mm.
    """
    figure, axes = sheet(3, 1, 2.1, sharex=True)
    panels = ((axes[0, 0], "front", "collapses"), (axes[1, 0], "front_speed", "collapses"))
    for ax, name, source in (*panels, (axes[2, 0], "front_speed", "fronts")):
        for angle, colour in zip(ANGLES, shades(4)[::-1], strict=True):
            for packing in TWO:
                one = collapse(r, angle, packing, source=source)
                label = f"{angle:g}°, {packing}"
                draw_series(ax, one, name, label, color=colour, linestyle=DASHES[packing])
            (lab.front if name == "front" else lab.front_speed)(ax, angle)
    for ax in axes[1:, 0]:
        ax.set_ylim(-0.2, 2.0)
    head(axes[2, 0], r"front at $h_\mathrm{c}$ = 5 mm")
    against_time([axes[2, 0]])
    return finish(figure, list(axes.flat), 2)


@picture
def fig10(r: Results, lab: Laboratory) -> Figure:
    """Volume fraction, dilatancy and friction at 0 degrees.

    At 0 degrees: (a), (b) volume fraction, (c), (d) tangent of the dilatancy angle, (e), (f) effective friction, at
    0.06 s (left) and 0.36 s (right), for dense, loose and incompressible masses; the insets show the inertial
    number (logarithmic) and the thickness. No walls; drawn where h_c > 1 mm.
    """
    figure, axes = _dilatancy_and_friction(r, 0, (0.06, 0.36))
    for ax, t in zip(axes[2], (0.06, 0.36), strict=True):
        for place, name in (((0.12, 0.6, 0.32, 0.33), "I"), ((0.56, 0.6, 0.32, 0.33), "h")):
            inset = ax.inset_axes(place)
            profiles(inset, {packing: at(collapse(r, 0, packing), t) for packing in PACKINGS}, name)
            inset.set_ylabel("")
            inset.set_title({"I": "$I$ (-)", "h": "$h$ (cm)"}[name], fontsize=6.5, pad=2)
            inset.tick_params(labelsize=6)
            if name == "I":
                inset.set_yscale("log")
                inset.set_ylim(1e-4, 1e2)
        low, high = ax.get_ylim()
        ax.set_ylim(low, high + 0.85 * (high - low))
    return finish(figure, list(axes.flat))


def _dilatancy_and_friction(r: Results, angle: float, instants: tuple[float, float]) -> tuple[Figure, np.ndarray]:
    figure, axes = sheet(3, 2, 2.0, sharex="col")
    for row, name in zip(axes, ("phi", "tan_psi", "mu"), strict=True):
        for ax, t in zip(row, instants, strict=True):
            three(ax, r, angle, t, name)
    along(axes)
    return figure, axes


def _dilatancy_at(r: Results, angle: float, instants: tuple[float, ...], span: tuple[float, float]) -> Figure:
    figure, axes = sheet(-(-len(instants) // 2), 2, 1.75)
    for ax, t in zip(axes.flat, instants, strict=True):
        three(ax, r, angle, t, "psi")
        ax.set_ylim(*span)
    along(axes)
    return finish(figure, list(axes.flat))


@picture
def fig11(r: Results, lab: Laboratory) -> Figure:
    """Dilatancy angle at 0 degrees.

    Dilatancy angle at 0 degrees, zoomed, at 0.06, 0.24, 0.36 and 0.42 s; no walls. The paper names 0.24 s; the
    others are ours. Drawn where h_c > 1 mm; (d) goes on to -19 degrees at the front.
    """
    return _dilatancy_at(r, 0, (0.06, 0.24, 0.36, 0.42), (-10.0, 5.0))


@picture
def fig12(r: Results, lab: Laboratory) -> Figure:
    """Volume fraction, dilatancy and friction at 22 degrees.

    At 22 degrees: (a), (b) volume fraction, (c), (d) tangent of the dilatancy angle, (e), (f) effective friction,
    at 0.48 s (left) and 1.38 s (right; the paper does not give the instants). No walls; drawn where h_c > 1 mm.
    """
    figure, axes = _dilatancy_and_friction(r, 22, (0.48, 1.38))
    return finish(figure, list(axes.flat))


@picture
def fig13(r: Results, lab: Laboratory) -> Figure:
    """Dilatancy angle at 22 degrees.

    Dilatancy angle at 22 degrees, zoomed, from the first instants to shortly before rest; no walls. The paper does
    not give the instants. Drawn where h_c > 1 mm.
    """
    return _dilatancy_at(r, 22, (0.06, 0.24, 0.48, 0.90, 1.20, 1.38), (-1.2, 1.2))


@picture
def fig14(r: Results, lab: Laboratory) -> Figure:
    """Volume change at the four slopes.

    Change of the volume of the mass (h_c > 1 mm) over its initial volume at the four slopes, dense (full lines) and
    loose (dashed), K = 4.09, no walls.
    """
    figure, axes = sheet(1, 1, 2.8)
    for angle, colour in zip(ANGLES, shades(4)[::-1], strict=True):
        for packing in TWO:
            one, label = collapse(r, angle, packing), f"{angle:g}°, {packing}"
            draw_series(axes[0, 0], one, "volume_change", label, color=colour, linestyle=DASHES[packing])
        lab.volume(axes[0, 0], angle)
    axes[0, 0].axhline(0.0, **THIN)
    against_time([axes[0, 0]])
    return finish(figure, [axes[0, 0]], 2)


def draw_forces(ax: Axes, one: xr.Dataset, t: float, names: tuple[str, ...] = tuple(FORCES), **style: Any) -> None:
    """Forces of one run at one instant, over the mass."""
    shot, found = at(one, t), at(forces(one), t)
    for name in names:
        colour, label = FORCES[name]
        ax.plot(shot["x"], np.where(mass(shot), found[name], np.nan), color=colour, label=label, **style)
    ax.axhline(0.0, **THIN)
    ax.set_ylabel("force / (density area) (m²/s²)")


@picture
def fig15(r: Results, lab: Laboratory) -> Figure:
    """Forces.

    Forces of the momentum equation per unit area and grain density, K = 4.09, no walls: at 0 degrees (a) at 0.06 s
    and (b) at 0.36 s, at 22 degrees (c) at 0.06 s and (d) at 1.38 s (the paper does not give the instants). Full
    lines dense, dotted lines loose.
    """
    figure, axes = sheet(2, 2)
    for ax, (angle, t) in zip(axes.flat, ((0, 0.06), (0, 0.36), (22, 0.06), (22, 1.38)), strict=True):
        for packing, line in (("dense", "-"), ("loose", ":")):
            draw_forces(ax, collapse(r, angle, packing, source="forces"), t, linestyle=line)
        head(ax, f"{angle}°, $t$ = {t:g} s")
    along(axes)
    return finish(figure, list(axes.flat), 5)


PICTURES = (fig05, fig06, fig07, fig08, fig09, fig10, fig11, fig12, fig13, fig14, fig15)
