"""Figs. 2 and 3 of the paper: the forms of the equilibrium volume fraction, and the numerical viscosity."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from warpgran.analysis.fields import derive, number
from warpgran.figures.style import THIN
from warpgran.paper.laboratory import Laboratory
from warpgran.paper.measures import front_of
from warpgran.paper.panels import LABELS, STYLES, X_LABEL, Style, along, draw_profile, finish, head, shades, sheet
from warpgran.paper.picture import picture
from warpgran.paper.results import Results, at, collapse
from warpgran.physics.laws import PHI_EQ

FORMS = {
    "(f0)": ("f0", 1.0),
    "(f1)": ("f1", 1.0),
    "(f2), N = 5": ("f2", 5.0),
    "(f2), N = 2": ("f2", 2.0),
    "(f2), N = 1": ("f2", 1.0),
}
DASHES = ["-", (0, (6, 1.5)), (0, (3, 1.5)), (0, (1, 1.2)), "-"]
FORM_STYLES: dict[str, Style] = {
    name: {"color": colour, "linestyle": dash}
    for name, colour, dash in zip(FORMS, [*shades(5)[:4], STYLES["dense"]["color"]], DASHES, strict=True)
}


@picture
def fig02(r: Results, lab: Laboratory) -> Figure:
    """Forms of the equilibrium volume fraction.

    Forms of the equilibrium volume fraction, dense packing, K = 4.09, no walls. (a) phi_eq by (2.9) and by the
    forms (f0), (f1), (f2), near the front at 22 degrees and 1.38 s; (b) the inertial number there; (c), (d) the
    thickness near the front computed with each form, at 0 degrees (0.36 s; the paper gives no instant) and at 22
    degrees (1.38 s).
    """
    figure, axes = sheet(2, 2)
    shot = at(r.run("regularization", angle=22, phi_eq="f2", phi_eq_N=1.0), 1.38)
    end = front_of(shot)
    shot = shot.isel(x=np.flatnonzero((shot["x"].values > end - 0.04) & (shot["x"].values < end)))
    I, stat, slope = derive(shot, "I")["I"].values, number(shot, "rheology.phi_stat"), number(shot, "rheology.K_tilde")
    axes[0, 0].plot(shot["x"], stat - slope * I, "o", color="black", markersize=2, label="(2.9)")
    for name, (law, N) in FORMS.items():
        axes[0, 0].plot(shot["x"], PHI_EQ[law](I, slope, stat, N), label=name, **FORM_STYLES[name])
    axes[0, 0].axhline(0.0, **THIN)
    axes[0, 0].set_ylabel(r"$\varphi_\mathrm{eq}$ (-)")
    axes[0, 1].plot(shot["x"], I, color="black")
    axes[0, 1].set_ylabel(LABELS["I"])
    for ax, angle, t in ((axes[1, 0], 0, 0.36), (axes[1, 1], 22, 1.38)):
        _near_front(ax, r, angle, t)
    for ax in axes.flat:
        ax.set_xlabel(X_LABEL)
    return finish(figure, list(axes.flat), 6)


def _near_front(ax: Axes, r: Results, angle: float, t: float) -> None:
    shots = {
        name: at(r.run("regularization", angle=angle, phi_eq=law, phi_eq_N=N), t) for name, (law, N) in FORMS.items()
    }
    for name, shot in shots.items():
        ax.plot(shot["x"], 100 * shot["h"], **FORM_STYLES[name])
    end = front_of(shots["(f2), N = 1"])
    ax.set_xlim(end - 0.05, end + 0.03)
    ax.set_ylim(0.0, 0.8)
    ax.set_ylabel(LABELS["h"])
    head(ax, f"{angle:g}°, $t$ = {t:g} s")


@picture
def fig03(r: Results, lab: Laboratory) -> Figure:
    """Numerical viscosity.

    Numerical viscosity: the thickness of the dense mass with it and without, K = 4.09, no walls, at 0 degrees (0.36
    s) and 22 degrees (1.38 s); the insets show the front. The paper gives no instants.
    """
    figure, axes = sheet(1, 2, 2.5)
    for ax, angle, t in zip(axes.flat, (0, 22), (0.36, 1.38), strict=True):
        inset = ax.inset_axes((0.5, 0.53, 0.47, 0.43))
        shots = {"with": at(collapse(r, angle, "dense"), t), "without": at(r.run("no_viscosity", angle=angle), t)}
        for (name, shot), style in zip(shots.items(), (STYLES["dense"], STYLES["incompressible"]), strict=True):
            draw_profile(ax, shot, "h", f"{name} viscosity", **style)
            inset.plot(shot["x"], 1000 * shot["h"], **style)
        ends = [front_of(shot) for shot in shots.values()]
        inset.set_xlim(min(ends) - 0.02, max(ends) + 0.03)
        inset.locator_params(nbins=4)
        inset.set_ylim(0.0, 4.0)
        inset.set_ylabel("$h$ (mm)", fontsize=7, labelpad=1)
        inset.tick_params(labelsize=6.5)
        ax.set_ylim(0.0, 1.15 * ax.get_ylim()[1])
        head(ax, f"{angle}°, $t$ = {t:g} s")
    along(axes)
    return finish(figure, list(axes.flat))


PICTURES = (fig02, fig03)
