"""Links of the pages to files of the repository that are pages here, too: they work in both places as they stand."""

from __future__ import annotations

import re

from sphinx.application import Sphinx

PAGES = {"benchmarks/README.md": "/benchmarks.md", "CHANGELOG.md": "/changes.md"}
"""The page that includes a file, by the file's path in the repository."""


def to_pages(app: Sphinx, docname: str, content: list[str]) -> None:
    """Let links to these files lead to their pages; those to sources become downloads by themselves."""
    files = "|".join(map(re.escape, PAGES))
    content[0] = re.sub(rf"\]\((?:\.\./)+({files})(#[^)]*)?\)", lambda m: f"]({PAGES[m[1]]}{m[2] or ''})", content[0])


def setup(app: Sphinx) -> dict[str, bool]:
    """Read every page through `to_pages`."""
    app.connect("source-read", to_pages)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
