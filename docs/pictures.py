"""Pictures of the tutorials and the gallery: the scraper of matplotlib's, and what our scripts make besides."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

from matplotlib.animation import FuncAnimation
from matplotlib.figure import Figure
from sphinx_gallery.scrapers import figure_rst, matplotlib_scraper

from warpgran.errors import CaveatWarning


def quiet_gallery(gallery_conf: dict[str, Any], script: str) -> None:
    """Show the caveats of cases and results in the tutorials, which speak of them, and not with every picture."""
    in_gallery = Path(gallery_conf["src_dir"], "gallery", script).exists()
    warnings.filterwarnings("ignore" if in_gallery else "default", category=CaveatWarning)


def figures(block: Any, block_vars: dict[str, Any], gallery_conf: dict[str, Any]) -> str:
    """Save the pictures of a block, and return the lines that show them.

    They are the figures of pyplot, the `figure` that one of our functions returned, and the `movie` of an animation, as
    a GIF: sphinx-gallery's own player would load a font from elsewhere.
    """
    names = block_vars["example_globals"]
    figure, movie = names.pop("figure", None), names.pop("movie", None)
    made: list[str] = []
    if isinstance(movie, FuncAnimation):
        made.append(str(Path(next(block_vars["image_path_iterator"])).with_suffix(".gif")))
        movie.save(made[-1], writer="pillow", dpi=80)
    if isinstance(figure, Figure):
        made.append(next(block_vars["image_path_iterator"]))
        figure.savefig(made[-1], dpi=150)
    others = str(matplotlib_scraper(block, block_vars, gallery_conf, dpi=150))
    return others + (figure_rst(made, gallery_conf["src_dir"]) if made else "")
