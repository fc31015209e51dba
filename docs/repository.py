"""Files of the repository as pages of the site, with links that work in both places as they stand."""

from __future__ import annotations

import posixpath
import re
from pathlib import Path

from sphinx.application import Sphinx

PAGES = {"benchmarks/README.md": "benchmarks", "CHANGELOG.md": "changes", "CONTRIBUTING.md": "contributing"}
"""The page that shows a file, by the file's path in the repository."""
DOCS = Path(__file__).parent


def relinked(text: str, folder: str) -> str:
    """A text of a folder of the repository with its relative links as those of a page of the site.

    Links to other files, such as sources, become downloads.
    """

    def link(match: re.Match[str]) -> str:
        path = posixpath.normpath(posixpath.join(folder, match[1]))
        if path in PAGES:
            return f"](/{PAGES[path]}.md{match[2]})"
        inside = path.startswith("docs/")
        return f"](/{path.removeprefix('docs/')}{match[2]})" if inside else f"](/../{path}{match[2]})"

    return re.sub(r"\]\((?!https?:|#|/)([^)#\s]+)(#[^)]*|)\)", link, text)


def read(app: Sphinx, docname: str, content: list[str]) -> None:
    """Put the file in the place of its page, and lead links to it to the page."""
    shown = {page: file for file, page in PAGES.items()}
    if docname in shown:
        file = shown[docname]
        app.env.note_dependency(str(DOCS.parent / file))
        content[0] = relinked((DOCS.parent / file).read_text(encoding="utf-8"), posixpath.dirname(file))
    elif Path(app.env.doc2path(docname)).suffix == ".md":
        content[0] = relinked(content[0], posixpath.join("docs", posixpath.dirname(docname)))


def setup(app: Sphinx) -> dict[str, bool]:
    """Read every page through `read`."""
    app.connect("source-read", read)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
