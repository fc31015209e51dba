"""Pictures of the tutorials and the gallery: the scraper of matplotlib's, and the figures that our functions return."""

from __future__ import annotations

from typing import Any

from matplotlib.figure import Figure
from sphinx_gallery.scrapers import figure_rst, matplotlib_scraper


def figures(block: Any, block_vars: dict[str, Any], gallery_conf: dict[str, Any]) -> str:
    """Save the figure that a block names `figure`, and those of pyplot, and return the lines that show them."""
    rst = str(matplotlib_scraper(block, block_vars, gallery_conf))
    figure = block_vars["example_globals"].pop("figure", None)
    if isinstance(figure, Figure):
        path = next(block_vars["image_path_iterator"])
        figure.savefig(path, dpi=150)
        rst += figure_rst([path], gallery_conf["src_dir"])
    return rst
