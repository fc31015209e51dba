"""How fine a grid must be: a case on half, the same and twice the cells, or more grids."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
import xarray as xr

from warpgran.analysis.caveats import messages
from warpgran.analysis.refinement import Refined
from warpgran.analysis.runs import status_words
from warpgran.analysis.summary import summary
from warpgran.case.case import Case
from warpgran.case.problems import CaseError, Problem
from warpgran.errors import CaveatWarning, OptionError, ResultError
from warpgran.run.options import Options
from warpgran.run.simulate import simulate_quietly
from warpgran.schema import CLEAN

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WANTED = 0.01
"""The error that is spoken of: one percent."""
LEVELS = (3, 6)
"""Least and most grids."""


@dataclass(frozen=True)
class Convergence:
    """A case on several grids, each of twice the cells of the one before.

    Attributes:
        case: On the user's own grid, the second.
        quantities: What was compared.
        reserves: What it must not be read without: runs that lost solid or had not stopped.
    """

    case: Case
    quantities: tuple[Refined, ...]
    reserves: tuple[str, ...] = ()

    @property
    def cells(self) -> tuple[int, ...]:
        """Of each grid."""
        return self.quantities[0].cells

    def table(self) -> pd.DataFrame:
        """A row a quantity.

        Columns: the value on each grid by its cells, `order` observed, `limit` by Richardson, `error` of the user's
        grid as a fraction, `cells_1_percent`. NaN where these grids show no limit. SI units. Errors of the dilation are
        errors of the volume.
        """
        rows = {
            quantity.name: {
                **dict(zip(self.cells, quantity.values, strict=True)),
                "order": quantity.order,
                "limit": quantity.limit,
                "error": quantity.errors[1],
                "cells_1_percent": quantity.needed(WANTED) or math.nan,
            }
            for quantity in self.quantities
        }
        return pd.DataFrame.from_dict(rows, orient="index")

    def verdict(self) -> str:
        """In a line, which cells give one percent."""
        finest = self.cells[-1]
        needed = {quantity.name: quantity.needed(WANTED) for quantity in self.quantities}
        unknown = [name for name, cells in needed.items() if cells is None]
        known = {name: cells for name, cells in needed.items() if cells is not None}
        words = []
        if known:
            name, most = max(known.items(), key=lambda item: item[1])
            dx = 1e3 * self.case.dx * self.case.grid.cells / most
            how = "extrapolated; " if most > finest else ""
            whole = "everything" if not unknown else "what shows a limit"
            words.append(f"1 % of {whole} from {most} cells of {dx:.3g} mm ({how}the {name} asks for most)")
        if unknown:
            words.append(f"no limit in sight on these grids: {', '.join(unknown)}")
        return "; ".join(words)

    def plot(self, path: str | Path | None = None) -> Figure:
        """Draw the error of each quantity over the cells, as `warpgran.plot` draws results.

        Args:
            path: A picture to write, too: .png, .pdf or .svg.
        """
        from warpgran.figures.refinement import draw_refinement
        from warpgran.figures.style import PLOT_SUFFIXES, checked, save

        path = None if path is None else checked(path, PLOT_SUFFIXES)
        figure = draw_refinement(self.quantities, self.case.grid.cells, WANTED)
        if path is not None:
            save(figure, path)
        return figure


def converge(case: Case, *, levels: int = 3, options: Options | None = None) -> Convergence:
    """Compute a case on half its cells, its own, twice as many, and so on.

    Args:
        case: One run, of an even number of cells.
        levels: Number of grids, 3 to 6.
        options: How to compute: device, precision, threads.

    Returns:
        Front, greatest height, dilation and other results on all grids, with orders and limits.

    Warns:
        CaveatWarning: Runs lost solid through an end of the grid, or had not stopped.

    Raises:
        OptionError: Another number of levels.
        CaseError: The case cannot be run on one of the grids.
        ResultError: A run did not reach its end.
    """
    least, most = LEVELS
    if not least <= levels <= most:
        raise OptionError(f"levels: {levels} is out of range; allowed: {least} to {most}")
    cells = case.grid.cells
    if cells % 2:
        raise CaseError(
            [Problem("grid.cells", f"{cells} is odd, and the coarsest grid has half of them; allowed: even")]
        )
    options = options or Options()
    # A snapshot is an output time already, so that a sample there changes no step.
    samples = sorted({0.0, *case.sample_times, *case.snapshot_times})
    grids = tuple(cells // 2 * 2**level for level in range(levels))
    cases = [case.with_(**{"grid.cells": n, "time.series": samples}, title=case.title) for n in grids]
    data = simulate_quietly(
        cases, device=options.device, precision=options.precision, engine=options.engine, threads=options.threads
    )
    unfinished = [f"{n} cells: {word}" for n, word in zip(grids, status_words(data), strict=True) if word not in CLEAN]
    if unfinished:
        raise ResultError(f"cannot compare runs that did not reach their end ({', '.join(unfinished)})")
    reserves = tuple(messages(data))
    for line in reserves:
        warnings.warn(line, CaveatWarning, stacklevel=2)
    return Convergence(case, tuple(_quantities(data, grids)), reserves)


def _quantities(data: xr.Dataset, cells: tuple[int, ...]) -> list[Refined]:
    """All that is compared; a stop time only if every run has stopped."""
    table, front = summary(data), data["front"].values
    values = {"run-out": table["run_out"], "final height": table["h_max"]}
    found = [Refined(name, cells, tuple(column)) for name, column in values.items()]
    found.append(Refined("dilation", cells, tuple(table["dilation_max"]), offset=1.0))
    if table["stop_time"].notna().all():
        found.append(Refined("stop time", cells, tuple(table["stop_time"])))
    for t in data["time"].values.tolist():
        at = int(np.searchsorted(data["series_time"].values, t))
        if t > 0.0:
            found.append(Refined(f"front at {t:g} s", cells, tuple(front[:, at] - front[:, 0])))
    return found
