"""Animations of a result: the collapse of one run on its slope, a frame a snapshot."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import rc_context
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, FuncAnimation, PillowWriter
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.lines import Line2D

from warpgran.analysis.fields import number, parameter
from warpgran.analysis.front import thick
from warpgran.analysis.units import Lengths, LengthUnit, unit_of
from warpgran.arrays import Array
from warpgran.errors import ResultError
from warpgran.figures.heading import run_heading
from warpgran.figures.selection import computed_snapshots, one_run, wet_range
from warpgran.figures.style import STYLE, Sheet, checked
from warpgran.files import MARK, replacing

ANIMATION_SUFFIXES = (".gif", ".mp4")
SECONDS = 5.0  # of an animation, by default
MOST_FPS = 25
FEW, SMOOTH = 20, 60  # snapshots that move by jerks, and that do not
WIDEST = 1e9
"""Metres of a view, more than any flow has: a result may come from anywhere, and infinite numbers have no view."""


def animate(
    data: xr.Dataset, *, run: int = 0, path: str | Path | None = None, fps: int | None = None, dpi: float = 110
) -> Film:
    """Animate the collapse of one run on its slope, one frame a snapshot, coloured by volume fraction.

    Args:
        data: a result with two snapshots or more.
        run: which run of the result, counted from 0.
        path: an animation to write, too: .gif, or .mp4 where ffmpeg is installed.
        fps: frames a second; by default so many that it takes about 5 s.
        dpi: pixels an inch; a frame is about 8 inches wide.

    Returns:
        The animation, one of matplotlib's. A notebook shows it, and `save` writes it.

    Raises:
        OptionError: another suffix.
        StorageError: the animation cannot be written, or a file is there that warpgran did not write.
        ResultError: .mp4 without ffmpeg, no such run, or fewer than two snapshots.
    """
    path = None if path is None else checked(path, ANIMATION_SUFFIXES)
    one = computed_snapshots(one_run(data, run))
    held = one.sizes["time"]
    if held < 2:
        raise ResultError(f"an animation needs two snapshots or more, run {run} has {held}: {_more_snapshots(one)}")
    fps = fps or int(np.clip(round(held / SECONDS), 1, MOST_FPS))
    writer = None if path is None else _movie_writer(path.suffix.lower(), fps)
    with rc_context(STYLE):
        scene = Scene(one, dpi, unit_of(Lengths.of(data.isel(run=[run])).along))
        film = Film(scene, held, fps, _more_snapshots(one) if held < FEW else "")
    if path is not None and writer is not None:
        with replacing(path, ours=MARK) as part:
            film.save(part, writer=writer, dpi=dpi)
    return film


def _more_snapshots(one: xr.Dataset) -> str:
    """How to get as many as make a smooth animation."""
    every = float(f"{number(one, 'time.end') / SMOOTH:.2g}")
    return f"run it again with --set 'time.snapshots={{every={every:g}}}' for about {SMOOTH}"


class Film(FuncAnimation):
    """An animation that is drawn and saved in our style wherever it is taken, and that a notebook shows by itself.

    Attributes:
        figure: what is drawn on.
        advice: how to get more frames, if there are few; else "".
    """

    def __init__(self, scene: Scene, frames: int, fps: int, advice: str) -> None:
        """Show so many snapshots of a scene, so many a second."""
        self.figure, self.advice = scene.figure, advice
        super().__init__(scene.figure, scene.show, frames=frames, interval=1000.0 / fps)

    def __del__(self) -> None:
        """Go in silence: matplotlib warns of an animation that was never shown, which a script may well make."""

    def save(self, *arguments: Any, **options: Any) -> None:
        """Save it; see matplotlib's own."""
        with rc_context(STYLE):
            super().save(*arguments, **options)

    def _repr_html_(self) -> str:
        return str(self.to_jshtml())


class Scene:
    """A frame: slope, wall, material, colour bar, time. The material moves from frame to frame."""

    def __init__(self, one: xr.Dataset, dpi: float, unit: LengthUnit) -> None:
        """Draw what does not move. one: one run with its snapshots; dpi: pixels an inch; unit: of the axes."""
        self.unit = unit
        self.theta = np.deg2rad(number(one, "slope.angle"))
        self.one = one.isel(x=wet_range(one))
        self.edges, self.bed = _edges(self.one["x"].values), _at_edges(self.one["bed"].values)
        self.thick = thick(self.one).values
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

    def _tilted(self, x: Array, z: Array) -> Array:
        """Horizontal and vertical position, in the unit of the axes, of points at x along and z normal to it [m]."""
        cos, sin = np.cos(self.theta), np.sin(self.theta)
        return self.unit.factor * np.stack([x * cos + z * sin, -x * sin + z * cos], axis=-1)

    def _surface(self, instant: int) -> Array:
        """The free surface at the edges of the cells."""
        h = np.nan_to_num(self.one["h"].values[instant])
        return self._tilted(self.edges, self.bed + _at_edges(h))

    def _canvas(self, dpi: float) -> tuple[Sheet, Axes]:
        """A figure just as large as the view needs at equal aspect; its pixels are even, as video asks."""
        corners = [self._tilted(self.edges, self.bed), *(self._surface(i) for i in range(self.one.sizes["time"]))]
        low, high = np.min(corners, axis=(0, 1)), np.max(corners, axis=(0, 1))
        if not np.max(high - low) < WIDEST * self.unit.factor:
            reach = f"{np.max(high - low):.3g} {self.unit.name}"
            raise ResultError(f"run {self.one.attrs['run']} cannot be drawn: it is {reach} wide or high")
        pad = 0.03 * np.max(high - low)
        low, high = low - pad, high + pad
        scale = np.min(np.array([6.0, 4.6]) / (high - low))  # inches a unit
        size = np.maximum((high - low) * scale, [3.6, 1.3])
        high = low + size / scale
        title = run_heading(self.one, int(13 * (size[0] + 1.9)))
        left, bottom, right, top = 0.75, 0.5, 1.15, 0.4 + 0.17 * (1 + title.count("\n"))
        whole = 2 * np.ceil((size + np.array([left + right, bottom + top])) * dpi / 2) / dpi
        figure = Sheet(figsize=(whole[0], whole[1]), dpi=dpi)
        FigureCanvasAgg(figure)
        ax = figure.add_axes((left / whole[0], bottom / whole[1], size[0] / whole[0], size[1] / whole[1]))
        ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
        ax.set(xlabel=f"horizontal position ({self.unit.name})", ylabel=f"vertical position ({self.unit.name})")
        figure.suptitle(title, fontsize=9, y=1 - 0.08 / whole[1])
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
            if parameter(one, key).item() == "wall":
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
        bar.axhline(number(self.one, "rheology.phi_stat"), color="white", linestyle="--", linewidth=1.0)


def _edges(x: Array) -> Array:
    """The edges of uniform cells, from their centres [m]."""
    dx = (x[-1] - x[0]) / max(1, x.size - 1)
    return np.append(x - dx / 2, x[-1] + dx / 2)


def _at_edges(values: Array) -> Array:
    """Values of cells at their edges: the mean of the two neighbours, the cell's own value at the ends."""
    padded = np.pad(values, 1, mode="edge")
    return np.asarray((padded[1:] + padded[:-1]) / 2)


class _MarkedGif(PillowWriter):
    """A GIF that says who wrote it, so that it may be replaced."""

    def finish(self) -> None:
        """Write the file."""
        frames: list[Any] = self.__dict__["_frames"]
        frames[0].info["comment"] = MARK  # matplotlib has no metadata for a GIF
        super().finish()


def _movie_writer(suffix: str, fps: int) -> AbstractMovieWriter:
    """The writer of a GIF or a video."""
    if suffix == ".gif":
        return _MarkedGif(fps=fps)
    if not FFMpegWriter.isAvailable():
        raise ResultError(
            "writing .mp4 needs ffmpeg, which was not found: install it, or choose a name that ends in .gif"
        )
    return FFMpegWriter(fps=fps, metadata={"comment": MARK.decode()})
