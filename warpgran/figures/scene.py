"""A frame of an animation: the mass on its slope, and its thickness alone where the slope dwarfs it."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.lines import Line2D

from warpgran.analysis.derived import thick
from warpgran.analysis.units import Lengths, unit_of
from warpgran.arrays import Array
from warpgran.errors import ResultError
from warpgran.figures.heading import run_heading
from warpgran.figures.one_run import POSITION, PROFILES
from warpgran.figures.selection import OneRun, wet_range
from warpgran.figures.style import Panel, Sheet

WIDEST = 1e9
"""Metres of a view, more than any flow has: a result may come from anywhere, and infinite numbers have no view."""
LEGIBLE = 0.25
"""Inches that the largest thickness takes on the slope, at least; with less it has a panel of its own."""
THICKNESS, GAP = 1.5, 0.55
"""Inches of the panel of the thickness, and between it and the slope."""


class Scene:
    """A frame: slope, wall, material, colour bar, time. The material moves from frame to frame.

    Attributes:
        figure: what is drawn on.
        ax: the slope, at equal aspect.
        alone: the thickness along the slope, or None where it is legible on the slope.
    """

    def __init__(self, one: OneRun, dpi: float, lengths: Lengths) -> None:
        """Draw what does not move. one: one run with its snapshots; dpi: pixels an inch; lengths: typical ones."""
        self.unit = unit_of(lengths.along)
        self.theta = np.deg2rad(one.parameter("slope.angle"))
        self.one = one.at(cells=wet_range(one))
        self.edges, self.bed = _edges(self.one.x), _at_edges(self.one.bed)
        self.thick = thick(self.one)
        self.deepest = float(np.max(self.one.h, where=self.thick, initial=0.0))
        self.alone: Axes | None = None
        self.figure, self.ax = self._canvas(dpi, PROFILES[0].of(lengths), POSITION.of(lengths))
        self._draw_ground(one)
        self._draw_walls(one)
        self.limits = self._colours()
        self.material = self._collection(self.ax)
        self.profile = None if self.alone is None else self._collection(self.alone)
        self._draw_colour_bar()

    def show(self, instant: int) -> None:
        """Move the material to a snapshot."""
        self._fill(self.material, self._tilted(self.edges, self.bed), self._surface(instant), instant)
        if self.profile is not None:
            along, up = self.scales
            foot = np.stack([along * self.edges, np.zeros_like(self.edges)], axis=-1)
            top = np.stack([along * self.edges, up * self._thickness(instant)], axis=-1)
            self._fill(self.profile, foot, top, instant)
        self.ax.set_title(self.caption(instant), loc="left", fontsize=9)

    def caption(self, instant: int) -> str:
        """The time of a snapshot."""
        return f"$t$ = {self.one.time[instant]:.3f} s"

    def _fill(self, material: PolyCollection, bottom: Array, top: Array, instant: int) -> None:
        """Fill the cells between two lines over the edges, where the mass is."""
        quads = np.stack([bottom[:-1], bottom[1:], top[1:], top[:-1]], axis=1)
        material.set_verts(list(quads[self.thick[instant]]))
        material.set_array(self.one.phi[instant][self.thick[instant]])

    def _collection(self, ax: Axes) -> PolyCollection:
        """The material of a panel, without any yet."""
        material = PolyCollection([], cmap="viridis", clim=self.limits, edgecolors="face", linewidths=0.5, zorder=2)
        ax.add_collection(material, autolim=False)
        return material

    def _tilted(self, x: Array, z: Array) -> Array:
        """Horizontal and vertical position, in the unit of the axes, of points at x along and z normal to it [m]."""
        cos, sin = np.cos(self.theta), np.sin(self.theta)
        return self.unit.factor * np.stack([x * cos + z * sin, -x * sin + z * cos], axis=-1)

    def _thickness(self, instant: int) -> Array:
        """Thickness at the edges of the cells [m]."""
        return _at_edges(np.nan_to_num(self.one.h[instant]))

    def _surface(self, instant: int) -> Array:
        """The free surface at the edges of the cells."""
        return self._tilted(self.edges, self.bed + self._thickness(instant))

    def _canvas(self, dpi: float, thickness: Panel, position: Panel) -> tuple[Sheet, Axes]:
        """A figure just as large as the view needs at equal aspect; its pixels are even, as video asks."""
        corners = [self._tilted(self.edges, self.bed), *(self._surface(i) for i in range(self.one.time.size))]
        low, high = np.min(corners, axis=(0, 1)), np.max(corners, axis=(0, 1))
        if not np.max(high - low) < WIDEST * self.unit.factor:
            reach = f"{np.max(high - low):.3g} {self.unit.name}"
            raise ResultError(f"run {self.one.place} cannot be drawn: it is {reach} wide or high")
        pad = 0.03 * np.max(high - low)
        low, high = low - pad, high + pad
        scale = np.min(np.array([6.0, 4.6]) / (high - low))  # inches a unit
        size = np.maximum((high - low) * scale, [3.6, 1.3])
        high = low + size / scale
        lost = self.deepest > 0.0 and self.deepest * self.unit.factor * scale < LEGIBLE
        title = run_heading(self.one, int(13 * (size[0] + 1.9)))
        left, bottom, right, top = 0.75, 0.5, 1.15, 0.4 + 0.17 * (1 + title.count("\n"))
        below = THICKNESS + GAP if lost else 0.0
        whole = 2 * np.ceil((size + np.array([left + right, bottom + below + top])) * dpi / 2) / dpi
        figure = Sheet(figsize=(whole[0], whole[1]), dpi=dpi)
        FigureCanvasAgg(figure)

        def axes(foot: float, height: float) -> Axes:
            return figure.add_axes((left / whole[0], foot / whole[1], size[0] / whole[0], height / whole[1]))

        ax = axes(bottom + below, size[1])
        ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
        ax.set(xlabel=f"horizontal position ({self.unit.name})", ylabel=f"vertical position ({self.unit.name})")
        if lost:
            self.scales = position.factor, thickness.factor
            self.alone = axes(bottom, THICKNESS)
            self.alone.set(xlabel=position.label, xlim=position.factor * self.edges[[0, -1]])
            self.alone.set(ylabel=thickness.label, ylim=(0.0, 1.08 * thickness.factor * self.deepest))
        figure.suptitle(title, fontsize=9, y=1 - 0.08 / whole[1])
        return figure, ax

    def _draw_ground(self, one: OneRun) -> None:
        """The slope, constant beyond the ends of the grid."""
        x, bed = one.x, one.bed
        far = 10.0 * np.ptp(x)
        line = self._tilted(np.r_[x[0] - far, x, x[-1] + far], np.r_[bed[0], bed, bed[-1]])
        below = self._tilted(np.r_[x[-1] + far, x[0] - far], np.full(2, bed.min() - far))
        self.ax.fill(*np.concatenate([line, below]).T, facecolor="0.88", edgecolor="0.3", linewidth=0.8, zorder=1)

    def _draw_walls(self, one: OneRun) -> None:
        """The ends of the grid that are walls, normal to the slope."""
        edges, bed = _edges(one.x), one.bed
        height = float(np.nanmax(one.h))
        for key, end in (("scheme.left", 0), ("scheme.right", -1)):
            if one.parameter(key) == "wall":
                foot = self._tilted(np.full(2, edges[end]), bed[end] + np.array([0.0, height]))
                self.ax.add_line(Line2D(*foot.T, color="0.2", linewidth=2.5, zorder=3))

    def _colours(self) -> tuple[float, float]:
        """Volume fractions between which colours run, in all frames; 1 % of the material lies beyond each end."""
        phi, h = self.one.phi[self.thick], self.one.h[self.thick]
        order = np.argsort(phi)
        below = np.cumsum(h[order])
        low, high = np.interp([0.01 * h.sum(), 0.99 * h.sum()], below, phi[order]) if phi.size else (0.0, 1.0)
        widen = max(0.0, 0.02 - (high - low)) / 2
        return low - widen, high + widen

    def _draw_colour_bar(self) -> None:
        """Volume fraction, beside all panels; a white line marks phi_stat."""
        above, below = self.ax.get_position(), (self.alone or self.ax).get_position()
        right = above.x1 + 0.15 / self.figure.get_figwidth()
        bar = self.figure.add_axes((right, below.y0, 0.018, above.y1 - below.y0))
        self.figure.colorbar(self.material, cax=bar, extend="both", label=r"volume fraction $\varphi$ (-)")
        bar.axhline(self.one.parameter("rheology.phi_stat"), color="white", linestyle="--", linewidth=1.0)


def _edges(x: Array) -> Array:
    """The edges of uniform cells, from their centres [m]."""
    dx = (x[-1] - x[0]) / max(1, x.size - 1)
    return np.append(x - dx / 2, x[-1] + dx / 2)


def _at_edges(values: Array) -> Array:
    """Values of cells at their edges: the mean of the two neighbours, the cell's own value at the ends."""
    padded = np.pad(values, 1, mode="edge")
    return np.asarray((padded[1:] + padded[:-1]) / 2)
