"""The figure of a result: of one run, or of a batch."""

from __future__ import annotations

from pathlib import Path

import xarray as xr
from matplotlib import rc_context
from matplotlib.figure import Figure

from warpgran.errors import ResultError
from warpgran.figures.batch import draw_batch
from warpgran.figures.one_run import draw_run
from warpgran.figures.style import PLOT_SUFFIXES, STYLE, checked, save


def plot(data: xr.Dataset, *, run: int | None = None, path: str | Path | None = None) -> Figure:
    """Draw a result on one page, 180 mm wide.

    A single run is drawn by its profiles and series, a batch by its results over the swept keys.

    Args:
        data: a result.
        run: one run of a batch, counted from 0; by default all together.
        path: a picture to write, too: .png (200 dpi), .pdf or .svg.

    Returns:
        The figure: a notebook shows it, `figure.savefig("page.pdf")` saves it, and `figure.axes` are its panels.

    Raises:
        OptionError: another suffix.
        ResultError: no such run, nothing to draw, or a selection without the dimension `run`.
        StorageError: the picture cannot be written, or a file is there that warpgran did not write.
    """
    path = None if path is None else checked(path, PLOT_SUFFIXES)
    if "run" not in data.dims:
        raise ResultError("a figure needs the dimension `run`: select one run with data.isel(run=[0])")
    with rc_context(STYLE):
        together = run is None and data.sizes["run"] > 1
        figure = draw_batch(data) if together else draw_run(data, run or 0)
    if path is not None:
        save(figure, path)
    return figure
