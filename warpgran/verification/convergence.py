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
from warpgran.run.simulate import simulate
from warpgran.verification.check import CheckOptions, CheckResult, Row

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
        scheme = {"scheme.order": order, "scheme.h_front": FRONTS[0]}
        return Case().with_(
            **{"slope.angle": self.angle, "grid.right": self.right, "grid.cells": cells, **output, **scheme},
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
BULK = ("front at 5 mm", "maximum height")
"""Those that must converge, to three percent on this many cells."""
JUDGED = 2000


def refine(collapse: Collapse, options: CheckOptions, cells: Sequence[int]) -> dict[tuple[float, str], Refined]:
    """All quantities of a collapse on all grids, by time [s] and name."""
    cases = [collapse.case(options.order, n) for n in cells]
    data = simulate(cases, device=options.device, precision=options.precision)
    return {
        (t, name): Refined(name, tuple(cells), tuple(of(case, data.isel(run=r), at) for r, case in enumerate(cases)))
        for at, t in enumerate(collapse.times)
        for name, of in QUANTITIES.items()
    }


def convergence(options: CheckOptions, cells: Sequence[int] = CELLS) -> CheckResult:
    """The collapses on all grids: errors against Richardson's estimate, orders, and cells for one percent."""
    found = {collapse: refine(collapse, options, cells) for collapse in COLLAPSES}
    rows = [_row(collapse, t, series) for collapse, all_of_it in found.items() for (t, _), series in all_of_it.items()]
    text = (
        "A column of 0.14 m x 0.20 m, phi = 0.62, on a plane and on 22 degrees, on grids of 0.8 m and 1.6 m. The error "
        "is the distance from Richardson's estimate of the limit, with the order observed over the three finest grids.",
        "The bulk converges with an order near one. The thin front in motion does not, on these grids: on a dry bed it "
        "runs ahead as a film of ever less mass and ever less solid, in which a thickness of 1 mm means nothing; its "
        "place moves on by as much at every halving of the cells, and the volume with it. So it is asked only that the "
        f"front at 10 mm and the maximum height are within 3 percent on {JUDGED} cells.",
    )
    return CheckResult("Which grid gives one percent", text, tuple(rows), {"convergence": draw(found)})


def _row(collapse: Collapse, t: float, series: Refined) -> Row:
    what = f"{series.name}, {collapse.angle:g} degrees, t = {t:g} s"
    asked = series.name in BULK and JUDGED in series.cells
    if not np.isfinite(series.limit):
        change = float(np.abs(series.changes[-1]))
        bound = "a limit" if asked else "reported"
        return Row(f"{what}: no limit in sight, last change", change, "-", bound, False if asked else None)
    words = f"1 % from {series.enough()} cells" if series.enough() else f"1 % on no grid up to {series.cells[-1]}"
    error = float(series.errors[-1])
    if not asked:
        return Row(f"{what}: {words}", error, "-", "reported", None, series.order)
    judged = float(series.errors[series.cells.index(JUDGED)])
    bound = f"<= 0.03 on {JUDGED} cells, where it is {judged:.2g}"
    return Row(f"{what}: {words}", error, "-", bound, judged <= 0.03, series.order)


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
