"""Figures of the verification: computed profiles on the exact ones, and errors over the number of cells."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import AbstractContextManager
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from warpgran.figures.style import STYLE, WIDTH, letter
from warpgran.verification.check import Row
from warpgran.verification.grids import Comparison

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7")  # told apart by the colour-blind, and by lightness
MARKS = "osD^vx"
LABELS = {"h": "thickness $h$ (cm)", "v": "velocity $v$ (m/s)", "phi": r"volume fraction $\varphi$ (-)"}
FACTORS = {"h": 100.0, "v": 1.0, "phi": 1.0}
THIN = 1e-3
"""Share of the greatest thickness below which velocity and volume fraction are not drawn."""


def style() -> AbstractContextManager[None]:
    """The style of all figures: draw and save within."""
    return rc_context(STYLE)


def panels(count: int, rows: int = 1) -> tuple[Figure, list[Axes]]:
    """A figure of the page's width with so many panels in rows, lettered. To be called within `style`."""
    figure = Figure(figsize=(WIDTH, 2.5 * rows), layout="constrained")
    axes = list(figure.subplots(rows, count // rows, squeeze=False).flat)
    letter(axes)
    return figure, axes


def against_exact(comparison: Comparison, rows: Sequence[Row], names: Sequence[str], caption: str) -> Figure:
    """Profiles of the coarsest and the finest grid on the exact solution at all times, and the errors of all grids.

    Args:
        comparison: What was computed, and the exact solution.
        rows: Whose errors are drawn.
        names: Which of "h", "v", "phi" are drawn, a panel each.
        caption: What it shows.
    """
    figure, axes = panels(len(names) + 1, rows=1 if len(names) < 3 else 2)
    for ax, name in zip(axes, names, strict=False):
        _profiles(ax, comparison, name)
    errors(axes[-1], rows)
    axes[0].legend(handlelength=2.4)
    figure.set_label(caption)
    return figure


def _profiles(ax: Axes, comparison: Comparison, name: str) -> None:
    place = ("h", "v", "phi").index(name)
    for at, t in enumerate(comparison.times):
        low, high = comparison.span(t)
        x = np.linspace(low, high, 2001)
        fields = comparison.exact(x, t)
        thick = fields[0] > THIN * fields[0].max()
        exact = fields[place] if name == "h" else np.where(thick, fields[place], np.nan)
        ax.plot(x, FACTORS[name] * exact, color="0.72", linewidth=2.6, label="exact" if at == 0 else None)
        for grid, line, width in ((comparison.grids[0], ":", 1.2), (comparison.grids[-1], "-", 0.8)):
            inside = (grid.x > low) & (grid.x < high)
            found = (grid.h, grid.v, grid.phi)[place][at]
            shown = inside & ((grid.h[at] > THIN * grid.h[at].max()) | (name == "h"))
            label = f"{grid.x.size} cells" if at == 0 else None
            y = np.where(shown, FACTORS[name] * found, np.nan)
            ax.plot(grid.x, y, line, color=COLOURS[at % len(COLOURS)], linewidth=width, label=label)
    ax.set_xlabel("place $x$ (m)")
    ax.set_ylabel(LABELS[name])
    ax.locator_params(axis="x", nbins=6)


def errors(ax: Axes, rows: Sequence[Row], steps: str = "number of cells") -> None:
    """Errors over the number of cells, with lines of two orders over the grids that determine theirs.

    Args:
        ax: Where.
        rows: Those with errors on several grids.
        steps: What the grids are counted in.
    """
    rows = [row for row in rows if row.errors]
    for n, row in enumerate(rows):
        cells, values = np.array(row.errors).T
        style = MARKS[n % len(MARKS)] + "-"
        label = row.compared.partition(",")[0]
        ax.loglog(cells, values, style, color=COLOURS[n % len(COLOURS)], markersize=3, label=label)
    cells = np.array([n for n, _ in rows[0].errors], dtype=float)
    lowest = 0.4 * min(error for row in rows for _, error in row.errors)
    fast = max(row.order for row in rows) > 1.3
    for order, words in ((1.0, "1"), (2.0, "2")) if fast else ((0.5, "1/2"), (1.0, "1")):
        guide = lowest * (cells[-1] / cells[-3:]) ** order
        ax.loglog(cells[-3:], guide, "--", color="0.5", linewidth=0.8)
        place: Any = (cells[-3], guide[0])
        ax.annotate(f"order {words} ", place, fontsize=6.5, color="0.4", ha="right", va="center")
    ax.set_xlabel(steps)
    ax.set_ylabel("error, relative (-)" if rows[0].unit == "-" else f"error ({rows[0].unit})")
    ax.set_xticks(cells, [f"{n:g}" for n in cells], minor=False)
    ax.minorticks_off()
    top = max(error for row in rows for _, error in row.errors)
    share = 0.05 + 0.065 * len(rows)  # of the height, for the legend
    ax.set_ylim(bottom=lowest * (lowest / top) ** (share / (1.0 - share)))
    ax.legend(fontsize=6.5, loc="lower left", labelspacing=0.2, borderaxespad=0.2)
