"""The figure of one run: its profiles and series on one page.

SI units but for thicknesses (cm), volume changes (%) and angles (degrees). Values that are NaN are left out. Velocity,
volume fraction and dilatancy angle are drawn only where the compacted thickness exceeds h_front: thinner material is no
continuum.
"""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from warpgran.analysis.fields import derive, number
from warpgran.analysis.front import thick
from warpgran.errors import ResultError
from warpgran.figures.heading import run_heading
from warpgran.figures.selection import computed_snapshots, one_run, wet_range
from warpgran.figures.style import FRONT_LABEL, THIN, TIME_LABEL, WIDTH, Panel, hold_open, legend, letter, small_print

MAX_INSTANTS = 8  # more lines than this cannot be told apart
HEIGHT = 205 / 25.4  # inches

PROFILES = (
    Panel("h", "thickness $h$ (cm)", factor=100.0, span=1.0),
    Panel("v", "velocity $v$ (m/s)", span=0.01, thin=False),
    Panel("phi", r"volume fraction $\varphi$ (-)", span=0.02, thin=False, reference="rheology.phi_stat"),
    Panel("psi", r"dilatancy angle $\psi$ (°)", span=1.0, thin=False, reference=0.0),
)
SERIES = (
    Panel("front", FRONT_LABEL, span=0.01),
    Panel("h_max", r"max. thickness $h_\mathrm{max}$ (cm)", factor=100.0, span=1.0),
    Panel("v_flow", r"speed $|v|$, $\dot{x}_\mathrm{f}$ (m/s)"),
    Panel("volume_change", r"volume change $\Delta V/V_0$ (%)", factor=100.0, span=1.0, reference=0.0),
)


def draw_run(data: xr.Dataset, run: int) -> Figure:
    """The page of one run: profiles on the left, series on the right, either alone if the other has nothing to show.

    Raises:
        ResultError: no such run, or one without a single value to draw.
    """
    one = one_run(data, run)
    snapshots = computed_snapshots(one)
    sampled = np.isfinite(one["h_max"].values).any()
    columns = [draw for draw, there in ((_draw_profiles, snapshots.sizes["time"]), (_draw_series, sampled)) if there]
    if not columns:
        raise ResultError(
            f"run {one.attrs['run']} has nothing to draw: it holds no snapshot and no sample of the series"
        )
    figure = Figure(figsize=(WIDTH, HEIGHT))
    axes = figure.subplots(4, len(columns), sharex="col", squeeze=False)
    title = run_heading(one)
    top = 1 - (0.25 + 0.18 * (1 + title.count("\n"))) / HEIGHT
    figure.subplots_adjust(left=0.085, right=0.975, bottom=0.135, top=top, hspace=0.18, wspace=0.24)
    for column, draw in zip(axes.T, columns, strict=True):
        draw(snapshots if draw is _draw_profiles else one, list(column))
    letter(list(axes.T.flat))
    for ax in axes.flat:
        ax.locator_params(axis="x", nbins=7)
    figure.align_ylabels(axes)
    figure.suptitle(title, fontsize=9, y=0.99, linespacing=1.4)
    return figure


def _caption(one: xr.Dataset, drawn: int, held: int) -> str:
    """The small print under the profiles."""
    h_front = 1000.0 * number(one, "scheme.h_front")
    caption = rf"$v$, $\varphi$ and $\psi$ are drawn only where $\varphi h/\varphi_\mathrm{{stat}}$ > {h_front:.3g} mm."
    return caption + (f" {drawn} of the {held} snapshots are shown." if drawn < held else "")


def _draw_profiles(one: xr.Dataset, axes: list[Axes]) -> None:
    """Thickness, velocity, volume fraction and dilatancy angle along x, a colour for each instant."""
    held = one.sizes["time"]
    instants = np.unique(np.linspace(0, held - 1, min(held, MAX_INSTANTS)).round().astype(int))
    one = one.isel(cell=wet_range(one), time=instants)
    one = one.assign(derive(one, "psi"))
    shown = thick(one).values
    colours = colormaps["viridis"](np.linspace(0.0, 0.87, instants.size))
    for ax, panel in zip(axes, PROFILES, strict=True):
        values = np.where(shown | panel.thin, panel.factor * one[panel.name].values, np.nan)
        for profile, time, colour in zip(values, one["time"].values, colours, strict=True):
            ax.plot(one["x"], profile, color=colour, label=f"$t$ = {time:g} s")
        _finish(ax, panel, one)
    bed = 100.0 * one["bed"].values
    if np.ptp(bed) > 0:
        axes[0].plot(one["x"], bed, **THIN, label="bed $b$")
        axes[0].set_ylabel("thickness $h$, bed $b$ (cm)")
    axes[0].set_ylim(bottom=min(0.0, 1.05 * bed.min()))
    axes[-1].set_xlim(*one["x"].values[[0, -1]])
    axes[-1].set_xlabel("position along the slope $x$ (m)")
    legend(axes, 4)
    small_print(axes[-1], _caption(one, instants.size, held))


def _draw_series(one: xr.Dataset, axes: list[Axes]) -> None:
    """Front, thickness, speeds and volume change against time."""
    time = one["series_time"].values
    marker = "." if np.isfinite(one["h_max"].values).sum() == 1 else None
    for ax, panel in zip(axes, SERIES, strict=True):
        ax.plot(time, panel.factor * one[panel.name].values, color="black", marker=marker)
        _finish(ax, panel, one)
        if panel.name == "v_flow":
            _draw_speeds(one, ax, marker)
    stop_time = float(one["stop_time"].item())
    for ax in axes if np.isfinite(stop_time) else []:
        ax.axvline(stop_time, color="tab:red", linestyle=":", label=f"at rest, $t$ = {stop_time:.3g} s")
    axes[-1].set_xlabel(TIME_LABEL)
    if time.size > 1:
        axes[-1].set_xlim(time[0], time[-1])
    legend(axes, 2)


def _draw_speeds(one: xr.Dataset, ax: Axes, marker: str | None) -> None:
    """Add the speed of the front and the speed that counts as rest; logarithmic if anything ever moves."""
    rest_speed = number(one, "time.rest_speed")
    ax.lines[0].set_label(r"$|v|$, maximum")
    ax.plot(one["series_time"], one["front_speed"], color="tab:blue", linestyle="--", marker=marker)
    ax.lines[1].set_label(r"$\dot{x}_\mathrm{f}$, front")
    ax.axhline(rest_speed, **THIN, linestyle="-.", label=f"rest: $|v|$ < {1000 * rest_speed:.3g} mm/s")
    fastest = np.nanmax([line.get_ydata() for line in ax.lines[:2]])
    if fastest > rest_speed:
        ax.set_yscale("log")
        ax.set_ylim(rest_speed / 3, 2 * fastest)


def _finish(ax: Axes, panel: Panel, one: xr.Dataset) -> None:
    """Label the axis, draw its reference line and hold it open to its least span."""
    ax.set_ylabel(panel.label)
    if isinstance(panel.reference, str):
        ax.axhline(number(one, panel.reference), **THIN, linestyle="--", label=r"$\varphi_\mathrm{stat}$")
    elif panel.reference is not None:
        ax.axhline(panel.reference, **THIN)
    hold_open(ax, panel.span)
