"""A check: how it is computed, and what it returns: rows of the table, figures, and words."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from matplotlib.figure import Figure

from warpgran.run.options import Precision


@dataclass(frozen=True)
class CheckOptions:
    """How the checks are computed.

    Attributes:
        device: "cpu", "cuda" or "cuda:N".
        precision: "float64" or "float32".
        grids: Number of grids of an order of accuracy, each of twice the cells of the one before; at least 2.
        order: `scheme.order` of the runs, 1 or 2.
    """

    device: str = "cpu"
    precision: Precision = "float64"
    grids: int = 6
    order: int = 2

    def cells(self, coarsest: int) -> tuple[int, ...]:
        """Cells of each grid."""
        return tuple(coarsest * 2**k for k in range(self.grids))


def scheme(order: int) -> dict[str, int]:
    """The keys of a scheme: without the start on finer cells, whose error is not of the order that is measured."""
    return {"scheme.order": order} | ({"scheme.start": 0} if order == 2 else {})


@dataclass(frozen=True)
class Row:
    """One thing compared.

    Attributes:
        compared: What with what, at which instant and over which cells.
        error: Of the finest grid, in `unit`.
        unit: Of the error; "-" if it is relative.
        bound: What it must hold to, in words and numbers; "reported" if nothing is asked.
        holds: Whether it does; None if it is only reported.
        order: Observed order of accuracy, NaN where there is none.
        errors: On every grid: cells, and the error in `unit`; empty where there is one grid.
        scheme: `scheme.order` of the runs, 1 or 2; `collection.run` sets it.
    """

    compared: str
    error: float
    unit: str
    bound: str
    holds: bool | None
    order: float = float("nan")
    errors: tuple[tuple[int, float], ...] = ()
    scheme: int = 0


@dataclass(frozen=True)
class CheckResult:
    """The result of a check.

    Attributes:
        title: Of the check.
        text: What is computed, the exact solution and its source, and what is to be seen; a paragraph a string.
        rows: Of the table.
        figures: By file name without suffix; the caption is the figure's label.
        run_files: Text of run files that reproduce what failed, by file name.
    """

    title: str
    text: tuple[str, ...]
    rows: tuple[Row, ...]
    figures: dict[str, Figure] = field(default_factory=dict)
    run_files: dict[str, str] = field(default_factory=dict)

    @property
    def holds(self) -> bool:
        """Whether all that is asked of it holds."""
        return all(row.holds is not False for row in self.rows)


def paragraphs(text: str) -> tuple[str, ...]:
    """Paragraphs of a text, which empty lines part."""
    return tuple(" ".join(part.split()) for part in text.strip().split("\n\n"))


Check = Callable[[CheckOptions], CheckResult]
"""A check of the collection: computes, compares, and returns the result."""
