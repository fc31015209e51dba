"""The figure of results: of one run, of a batch, or of several results over each other."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from matplotlib import rc_context
from matplotlib.figure import Figure

from warpgran.analysis.run_columns import RunColumns
from warpgran.errors import OptionError
from warpgran.figures.batch import draw_batch
from warpgran.figures.one_run import draw_run
from warpgran.figures.overlay import draw_overlay
from warpgran.figures.style import PLOT_SUFFIXES, STYLE, checked, save

if TYPE_CHECKING:
    import xarray as xr


def plot(
    *results: xr.Dataset | RunColumns,
    run: int | None = None,
    labels: Sequence[str] | None = None,
    path: str | Path | None = None,
) -> Figure:
    """Draw a result, or several over each other, on one page, 180 mm wide.

    A single run is drawn by its profiles and series, a batch by its results over the swept keys. Of several results,
    the runs, eight at most, are drawn over each other: thickness at instants that all share, and series.

    Args:
        results: One or more.
        run: One run of a batch, or of each result, counted from 0; by default all together.
        labels: What several results are called; by default by their files, or titles, and by what differs.
        path: A picture to write, too: .png (200 dpi), .pdf or .svg.

    Returns:
        The figure. A notebook shows it, `figure.savefig("page.pdf")` saves it, and `figure.axes` are its panels.

    Raises:
        OptionError: Another suffix, or what is to be drawn is no result.
        ResultError: No such run, more than eight over each other, nothing to draw, or a selection without the
            dimension `run`.
        StorageError: The picture cannot be written, or a file is there that warpgran did not write.
    """
    path = None if path is None else checked(path, PLOT_SUFFIXES)
    every = [_columns(data) for data in results]
    if not every:
        raise OptionError("plot draws results, and none is given")
    with rc_context(STYLE):
        if len(every) > 1:
            figure = draw_overlay(every, run, labels)
        elif run is None and every[0].run.size > 1:
            figure = draw_batch(every[0])
        else:
            figure = draw_run(every[0], run or 0)
    if path is not None:
        save(figure, path)
    return figure


def _columns(data: xr.Dataset | RunColumns) -> RunColumns:
    """The runs of a result."""
    if isinstance(data, RunColumns):
        return data
    import xarray as xr

    if not isinstance(data, xr.Dataset):
        raise OptionError(f"plot draws results, not {data!r}; the name of a picture is given as path=...")
    return RunColumns.of(data)
