"""Which grid gives one percent: a dense collapse on a plane and on a slope, from coarse cells to fine ones."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from warpgran.analysis.front import compacted, front
from warpgran.analysis.refinement import Refined
from warpgran.case.case import Case
from warpgran.figures.style import STYLE, WIDTH, letter
from warpgran.run.simulate import simulate_quietly
from warpgran.verification.check import CheckOptions, CheckResult, Row, scheme

CELLS = (250, 500, 1000, 2000, 4000, 8000)
WANTED = 0.01


@dataclass(frozen=True)
class Collapse:
    """A column of 0.14 m x 0.20 m, phi 0.62, at two times: in motion, and late.

    Attributes:
        angle: Slope, degrees.
        right: End of the grid, m.
        times: s.
    """

    angle: float
    right: float
    times: tuple[float, float]

    def case(self, order: int, cells: int) -> Case:
        """The case on a grid of so many cells."""
        times = list(self.times)
        output = {"time.end": times[-1], "time.snapshots": times, "time.series": times}
        keys = {**scheme(order), "scheme.h_front": FRONTS[0]}
        return Case().with_(
            **{"slope.angle": self.angle, "grid.right": self.right, "grid.cells": cells, **output, **keys},
        )


COLLAPSES = (Collapse(0.0, 0.6, (0.2, 0.5)), Collapse(22.0, 1.4, (0.48, 1.38)))


FRONTS = (1.4e-3, 5e-3)
"""Compacted thicknesses of the fronts, m: two grain diameters, and seven."""


def _thick_front(case: Case, run: xr.Dataset, at: int) -> float:
    return front(case.x, compacted(run).values[at, : case.grid.cells], FRONTS[1])


QUANTITIES: dict[str, Callable[[Case, xr.Dataset, int], float]] = {
    "front at 1.4 mm": lambda case, run, at: float(run["front"][at]),
    "front at 5 mm": _thick_front,
    "maximum height": lambda case, run, at: float(run["h_max"][at]),
    "volume": lambda case, run, at: 1.0 + float(run["volume_change"][at]),
}
"""Each a number > 0 whose relative error is reported. The front counts from the foot of the column, at x = 0."""


@dataclass(frozen=True)
class Judged:
    """What is asked of a scheme: quantities within an error on so many cells."""

    quantities: tuple[str, ...]
    error: float
    cells: int


JUDGED = {
    1: Judged(("front at 5 mm", "maximum height"), 0.03, 2000),
    2: Judged(("front at 1.4 mm", "front at 5 mm", "maximum height"), 0.01, 1000),
}
"""By the order of the scheme."""
LEAST, SETTLED = 0.9, 1e-4
"""Order asked of fronts under order 2, and an error of the finest grid below which it is not asked."""


def refine(collapse: Collapse, options: CheckOptions, cells: Sequence[int]) -> dict[tuple[float, str], Refined]:
    """All quantities of a collapse on all grids, by time [s] and name."""
    cases = [collapse.case(options.order, n) for n in cells]
    data = simulate_quietly(cases, device=options.device, precision=options.precision)
    return {
        (t, name): Refined(name, tuple(cells), tuple(of(case, data.isel(run=r), at) for r, case in enumerate(cases)))
        for at, t in enumerate(collapse.times)
        for name, of in QUANTITIES.items()
    }


def convergence(options: CheckOptions, cells: Sequence[int] = CELLS) -> CheckResult:
    """The collapses on all grids: errors against Richardson's estimate, orders, and cells for one percent."""
    found = {collapse: refine(collapse, options, cells) for collapse in COLLAPSES}
    rows = [
        _row(options.order, collapse, t, series)
        for collapse, all_of_it in found.items()
        for (t, _), series in all_of_it.items()
    ]
    text = (
        "A column of 0.14 m x 0.20 m, phi = 0.62, on a plane and on 22 degrees, on grids of 0.8 m and 1.6 m. The error "
        "is the distance from Richardson's estimate of the limit, with the order observed over the three finest grids.",
        "Fronts are those of the compacted thickness phi h/phi_stat: the film ahead of the mass dilates to nothing, "
        "and the place where h itself is 1 mm has no limit. Order 1 must have the front at 5 mm and the maximum height "
        f"within 3 percent on {JUDGED[1].cells} cells, order 2 these and the front at 1.4 mm within 1 percent on "
        f"{JUDGED[2].cells}.",
    )
    return CheckResult("Which grid gives one percent", text, tuple(rows), {"convergence": draw(found)})


def _row(order: int, collapse: Collapse, t: float, series: Refined) -> Row:
    what = f"{series.name}, {collapse.angle:g} degrees, t = {t:g} s"
    judged = JUDGED[order]
    asked = series.name in judged.quantities and judged.cells in series.cells
    if not np.isfinite(series.limit):
        bound = "a limit: none in sight, last change" if asked else "reported: no limit in sight, last change"
        return Row(what, float(np.abs(series.changes[-1])), "-", bound, False if asked else None)
    words = f"1 % from {series.enough()} cells" if series.enough() else f"1 % on no grid up to {series.cells[-1]}"
    error = float(series.errors[-1])
    errors = tuple(zip(series.cells, series.errors.tolist(), strict=True))
    if not asked:
        return Row(what, error, "-", f"reported: {words}", None, series.order, errors)
    there = float(series.errors[series.cells.index(judged.cells)])
    bound = f"<= {judged.error:g} on {judged.cells} cells, where it is {there:.2g}; {words}"
    held = there <= judged.error
    if order == 2 and series.name.startswith("front"):
        bound = f"order >= {LEAST:g} or error <= {SETTLED:g}, {bound}"
        held = held and (series.order >= LEAST or error <= SETTLED)
    return Row(what, error, "-", bound, bool(held), series.order, errors)


COLOURS = ("#d55e00", "#cc79a7", "#0072b2", "#009e73")
MARKS = "sDo^"


def draw(found: dict[Collapse, dict[tuple[float, str], Refined]]) -> Figure:
    """Error over cells, a panel for each collapse and time."""
    with rc_context(STYLE):
        figure = Figure(figsize=(WIDTH, 4.6), layout="constrained")
        axes = figure.subplots(len(found), 2, sharex=True, sharey=True, squeeze=False)
        for row, (collapse, all_of_it) in zip(axes, found.items(), strict=True):
            for ax, t, words in zip(row, collapse.times, ("in motion", "late"), strict=True):
                for n, series in enumerate(all_of_it[t, name] for name in QUANTITIES):
                    _line(ax, series, COLOURS[n], MARKS[n])
                ax.axhline(WANTED, color="0.45", linewidth=0.7, zorder=1)
                ax.set_title(f"{collapse.angle:g}°, t = {t:g} s: {words}", fontsize=8)
        letter(list(axes.flat))
        ticks = list(next(iter(next(iter(found.values())).values())).cells)
        for ax in axes[-1]:
            ax.set_xlabel("number of cells (-)")
            ax.set_xticks(ticks, [str(n) for n in ticks])
            ax.minorticks_off()
        for ax in axes[:, 0]:
            ax.set_ylabel("relative error (-)")
        axes[0, 0].set_ylim(bottom=1e-4)
        above: Any = {"xytext": (0, 2), "textcoords": "offset points"}
        axes[0, 0].annotate("1 %", (ticks[0], WANTED), fontsize=7, color="0.3", **above)
        figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=4)
    figure.set_label(
        "Distance from Richardson's estimate of the limit. Open marks and dashes: a quantity that shows no limit on "
        "these grids, and its change from the grid before."
    )
    return figure


def _line(ax: Axes, series: Refined, colour: str, mark: str) -> None:
    if np.isfinite(series.limit):
        shown = np.where(series.errors > 0.0, series.errors, np.nan)
        ax.loglog(series.cells, shown, f"{mark}-", color=colour, markersize=3.5, label=series.name)
    else:
        open_marks: Any = {"markersize": 3.5, "markerfacecolor": "none"}
        ax.loglog(series.cells[1:], np.abs(series.changes), f"{mark}--", color=colour, label=series.name, **open_marks)
