"""Nothing of a figure lies beyond its page: headings, labels, legends and small print."""

from __future__ import annotations

from typing import Any

import pytest
import xarray as xr
from helpers.collapses import batch, collapse, two_runs
from matplotlib import rc_context
from matplotlib.backends.backend_agg import FigureCanvasAgg

import warpgran as wg
from warpgran.figures.style import STYLE

LONG = "A column of glass beads, two grades of packing, on a rough plane with side walls " * 2
PAGES: dict[str, tuple[list[xr.Dataset], dict[str, Any]]] = {
    "run": ([collapse()], {}),
    "bed, many keys, ended early": ([two_runs()], {"run": 1}),
    "two keys": ([batch(slope__angle=[0.0, 0.0, 22.0, 22.0], column__phi=[0.55, 0.62] * 2)], {}),
    "over each other": ([collapse(), two_runs(), collapse()], {"labels": ["short", LONG, LONG]}),
}


@pytest.mark.parametrize("page", PAGES)
def test_nothing_is_clipped(page: str) -> None:
    results, options = PAGES[page]
    data = [result.copy() for result in results]
    for result in data:
        result.attrs["case_toml"] = result.attrs["case_toml"].replace("Dense column, 22 degrees", LONG)
    figure = wg.plot(*data, **options)
    with rc_context(STYLE):
        canvas: Any = FigureCanvasAgg(figure)
        box = figure.get_tightbbox(canvas.get_renderer())
    width, height = figure.get_size_inches()
    assert box.x0 > 0.0 and box.y0 > 0.0
    assert box.x1 < width and box.y1 < height
