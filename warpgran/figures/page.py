"""One self-contained HTML page: headings, paragraphs, tables, and pictures inside the file itself."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from warpgran.errors import OptionError
from warpgran.files import MARK, replacing

MIME = {".png": "image/png", ".svg": "image/svg+xml"}


@dataclass
class Page:
    """A page, assembled from top to bottom and then written.

    Attributes:
        title: Heading of the page.
        blocks: Its parts in order, each with its kind and the values that page.html renders for it.
    """

    title: str
    blocks: list[dict[str, Any]] = field(default_factory=list)

    def heading(self, text: str, anchor: str = "") -> None:
        """Begin a section; `anchor` is its name in links and puts it into the list of contents."""
        self.blocks.append({"kind": "heading", "text": text, "anchor": anchor})

    def paragraph(self, text: str) -> None:
        """A paragraph of plain text."""
        self.blocks.append({"kind": "paragraph", "text": text})

    def preformatted(self, text: str) -> None:
        """Text with its line breaks, such as a run file."""
        self.blocks.append({"kind": "preformatted", "text": text})

    def table(self, columns: Sequence[str], rows: Sequence[Sequence[object]], verdict: str = "") -> None:
        """A table; rows are coloured by what stands in the column `verdict`: yes, no, or anything else."""
        place = list(columns).index(verdict) if verdict else None
        cells = [[str(cell) for cell in row] for row in rows]
        self.blocks.append({"kind": "table", "columns": list(columns), "rows": cells, "verdict": place})

    def picture(self, path: Path, caption: str) -> None:
        """A PNG or SVG file, taken into the page.

        Raises:
            OptionError: The file is neither.
        """
        kind = MIME.get(path.suffix.lower())
        if kind is None:
            raise OptionError(f"cannot show {path.name!r}: the name must end in {', '.join(MIME)}")
        data = base64.b64encode(path.read_bytes()).decode("ascii")
        self.blocks.append({"kind": "picture", "source": f"data:{kind};base64,{data}", "caption": caption})

    def write(self, path: Path) -> None:
        """Write the page whole, in place of an earlier page of warpgran."""
        html = template().render(title=self.title, blocks=self.blocks)
        with replacing(path, ours=MARK) as part:
            part.write_text(html, encoding="utf-8")


def template() -> Any:
    """The template of a page."""
    import jinja2

    loader = jinja2.PackageLoader("warpgran.figures", package_path="")
    environment = jinja2.Environment(
        loader=loader, autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    return environment.get_template("page.html")
