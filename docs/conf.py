"""The documentation site: `sphinx-build -W -n docs build/docs`; needs `pip install ".[docs]"`."""

from __future__ import annotations

import sys
from importlib.metadata import version as version_of
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parent))

from matplotlib.figure import Figure

project = "warpgran"
author = "The warpgran developers"
copyright = author  # the name that Sphinx wants
version = release = version_of("warpgran")

extensions = [
    "mathml",
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_design",
    "sphinx_gallery.gen_gallery",
    "sphinxcontrib.typer",
]
exclude_patterns = ["tutorials", "gallery"]  # scripts: sphinx-gallery runs them into made/
html_math_renderer = "mathml"

myst_enable_extensions = ["amsmath", "colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3

autodoc_typehints = "description"
autodoc_member_order = "bysource"
napoleon_google_docstring = True
nitpick_ignore_regex = [
    # libraries that are described elsewhere: nothing is fetched from there when the site is made
    (r"py:.*", r"(xr|xarray|np|numpy|pd|pandas|matplotlib|pydantic|pydantic_core|pathlib|typing|collections)\..*"),
    (r"py:.*", r"(Path|Any|Array|Dataset|DataFrame|Figure|NDArray)"),
]


def figures(block: Any, block_vars: dict[str, Any], gallery_conf: dict[str, Any]) -> str:
    """Pictures of a block: the figure that it names `figure`, as our functions return one, and those of pyplot."""
    from sphinx_gallery.scrapers import figure_rst, matplotlib_scraper

    rst = str(matplotlib_scraper(block, block_vars, gallery_conf))
    figure = block_vars["example_globals"].pop("figure", None)
    if isinstance(figure, Figure):
        path = next(block_vars["image_path_iterator"])
        figure.savefig(path, dpi=150)
        rst += figure_rst([path], gallery_conf["src_dir"])
    return rst


html_theme = "furo"
html_title = "warpgran"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_theme_options: dict[str, Any] = {"top_of_page_buttons": []}

sphinx_gallery_conf: dict[str, Any] = {
    "examples_dirs": ["tutorials", "gallery"],
    "gallery_dirs": ["made/tutorials", "made/gallery"],
    "filename_pattern": r"\.py$",
    "ignore_pattern": r"conf\.py",
    "within_subsection_order": "FileNameSortKey",
    "remove_config_comments": True,
    "download_all_examples": False,
    "show_memory": False,
    "min_reported_time": 1000,
    "image_scrapers": (figures,),
    "abort_on_example_error": True,
}
