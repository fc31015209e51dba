"""What steers a terminal does not reach it."""

from __future__ import annotations

import pytest

from warpgran.printable import printable


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("Dense column, 22°, φ = 0.62, 粒", "Dense column, 22°, φ = 0.62, 粒"),
        ("thin\u2009and\xa0fixed blanks", "thin\u2009and\xa0fixed blanks"),
        ("\x1b[31mred\x1b[0m", r"\x1b[31mred\x1b[0m"),
        ("two\nlines\r\t\x07\x7f\x9b", r"two\nlines\r\t\x07\x7f\x9b"),
        ("\u202eright to left\u2028", r"\u202eright to left\u2028"),
        ("\udcff of a file name", r"\udcff of a file name"),
    ],
)
def test_control_characters_are_escaped(text: str, shown: str) -> None:
    assert printable(text) == shown
