"""Text of others, such as titles, keys and paths, on its way to a terminal or a picture."""

from __future__ import annotations

import unicodedata


def printable(text: str) -> str:
    r"""The text in one line that changes nothing but its own place.

    What steers a terminal or the direction of writing, breaks lines or is no character stands as an escape:
    "\x1b", "\n", "\u202e". Blanks of any width stay.
    """
    return "".join(c if c.isprintable() or unicodedata.category(c) == "Zs" else _escape(c) for c in text)


def _escape(character: str) -> str:
    return character.encode("unicode_escape").decode("ascii")
