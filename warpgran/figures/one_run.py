"""The figure of one run: its profiles and series on one page.

SI units but for lengths (by their size, `analysis.units`), volume changes (%) and angles (degrees). Values that are NaN
are left out. Velocity, volume fraction and dilatancy angle are drawn only where the compacted thickness exceeds
h_front: thinner material is no continuum. A bed that is not flat has a panel of its own across the page, where the mass
lies on it, since a bed can be higher than the mass by orders.
"""

from __future__ import annotations

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes

from warpgran.analysis.derived import dilatancy_angle, thick
from warpgran.analysis.run_columns import RunColumns
from warpgran.analysis.units import Lengths, unit_of
from warpgran.arrays import Array
from warpgran.errors import ResultError
from warpgran.figures.heading import run_heading
from warpgran.figures.selection import OneRun, computed_snapshots, one_run, wet_range
from warpgran.figures.style import (
    FRONT,
    THIN,
    TIME_LABEL,
    WIDTH,
    Panel,
    Sheet,
    hold_open,
    legend,
    letter,
    place_labels,
    small_print,
)

MAX_INSTANTS = 8  # more lines than this cannot be told apart
HEIGHT = 205 / 25.4  # inches, without a bed
BED_HEIGHT, BED_GAP = 1.2, 0.45  # of the panel of the bed, inches

PROFILES = (
    Panel("h", "thickness $h$", "thick", span=0.07),
    Panel("v", "velocity $v$", "m/s", thin=False),
    Panel("phi", r"volume fraction $\varphi$", "-", span=0.02, thin=False, reference="rheology.phi_stat"),
    Panel("psi", r"dilatancy angle $\psi$", "°", span=1.0, thin=False, reference=0.0),
)
SERIES = (
    Panel("front", FRONT, "along", span=0.02),
    Panel("h_max", r"max. thickness $h_\mathrm{max}$", "thick", span=0.07),
    Panel("v_flow", r"speed $|v|$, $\dot{x}_\mathrm{f}$", "m/s"),
    Panel("volume_change", r"volume change $\Delta V/V_0$", "%", factor=100.0, span=1.0, reference=0.0),
)
POSITION = Panel("x", "position along the slope $x$", "along")


def draw_run(data: RunColumns, run: int) -> Sheet:
    """The page of one run: profiles on the left, series on the right, either alone if the other has nothing to show.

    Raises:
        ResultError: no such run, or one without a single value to draw.
    """
    one = one_run(data, run)
    snapshots = computed_snapshots(one)
    sampled = np.isfinite(one.series("h_max")).any()
    columns = [draw for draw, there in ((_draw_profiles, snapshots.time.size), (_draw_series, sampled)) if there]
    if not columns:
        raise ResultError(f"run {run} has nothing to draw: it holds no snapshot and no sample of the series")
    lengths = Lengths.of(data)
    on_bed = bool(snapshots.time.size) and np.ptp(one.bed) > 0.0
    title = run_heading(one)
    head = 0.25 + 0.18 * (1 + title.count("\n"))
    above = head + (BED_HEIGHT + BED_GAP if on_bed else 0.0)
    height = HEIGHT + above - head
    figure = Sheet(figsize=(WIDTH, height))
    axes = figure.subplots(4, len(columns), sharex="col", squeeze=False)
    place = {"left": 0.085, "right": 0.975}
    figure.subplots_adjust(**place, bottom=1.09 / height, top=1 - above / height, hspace=0.18, wspace=0.24)
    for column, draw in zip(axes.T, columns, strict=True):
        draw(snapshots if draw is _draw_profiles else one, list(column), lengths)
    ordered = list(axes.T.flat)
    if on_bed:
        bottom = 1 - (head + BED_HEIGHT) / height
        ordered.insert(0, figure.add_axes((place["left"], bottom, place["right"] - place["left"], BED_HEIGHT / height)))
        _draw_on_bed(_shown_instants(snapshots), ordered[0], lengths)
    letter(ordered)
    for ax in axes.flat:
        ax.locator_params(axis="x", nbins=7)
    place_labels(ordered)
    figure.suptitle(title, fontsize=9, y=1 - 0.08 / height, linespacing=1.4)
    return figure


def _caption(one: OneRun, drawn: int, held: int) -> str:
    """The small print under the profiles."""
    h_front = one.parameter("scheme.h_front")
    least = unit_of(h_front).text(h_front)
    caption = rf"$v$, $\varphi$ and $\psi$ are drawn only where $\varphi h/\varphi_\mathrm{{stat}}$ > {least}."
    return caption + (f" {drawn} of the {held} snapshots are shown." if drawn < held else "")


def _shown_instants(one: OneRun) -> OneRun:
    """The snapshots that are drawn, and the cells that the mass covers."""
    held = one.time.size
    instants = np.unique(np.linspace(0, held - 1, min(held, MAX_INSTANTS)).round().astype(int))
    return one.at(instants, wet_range(one))


def _tints(instants: int) -> Array:
    """A colour for each instant, from dark to light."""
    return np.asarray(colormaps["viridis"](np.linspace(0.0, 0.87, instants)))


def _draw_on_bed(one: OneRun, ax: Axes, lengths: Lengths) -> None:
    """The free surface on the bed, at the instants of the profiles."""
    bed, h = one.bed, np.where(thick(one), one.h, np.nan)
    along, up = unit_of(lengths.along), unit_of(max(float(np.ptp(bed)), lengths.thick))
    x = along.factor * one.x
    for surface, colour in zip(up.factor * (bed + h), _tints(one.time.size), strict=True):
        ax.plot(x, surface, color=colour)
    ax.plot(x, up.factor * bed, color="0.3", linewidth=0.8, zorder=3)
    low, high = ax.get_ylim()
    ax.fill_between(x, up.factor * bed, low, color="0.88", linewidth=0.0, zorder=2.5)
    ax.set(xlim=x[[0, -1]], ylim=(low, high), ylabel=f"bed $b$, $b + h$ ({up.name})")


def _draw_profiles(one: OneRun, axes: list[Axes], lengths: Lengths) -> None:
    """Thickness, velocity, volume fraction and dilatancy angle along x, a colour for each instant."""
    held = one.time.size
    one = _shown_instants(one)
    fields = {"h": one.h, "v": one.v, "phi": one.phi, "psi": dilatancy_angle(one)}
    shown = thick(one)
    position = POSITION.of(lengths)
    x = position.factor * one.x
    for ax, panel in zip(axes, (panel.of(lengths) for panel in PROFILES), strict=True):
        values = np.where(shown | panel.thin, panel.factor * fields[panel.name], np.nan)
        for profile, time, colour in zip(values, one.time, _tints(one.time.size), strict=True):
            ax.plot(x, profile, color=colour, label=f"$t$ = {time:.4g} s")
        _finish(ax, panel, one)
    hold_open(axes[1], 10.0 * one.parameter("time.rest_speed"))
    axes[0].set_ylim(bottom=0.0)
    axes[-1].set_xlim(*x[[0, -1]])
    axes[-1].set_xlabel(position.label)
    longest = max(len(f"{time:.4g}") for time in one.time.tolist())
    legend(axes, 4 if longest <= 4 else 3)  # three rows of either have room for all
    small_print(axes[-1], _caption(one, one.time.size, held))


def _draw_series(one: OneRun, axes: list[Axes], lengths: Lengths) -> None:
    """Front, thickness, speeds and volume change against time."""
    time = one.columns.series_time
    marker = "." if np.isfinite(one.series("h_max")).sum() == 1 else None
    for ax, panel in zip(axes, (panel.of(lengths) for panel in SERIES), strict=True):
        ax.plot(time, panel.factor * one.series(panel.name), color="black", marker=marker)
        _finish(ax, panel, one)
        if panel.name == "v_flow":
            _draw_speeds(one, ax, marker)
    stop_time = float(one.columns.values["stop_time"].item())
    for ax in axes if np.isfinite(stop_time) else []:
        ax.axvline(stop_time, color="tab:red", linestyle=":", label=f"at rest, $t$ = {stop_time:.3g} s")
    axes[-1].set_xlabel(TIME_LABEL)
    if time.size > 1:
        axes[-1].set_xlim(time[0], time[-1])
    legend(axes, 2)


def _draw_speeds(one: OneRun, ax: Axes, marker: str | None) -> None:
    """Add the speed of the front and the speed that counts as rest; logarithmic if anything ever moves."""
    rest_speed = one.parameter("time.rest_speed")
    ax.lines[0].set_label(r"$|v|$, maximum")
    ax.plot(one.columns.series_time, one.series("front_speed"), color="tab:blue", linestyle="--", marker=marker)
    ax.lines[1].set_label(r"$\dot{x}_\mathrm{f}$, front")
    ax.axhline(rest_speed, **THIN, linestyle="-.", label=f"rest: $|v|$ < {1000 * rest_speed:.3g} mm/s")
    fastest = np.nanmax([line.get_ydata() for line in ax.lines[:2]])
    if fastest > rest_speed:
        ax.set_yscale("log")
        ax.set_ylim(rest_speed / 3, 2 * fastest)


def _finish(ax: Axes, panel: Panel, one: OneRun) -> None:
    """Label the axis, draw its reference line and hold it open to its least span."""
    ax.set_ylabel(panel.label)
    if isinstance(panel.reference, str):
        ax.axhline(one.parameter(panel.reference), **THIN, linestyle="--", label=r"$\varphi_\mathrm{stat}$")
    elif panel.reference is not None:
        ax.axhline(panel.reference, **THIN)
    hold_open(ax, panel.span)
