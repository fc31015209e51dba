"""The labels of the figures, which are in TeX, as pieces that a page can show."""

from __future__ import annotations

import re

GREEK = {
    "varphi": "\u03c6", "psi": "\u03c8", "mu": "\u03bc", "theta": "\u03b8", "alpha": "\u03b1", "lambda": "\u03bb",
    "xi": "\u03be", "Delta": "\u0394", "ell": "\u2113",
}  # fmt: skip
"""Letters of formulas."""
ACCENTS = {"dot": "\u0307", "tilde": "\u0303"}
_PIECE = re.compile(r"(_)?(?:\{((?:[^{}]|\{[^{}]*\})*)\}|(\\[a-z]+\{[^{}]*\}|\\[A-Za-z]+|.))", re.DOTALL)


def pieces(label: str) -> list[tuple[str, str]]:
    """A label with formulas between dollars, as texts and how each is set.

    Args:
        label: as of `figures.style.Panel`: "speed $v_0$ (m/s)".

    Returns:
        Texts, each with "" for upright, "i" for a symbol, "sub" for an index.
    """
    found: list[tuple[str, str]] = []
    for place, text in enumerate(label.replace("\n", " ").split("$")):
        found += _formula(text) if place % 2 else [(text, "")] if text else []
    return found


def plain(label: str) -> str:
    """A label without marks of setting."""
    return "".join(text for text, _ in pieces(label))


def _formula(text: str) -> list[tuple[str, str]]:
    found = []
    for index, group, single in _PIECE.findall(text):
        symbol = _symbol(group or single).strip()
        if symbol:
            found.append((symbol, "sub" if index else "i" if symbol[:1].isalpha() else ""))
    return found


def _symbol(text: str) -> str:
    if command := re.fullmatch(r"\\([A-Za-z]+)(?:\{(.*)\})?", text):
        name, inside = command.groups()
        return GREEK.get(name, "") if inside is None else inside + ACCENTS.get(name, "")
    return text
