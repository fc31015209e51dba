"""The documentation site: `sphinx-build -W -n docs build/docs`; needs `pip install ".[docs]"`."""

from __future__ import annotations

import sys
import warnings
from importlib.metadata import version as version_of
from pathlib import Path
from typing import Any

from sphinx.domains.python import PyObject

sys.path.insert(0, str(Path(__file__).parent))

project = "warpgran"
author = "The warpgran developers"
copyright = author  # the name that Sphinx wants
version = release = version_of("warpgran")

# As the tutorials show them: without the path of this copy of the repository.
warnings.formatwarning = lambda message, category, *_: f"{category.__name__}: {message}\n"

extensions = [
    "mathml",
    "repository",
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_design",
    "sphinx_gallery.gen_gallery",
    "sphinxcontrib.typer",
]
exclude_patterns = ["tutorials", "gallery"]  # scripts: sphinx-gallery runs them into made/
html_math_renderer = "mathml"
highlight_language = "text"
smartquotes_action = "D"  # dashes alone: quotation marks of the pages are those of code more often than not
default_role = "code"  # docstrings mark names with single backticks

myst_enable_extensions = ["amsmath", "colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3

autodoc_typehints = "description"
autodoc_typehints_description_target = "documented"
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True
napoleon_google_docstring = True
napoleon_use_ivar = True
for field in PyObject.doc_field_types:
    if field.name == "variable":  # Sphinx calls the attributes of a class its variables
        field.label = "Attributes"
nitpick_ignore_regex = [
    # libraries that are described elsewhere: nothing is fetched from there when the site is made
    (r"py:.*", r"(os|xr|xarray|np|numpy|pd|pandas|matplotlib|pathlib|typing|collections)\..*|Path|Client|Figure"),
    # what a calibration keeps for itself, and an animation of matplotlib's
    (r"py:.*", r"warpgran\.calibration\.stages\..*|(warpgran\.figures\.animation\.)?Film"),
    # aliases, whose values the docstrings say, and the types by which editors complete `Case.with_`
    (r"py:.*", r"Array|RunColumns|Precision|EngineName|warpgran\.case\.changes\..*"),
]

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
    "write_computation_times": False,
    "show_signature": False,
    "image_scrapers": ["pictures.figures"],
    "reset_modules": ("matplotlib", "pictures.quiet_gallery"),
    "abort_on_example_error": True,
}
