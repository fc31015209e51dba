"""Panels that several figures of the paper share: profiles along the slope, and series against time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from warpgran.analysis.fields import number
from warpgran.figures.style import FRONT_LABEL, THIN, TIME_LABEL, WIDTH, letter
from warpgran.paper.measures import field, mass

X_LABEL = "position along the slope $x$ (m)"
LABELS = {
    "h": "thickness $h$ (cm)",
    "v": "velocity $v$ (m/s)",
    "phi": r"volume fraction $\varphi$ (-)",
    "psi": r"dilatancy angle $\psi$ (°)",
    "tan_psi": r"$\tan\psi$ (-)",
    "mu": r"effective friction $\mu$ (-)",
    "I": "inertial number $I$ (-)",
    "front": FRONT_LABEL,
    "front_speed": r"front velocity $\dot{x}_\mathrm{f}$ (m/s)",
    "volume_change": r"volume change $\Delta V/V_0$ (%)",
}
FACTORS = {"h": 100.0, "volume_change": 100.0}

Style = dict[str, Any]
DENSE: Style = {"color": "#c0392b", "linestyle": "-"}
LOOSE: Style = {"color": "#1f5fa8", "linestyle": (0, (5, 1.6))}
NEITHER: Style = {"color": "black", "linestyle": (0, (1, 1.2))}
STYLES = {"dense": DENSE, "loose": LOOSE, "incompressible": NEITHER}
DASHES: dict[str, Any] = {"dense": "-", "loose": (0, (4, 1.8))}


def shades(count: int) -> list[Any]:
    """Colours of values in order, dark to light."""
    return list(colormaps["viridis"](np.linspace(0.0, 0.82, count)))


def sheet(rows: int, columns: int, height: float = 2.1, **share: Any) -> tuple[Figure, np.ndarray]:
    """A page with rows of panels, each so high [inches], and room for a legend on top."""
    figure = Figure(figsize=(WIDTH if columns > 1 else 0.62 * WIDTH, 0.55 + height * rows), layout="constrained")
    return figure, figure.subplots(rows, columns, squeeze=False, **share)


def finish(figure: Figure, axes: Sequence[Axes], names: int = 4, of: Sequence[Axes] | None = None) -> Figure:
    """Letter the panels in this order, and put one legend above them, of all or of some."""
    letter(axes)
    found: dict[str, Any] = {}
    for ax in axes if of is None else of:
        for handle, label in zip(*ax.get_legend_handles_labels(), strict=True):
            found.setdefault(label, handle)
    figure.legend(list(found.values()), list(found), loc="outside upper center", ncols=min(names, len(found)))
    return figure


def values(shot: xr.Dataset, name: str, whole: bool = False) -> np.ndarray:
    """A field in the unit of its label; NaN outside the mass. Thickness is shown where h itself is over h_front."""
    thick = mass(shot)
    if name == "h":
        thick = shot["h"].values > number(shot, "scheme.h_front")
        thick = thick | np.roll(thick, 1)  # so that the line ends
    found = np.tan(np.deg2rad(field(shot, "psi"))) if name == "tan_psi" else field(shot, name)
    return np.where(thick | whole, FACTORS.get(name, 1.0) * found, np.nan)


def draw_profile(ax: Axes, shot: xr.Dataset, name: str, label: str | None = None, **style: Any) -> None:
    """A field of one snapshot over the mass."""
    ax.plot(shot["x"], values(shot, name), label=label, **style)
    ax.set_ylabel(LABELS[name])


def draw_series(ax: Axes, one: xr.Dataset, name: str, label: str | None = None, **style: Any) -> None:
    """A series of one run against time."""
    ax.plot(one["series_time"], FACTORS.get(name, 1.0) * one[name].values, label=label, **style)
    ax.set_ylabel(LABELS[name])


def profiles(ax: Axes, shots: Mapping[str, xr.Dataset], name: str) -> None:
    """One field of the packings at one instant."""
    for label, shot in shots.items():
        draw_profile(ax, shot, name, label, **STYLES[label])
    if name in ("psi", "tan_psi"):
        ax.axhline(0.0, **THIN)
    if name == "h":
        ax.set_ylim(bottom=0.0)


def head(ax: Axes, title: str) -> None:
    """What a panel shows, beside its letter."""
    ax.set_title(title, fontsize=8, pad=3)


def along(axes: np.ndarray) -> None:
    """Name the axes of position under the last row."""
    for ax in axes[-1]:
        ax.set_xlabel(X_LABEL)


def against_time(axes: Sequence[Axes]) -> None:
    """Name the axes of time."""
    for ax in axes:
        ax.set_xlabel(TIME_LABEL)
        ax.set_xlim(left=0.0)
