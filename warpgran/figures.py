"""Figures of a result: its profiles and series on one page, and the collapse on its slope as an animation.

The figures take one run of the Dataset that `simulate` and `open_dataset` return, and draw in SI units but for
thicknesses (cm), volume changes (%) and angles (degrees). What the run did not compute (NaN) is left out. Where the
material is thinner than `scheme.h_front`, its velocity, volume fraction and dilatancy angle mean nothing and are not
drawn. Nothing here touches pyplot, so that no window opens and no figure stays in memory.
"""

from __future__ import annotations

import textwrap
import tomllib
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import colormaps, rc_context
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, PillowWriter
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from warpgran.derived import derive, parameter

FloatArray = np.ndarray[Any, np.dtype[np.float64]]

PLOT_SUFFIXES = (".png", ".pdf", ".svg")
ANIMATION_SUFFIXES = (".gif", ".mp4")
MAX_INSTANTS = 8  # more lines than this cannot be told apart
PAGE = (180 / 25.4, 205 / 25.4)  # inches
STYLE: Any = {
    "font.family": "sans-serif",
    "font.size": 8,
    "axes.labelsize": 8,
    "axes.linewidth": 0.6,
    "axes.formatter.useoffset": False,
    "xtick.labelsize": 7.5,
    "ytick.labelsize": 7.5,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "legend.fontsize": 7.5,
    "legend.frameon": False,
    "legend.handlelength": 1.8,
    "legend.columnspacing": 1.2,
    "lines.linewidth": 1.1,
    "svg.fonttype": "none",
    "pdf.fonttype": 42,
}
THIN: dict[str, Any] = {"color": "0.45", "linewidth": 0.7, "zorder": 1}


@dataclass(frozen=True)
class Panel:
    """One panel: what it draws, against x or against time.

    Attributes:
        name: variable of the result.
        label: quantity, symbol and unit.
        factor: from SI units to those of the label.
        span: least extent of the axis, in the unit of the label, so that rounding is not shown as a signal.
        thin: whether it is drawn where the material is thinner than `scheme.h_front`.
        reference: level of a thin reference line, a number or the dotted key of a parameter.
    """

    name: str
    label: str
    factor: float = 1.0
    span: float = 0.0
    thin: bool = True
    reference: float | str | None = None


PROFILES = (
    Panel("h", "thickness $h$ (cm)", factor=100.0, span=1.0),
    Panel("v", "velocity $v$ (m/s)", span=0.01, thin=False),
    Panel("phi", r"volume fraction $\varphi$ (-)", span=0.02, thin=False, reference="rheology.phi_stat"),
    Panel("psi", r"dilatancy angle $\psi$ (°)", span=1.0, thin=False, reference=0.0),
)
SERIES = (
    Panel("front", r"front position $x_\mathrm{f}$ (m)", span=0.01),
    Panel("h_max", r"max. thickness $h_\mathrm{max}$ (cm)", factor=100.0, span=1.0),
    Panel("v_flow", r"speed $|v|$, $\dot{x}_\mathrm{f}$ (m/s)"),
    Panel("volume_change", r"volume change $\Delta V/V_0$ (%)", factor=100.0, span=1.0, reference=0.0),
)


def plot(data: xr.Dataset, path: str | Path, *, run: int = 0) -> Path:
    """Draw the profiles and the series of one run on one page, 180 mm wide.

    Args:
        data: a result, see the page on the result file.
        path: the picture to write: .png (200 dpi), .pdf or .svg.
        run: which run of the result.

    Returns:
        The path of the picture.

    Raises:
        ValueError: another suffix, no such run, or a run without a single value to draw.
    """
    path = _checked(path, PLOT_SUFFIXES)
    with rc_context(STYLE), _written_whole(path) as part:
        _page(_one_run(data, run)).savefig(part, dpi=200)
    return path


def animate(data: xr.Dataset, path: str | Path, *, run: int = 0, fps: int = 12, dpi: float = 110) -> Path:
    """Animate the collapse of one run on its slope, one frame a snapshot, coloured by volume fraction.

    Args:
        data: a result with two snapshots or more.
        path: the animation to write: .gif, or .mp4 where ffmpeg is installed.
        run: which run of the result.
        fps: frames a second.
        dpi: pixels an inch; a frame is about 8 inches wide.

    Returns:
        The path of the animation.

    Raises:
        ValueError: another suffix, .mp4 without ffmpeg, no such run, or fewer than two snapshots.
    """
    path = _checked(path, ANIMATION_SUFFIXES)
    writer = _movie_writer(path.suffix.lower(), fps)
    one = _computed_snapshots(_one_run(data, run))
    if one.sizes["time"] < 2:
        raise ValueError(
            f"an animation needs two snapshots or more, run {run} has {one.sizes['time']}: "
            "set `time.snapshots = { every = 0.02 }` in the run file and run it again"
        )
    with rc_context(STYLE), _written_whole(path) as part:
        scene = Scene(one, dpi)
        with writer.saving(scene.figure, str(part), dpi):
            for instant in range(one.sizes["time"]):
                scene.show(instant)
                writer.grab_frame()
    return path


def _checked(path: str | Path, suffixes: tuple[str, ...]) -> Path:
    """The path, if its suffix is one of these."""
    path = Path(path)
    if path.suffix.lower() not in suffixes:
        raise ValueError(f"cannot write {path.name!r}: the name must end in {', '.join(suffixes)}")
    return path


@contextmanager
def _written_whole(path: Path) -> Iterator[Path]:
    """A name beside `path` to write to; it takes the place of `path` at the end, and is removed after an error."""
    part = path.with_name(f".{path.stem}.{uuid.uuid4().hex[:8]}{path.suffix.lower()}")
    try:
        yield part
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)


def _one_run(data: xr.Dataset, run: int) -> xr.Dataset:
    """One run, without the cells that only pad its grid."""
    runs = data.sizes["run"]
    if not 0 <= run < runs:
        raise ValueError(f"there is no run {run}: the result holds {runs}, counted from 0")
    one = data.isel(run=run).assign_attrs(run=run, runs=runs)
    return one.isel(cell=np.flatnonzero(np.isfinite(one["x"].values)))


def _computed_snapshots(one: xr.Dataset) -> xr.Dataset:
    """Only the snapshots that the run reached."""
    return one.isel(time=np.flatnonzero(np.isfinite(one["h"].values).any(axis=-1)))


def _number(one: xr.Dataset, key: str, default: float | None = None) -> float:
    """A numeric parameter of the run."""
    return float(parameter(one, key, default).item())


def _wet_range(one: xr.Dataset) -> slice:
    """The cells between the first and the last that is ever thicker than h_front [m], and a margin of 4 %."""
    cells = np.flatnonzero((one["h"].values > _number(one, "scheme.h_front", 1e-3)).any(axis=0))
    if cells.size == 0:
        return slice(0, one.sizes["cell"])
    margin = max(2, round(0.04 * (cells[-1] - cells[0])))
    return slice(max(0, int(cells[0]) - margin), int(cells[-1]) + margin + 1)


def _heading(one: xr.Dataset, width: int = 125) -> str:
    """Title of the case, its main parameters, what else varies between the runs, and how the run ended."""
    title = str(tomllib.loads(one.attrs.get("case_toml", "")).get("title", ""))
    shown = {"slope.angle": (r"$\theta$", "°"), "column.phi": (r"$\varphi_0$", ""), "rheology.K": ("$K$", "")}
    facts = [f"{symbol} = ${_number(one, key):.4g}${unit}" for key, (symbol, unit) in shown.items()]
    varied = [str(name) for name in one.variables if "." in str(name) and name not in shown]
    facts += [f"{name} = {_text(one[name])}" for name in varied]
    if one.attrs["runs"] > 1:
        facts.append(f"run {one.attrs['run']} (0 to {one.attrs['runs'] - 1})")
    status = _status(one)
    if status != "ok":
        facts.append(f"ended early: {status}")
    return "\n".join([*textwrap.wrap(title, width), *textwrap.wrap(", ".join(facts), width)])


def _text(value: xr.DataArray) -> str:
    """One value of a parameter, short."""
    item = value.item()
    return f"{item:.4g}" if isinstance(item, float) else str(item)


def _status(one: xr.Dataset) -> str:
    """How the run ended, as a word, also where the file gives a number and a list of meanings."""
    status = one["status"]
    meanings = str(status.attrs.get("flag_meanings", "")).split()
    flags = np.atleast_1d(status.attrs.get("flag_values", []))
    words: dict[Any, str] = dict(zip(flags.tolist(), meanings, strict=False))
    return words.get(status.item(), str(status.item()))


def _caption(one: xr.Dataset, drawn: int, held: int) -> str:
    """The small print under the profiles."""
    h_front = 1000.0 * _number(one, "scheme.h_front", 1e-3)
    caption = rf"$v$, $\varphi$ and $\psi$ are drawn only where $h$ > {h_front:g} mm."
    return caption + (f" {drawn} of the {held} snapshots are shown." if drawn < held else "")


def _page(one: xr.Dataset) -> Figure:
    """The whole page: profiles on the left, series on the right, either alone if the other has nothing to show."""
    snapshots = _computed_snapshots(one)
    sampled = np.isfinite(one["h_max"].values).any()
    columns = [draw for draw, there in ((_draw_profiles, snapshots.sizes["time"]), (_draw_series, sampled)) if there]
    if not columns:
        raise ValueError(
            f"run {one.attrs['run']} has nothing to draw: it holds no snapshot and no sample of the series"
        )
    figure = Figure(figsize=PAGE)
    axes = figure.subplots(4, len(columns), sharex="col", squeeze=False)
    heading = _heading(one)
    top = 1 - (0.25 + 0.18 * (1 + heading.count("\n"))) / PAGE[1]
    figure.subplots_adjust(left=0.085, right=0.975, bottom=0.135, top=top, hspace=0.18, wspace=0.24)
    for column, draw in zip(axes.T, columns, strict=True):
        draw(snapshots if draw is _draw_profiles else one, list(column))
    for letter, ax in zip("abcdefgh", axes.T.flat, strict=False):
        ax.set_title(f"({letter})", loc="left", fontsize=8, pad=3)
        ax.tick_params(which="both", top=True, right=True)
        ax.locator_params(axis="x", nbins=7)
    figure.align_ylabels(axes)
    figure.suptitle(heading, fontsize=9, y=0.99, linespacing=1.4)
    return figure


def _draw_profiles(one: xr.Dataset, axes: list[Axes]) -> None:
    """Thickness, velocity, volume fraction and dilatancy angle along x, a colour for each instant."""
    held = one.sizes["time"]
    instants = np.unique(np.linspace(0, held - 1, min(held, MAX_INSTANTS)).round().astype(int))
    one = one.isel(cell=_wet_range(one), time=instants)
    one = one.assign(derive(one, "psi"))
    thick = one["h"].values > _number(one, "scheme.h_front", 1e-3)
    colours = colormaps["viridis"](np.linspace(0.0, 0.87, instants.size))
    for ax, panel in zip(axes, PROFILES, strict=True):
        values = np.where(thick | panel.thin, panel.factor * one[panel.name].values, np.nan)
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
    _legend(axes, 4)
    place: Any = ("axes fraction", "figure points")
    axes[-1].annotate(_caption(one, instants.size, held), (0, 5), xycoords=place, fontsize=7, color="0.3")


def _draw_series(one: xr.Dataset, axes: list[Axes]) -> None:
    """Front, thickness, speeds and volume change against time."""
    time = one["series_time"].values
    marker = "." if np.isfinite(one["h_max"].values).sum() == 1 else None
    for ax, panel in zip(axes, SERIES, strict=True):
        values = one[panel.name if panel.name in one else "v_max"].values  # v_flow: v_max without the thinnest flow
        ax.plot(time, panel.factor * values, color="black", marker=marker)
        _finish(ax, panel, one)
    _draw_speeds(one, axes[2], marker)
    stop_time = float(one["stop_time"].item())
    for ax in axes if np.isfinite(stop_time) else []:
        ax.axvline(stop_time, color="tab:red", linestyle=":", label=f"at rest, $t$ = {stop_time:.3g} s")
    axes[-1].set_xlabel("time $t$ (s)")
    if time.size > 1:
        axes[-1].set_xlim(time[0], time[-1])
    _legend(axes, 2)


def _draw_speeds(one: xr.Dataset, ax: Axes, marker: str | None) -> None:
    """Add the speed of the front and the speed that counts as rest; logarithmic if anything ever moves."""
    rest_speed = _number(one, "time.rest_speed", 1e-3)
    ax.lines[0].set_label(r"$|v|$, maximum")
    ax.plot(one["series_time"], one["front_speed"], color="tab:blue", linestyle="--", marker=marker)
    ax.lines[1].set_label(r"$\dot{x}_\mathrm{f}$, front")
    ax.axhline(rest_speed, **THIN, linestyle="-.", label=f"rest: $|v|$ < {1000 * rest_speed:g} mm/s")
    fastest = np.nanmax([line.get_ydata() for line in ax.lines[:2]])
    if fastest > rest_speed:
        ax.set_yscale("log")
        ax.set_ylim(rest_speed / 3, 2 * fastest)


def _finish(ax: Axes, panel: Panel, one: xr.Dataset) -> None:
    """Label the axis, draw its reference line and hold it open to its least span."""
    ax.set_ylabel(panel.label)
    if isinstance(panel.reference, str):
        ax.axhline(_number(one, panel.reference), **THIN, linestyle="--", label=r"$\varphi_\mathrm{stat}$")
    elif panel.reference is not None:
        ax.axhline(panel.reference, **THIN)
    low, high = ax.get_ylim()
    if high - low < panel.span:
        middle = (low + high) / 2
        ax.set_ylim(middle - panel.span / 2, middle + panel.span / 2)


def _legend(axes: list[Axes], columns: int) -> None:
    """One legend for a column of panels, under it."""
    found = {
        str(line.get_label()): line for ax in axes for line in ax.lines if not str(line.get_label()).startswith("_")
    }
    axes[-1].legend(found.values(), found.keys(), ncols=columns, loc="upper center", bbox_to_anchor=(0.5, -0.28))


class Scene:
    """The picture that an animation moves: slope, wall, material, colour bar, time."""

    def __init__(self, one: xr.Dataset, dpi: float) -> None:
        """Draw what stays. one: one run with its snapshots; dpi: pixels an inch."""
        self.theta = np.deg2rad(_number(one, "slope.angle"))
        self.one = one.isel(cell=_wet_range(one))
        self.edges, self.bed = _edges(self.one["x"].values), _at_edges(self.one["bed"].values)
        self.thick = self.one["h"].values > _number(one, "scheme.h_front", 1e-3)
        self.figure, self.ax = self._canvas(dpi)
        self._draw_ground(one)
        self._draw_walls(one)
        self.material = PolyCollection([], cmap="viridis", edgecolors="face", linewidths=0.5, zorder=2)
        self.ax.add_collection(self.material, autolim=False)
        self._draw_colour_bar()

    def show(self, instant: int) -> None:
        """Move the material to a snapshot."""
        thick = self.thick[instant]
        bottom, top = self._tilted(self.edges, self.bed), self._surface(instant)
        quads = np.stack([bottom[:-1], bottom[1:], top[1:], top[:-1]], axis=1)
        self.material.set_verts(list(quads[thick]))
        self.material.set_array(self.one["phi"].values[instant][thick])
        self.ax.set_title(f"$t$ = {float(self.one['time'][instant]):.3f} s", loc="left", fontsize=9)

    def _tilted(self, x: FloatArray, z: FloatArray) -> FloatArray:
        """Horizontal and vertical position [m] of what lies at x along the slope and z normal to it [m]."""
        cos, sin = np.cos(self.theta), np.sin(self.theta)
        return np.stack([x * cos + z * sin, -x * sin + z * cos], axis=-1)

    def _surface(self, instant: int) -> FloatArray:
        """The free surface at the edges of the cells [m]."""
        h = np.nan_to_num(self.one["h"].values[instant])
        return self._tilted(self.edges, self.bed + _at_edges(h))

    def _canvas(self, dpi: float) -> tuple[Figure, Axes]:
        """A figure just as large as the view needs at equal aspect; its pixels are even, as video asks."""
        corners = [self._tilted(self.edges, self.bed), *(self._surface(i) for i in range(self.one.sizes["time"]))]
        low, high = np.min(corners, axis=(0, 1)), np.max(corners, axis=(0, 1))
        pad = 0.03 * np.max(high - low)
        low, high = low - pad, high + pad
        scale = np.min(np.array([6.0, 4.6]) / (high - low))  # inches a metre
        size = np.maximum((high - low) * scale, [3.6, 1.3])
        high = low + size / scale
        heading = _heading(self.one, int(15 * (size[0] + 1.9)))
        left, bottom, right, top = 0.75, 0.5, 1.15, 0.4 + 0.17 * (1 + heading.count("\n"))
        whole = 2 * np.ceil((size + np.array([left + right, bottom + top])) * dpi / 2) / dpi
        figure = Figure(figsize=(whole[0], whole[1]))
        FigureCanvasAgg(figure)
        ax = figure.add_axes((left / whole[0], bottom / whole[1], size[0] / whole[0], size[1] / whole[1]))
        ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
        ax.set(xlabel="horizontal position (m)", ylabel="vertical position (m)")
        figure.suptitle(heading, fontsize=9, y=1 - 0.08 / whole[1])
        return figure, ax

    def _draw_ground(self, one: xr.Dataset) -> None:
        """The slope, constant beyond the ends of the grid."""
        x, bed = one["x"].values, one["bed"].values
        far = 10.0 * np.ptp(x)
        line = self._tilted(np.r_[x[0] - far, x, x[-1] + far], np.r_[bed[0], bed, bed[-1]])
        below = self._tilted(np.r_[x[-1] + far, x[0] - far], np.full(2, bed.min() - far))
        self.ax.fill(*np.concatenate([line, below]).T, facecolor="0.88", edgecolor="0.3", linewidth=0.8, zorder=1)

    def _draw_walls(self, one: xr.Dataset) -> None:
        """The ends of the grid that are walls, normal to the slope."""
        edges, bed = _edges(one["x"].values), one["bed"].values
        height = float(np.nanmax(one["h"].values))
        for key, end in (("scheme.left", 0), ("scheme.right", -1)):
            if parameter(one, key, "open").item() == "wall":
                foot = self._tilted(np.full(2, edges[end]), bed[end] + np.array([0.0, height]))
                self.ax.add_line(Line2D(*foot.T, color="0.2", linewidth=2.5, zorder=3))

    def _draw_colour_bar(self) -> None:
        """Volume fraction, the same colours in all frames; 1 % of the material lies beyond each end.

        A white line marks phi_stat.
        """
        phi, h = self.one["phi"].values[self.thick], self.one["h"].values[self.thick]
        order = np.argsort(phi)
        below = np.cumsum(h[order])
        low, high = np.interp([0.01 * h.sum(), 0.99 * h.sum()], below, phi[order]) if phi.size else (0.0, 1.0)
        widen = max(0.0, 0.02 - (high - low)) / 2
        self.material.set_clim(low - widen, high + widen)
        box = self.ax.get_position()
        bar = self.figure.add_axes((box.x1 + 0.15 / self.figure.get_figwidth(), box.y0, 0.018, box.height))
        self.figure.colorbar(self.material, cax=bar, extend="both", label=r"volume fraction $\varphi$ (-)")
        bar.axhline(_number(self.one, "rheology.phi_stat"), color="white", linestyle="--", linewidth=1.0)


def _edges(x: FloatArray) -> FloatArray:
    """The edges of uniform cells, from their centres [m]."""
    dx = (x[-1] - x[0]) / max(1, x.size - 1)
    return np.append(x - dx / 2, x[-1] + dx / 2)


def _at_edges(values: FloatArray) -> FloatArray:
    """Values of cells at their edges: the mean of the two neighbours, the cell's own value at the ends."""
    padded = np.pad(values, 1, mode="edge")
    return np.asarray((padded[1:] + padded[:-1]) / 2)


def _movie_writer(suffix: str, fps: int) -> AbstractMovieWriter:
    """What writes a GIF or a video."""
    if suffix == ".gif":
        return PillowWriter(fps=fps)
    if not FFMpegWriter.isAvailable():
        raise ValueError(
            "writing .mp4 needs ffmpeg, which was not found: install it, or choose a name that ends in .gif"
        )
    return FFMpegWriter(fps=fps)
