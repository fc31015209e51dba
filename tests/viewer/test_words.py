"""Labels of the figures as pieces of text."""

from __future__ import annotations

import pytest

from warpgran.case.sections import KEYS
from warpgran.figures.one_run import PROFILES, SERIES
from warpgran.viewer.words import pieces, plain


@pytest.mark.parametrize(
    ("label", "expected"),
    [
        ("run-out", [("run-out", "")]),
        (r"thickness $h_\mathrm{max}$", [("thickness ", ""), ("h", "i"), ("max", "sub")]),
        (r"$\Delta V/V_0$", [("\u0394", "i"), ("V", "i"), ("/", ""), ("V", "i"), ("0", "sub")]),
        (r"$\tilde{K}$", [("K\u0303", "i")]),
        (r"$|v|$, $\dot{x}_\mathrm{f}$",
         [("|", ""), ("v", "i"), ("|", ""), (", ", ""), ("x\u0307", "i"), ("f", "sub")]),
    ],
)  # fmt: skip
def test_a_formula_is_letters_and_indices(label: str, expected: list[tuple[str, str]]) -> None:
    assert pieces(label) == expected


def test_no_symbol_of_the_package_loses_a_letter() -> None:
    labels = [f"${key.symbol}$" for key in KEYS.values() if key.symbol]
    for label in [*labels, *(panel.words for panel in (*PROFILES, *SERIES))]:
        text = plain(label)
        assert text and not set(text) & set("\\{}$_"), label
        assert all(piece for piece, _ in pieces(label)), label
