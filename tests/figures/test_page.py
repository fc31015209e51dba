"""HTML pages: everything inside the file, texts escaped."""

from __future__ import annotations

from pathlib import Path

import pytest

from warpgran.figures.page import Page

PIXEL = bytes.fromhex(
    "89504e470d0a1a0a0000000d49484452000000010000000108060000001f15c4890000000d49444154789c6260606060000000000500"
    "01a5f645400000000049454e44ae426082"
)


def test_a_page_needs_nothing_beside_it(tmp_path: Path) -> None:
    (tmp_path / "a.png").write_bytes(PIXEL)
    page = Page("h < 1 mm & more")
    page.heading("Section", "section")
    page.paragraph("<script>")
    page.preformatted("a = 1\nb = 2")
    page.table(["what", "holds"], [["x < y", "yes"], ["z", "no"]], verdict="holds")
    page.picture(tmp_path / "a.png", "a pixel")
    page.write(tmp_path / "page.html")
    (tmp_path / "a.png").unlink()
    html = (tmp_path / "page.html").read_text()
    assert "<title>h &lt; 1 mm &amp; more</title>" in html
    assert '<h2 id="section">Section</h2>' in html and '<a href="#section">Section</a>' in html
    assert "<p>&lt;script&gt;</p>" in html and "<pre>a = 1\nb = 2</pre>" in html
    assert '<tr class="no"><td>z</td><td class="verdict">no</td></tr>' in html
    assert 'src="data:image/png;base64,iVBOR' in html and "http" not in html
    assert [path.name for path in tmp_path.iterdir()] == ["page.html"]


def test_a_picture_is_png_or_svg(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"cannot show 'a\.pdf': the name must end in \.png, \.svg"):
        Page("t").picture(tmp_path / "a.pdf", "")
