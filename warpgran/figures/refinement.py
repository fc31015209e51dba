"""The figure of a case on several grids: the error of each quantity over the number of cells."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure

from warpgran.analysis.refinement import Refined
from warpgran.figures.style import COLOURS, STYLE, THIN, WIDTH, Sheet

MARKS = "sDo^v<>"


def draw_refinement(quantities: Sequence[Refined], cells: int, wanted: float) -> Figure:
    """Errors against Richardson's limit, or where there is none, dashed and open, the change from the grid before.

    Args:
        quantities: On the same grids.
        cells: The user's own grid, marked by a line.
        wanted: An error, marked by a line.
    """
    with rc_context(STYLE):
        figure = Sheet(figsize=(WIDTH, 3.2), layout="constrained")
        ax = figure.subplots()
        for n, quantity in enumerate(quantities):
            colour, mark = COLOURS[n % len(COLOURS)], MARKS[n % len(MARKS)]
            limited = bool(np.isfinite(quantity.limit))
            errors = quantity.errors if limited else np.r_[np.nan, np.abs(quantity.changes)]
            (line,) = ax.loglog(quantity.cells, np.where(errors > 0.0, errors, np.nan), f"{mark}-", color=colour)
            line.set(markersize=3.5, label=quantity.name)
            if not limited:
                line.set(linestyle="--", markerfacecolor="none", label=f"{quantity.name} \n(its change: no limit)")
        ax.axhline(wanted, **THIN)
        ax.annotate(f"{wanted:.0%}", (quantities[0].cells[0], wanted), (0, 2), textcoords="offset points", color="0.3")
        ax.axvline(cells, **THIN, linestyle=":")
        ax.set_xticks(quantities[0].cells, [str(n) for n in quantities[0].cells])
        ax.minorticks_off()
        ax.set_xlabel("number of cells (-)")
        ax.set_ylabel("relative error (-)")
        ax.tick_params(top=True, right=True)
        figure.legend(loc="outside right upper")
    return figure
