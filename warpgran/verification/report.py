"""The report of the checks: a table for the terminal, a page, figures and a CSV file."""

from __future__ import annotations

import csv
import math
import sys
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from pathlib import Path

from rich.table import Table

from warpgran.figures.page import Page
from warpgran.figures.style import save
from warpgran.files import replacing
from warpgran.verification.check import CheckOptions, CheckResult, Row, paragraphs
from warpgran.verification.plots import style

PAGE = "verification.html"
COLUMNS = ("compared", "order", "error", "unit", "observed order", "bound", "holds")
INTRODUCTION = paragraphs("""
        Exact solutions of the model, some with friction and some with dilatancy, computed on finer and finer grids by
        both schemes, of order 1 (the paper's) and 2. An error in L1 is a sum over the cells of the distance from the
        exact cell average, relative to the same sum of the exact averages; it is that of the finest grid, and the
        observed order is the slope over the three finest. Bounds come from theory: rounding where the scheme is
        exact, the order of the scheme for smooth flows, 1/2 (order 1) or 1 (order 2) for jumps and kinks, with the
        margin that each case states. The bound on the error itself, some percent, is there to notice convergence to
        something else. What has no bound is reported.
        """)


def holds(row: Row) -> str:
    """Whether a row holds, in a word."""
    return "-" if row.holds is None else ("yes" if row.holds else "no")


def cells_of(row: Row) -> tuple[str, ...]:
    """A row as the texts of COLUMNS."""
    observed = "" if math.isnan(row.order) else f"{row.order:.2f}"
    return row.compared, str(row.scheme), f"{row.error:.2e}", row.unit, observed, row.bound, holds(row)


def printed(outcomes: Mapping[str, CheckResult]) -> Table:
    """The table for the terminal, a section a case."""
    table = Table("case", *COLUMNS, pad_edge=False)
    for name, outcome in outcomes.items():
        before = ""
        for n, row in enumerate(outcome.rows):
            style = "bold red" if row.holds is False else None
            compared, *others = cells_of(row)
            words = "" if compared == before else compared
            end = row is outcome.rows[-1]
            table.add_row(name if n == 0 else "", words, *others, style=style, end_section=end)
            before = compared
    return table


def write(outcomes: Mapping[str, CheckResult], folder: Path, options: CheckOptions) -> Path:
    """Write the page, its figures as PNG, the table as CSV, and run files of what failed.

    Args:
        outcomes: By the name of the case.
        folder: To write to; must exist.
        options: How they were computed.

    Returns:
        The page.
    """
    page = Page("Verification of warpgran")
    for text in INTRODUCTION:
        page.paragraph(text)
    page.table(("fact", "value"), facts(options))
    page.table(
        ("case", "what it is", "rows that hold", "holds"), [summary(*item) for item in outcomes.items()], "holds"
    )
    for name, outcome in outcomes.items():
        page.heading(outcome.title, name)
        for text in outcome.text:
            page.paragraph(text)
        page.table(COLUMNS, [cells_of(row) for row in outcome.rows], "holds")
        _errors_by_grid(page, outcome.rows)
        for file, figure in outcome.figures.items():
            path = folder / f"{file}.png"
            with style():
                save(figure, path, dpi=160)
            page.picture(path, str(figure.get_label()))
        for file, text in outcome.run_files.items():
            with replacing(folder / file) as part:
                part.write_text(text, encoding="utf-8")
            page.paragraph(f"{file}:")
            page.preformatted(text)
    _write_csv(outcomes, folder / "verification.csv")
    page.write(folder / PAGE)
    return folder / PAGE


def facts(options: CheckOptions) -> list[tuple[str, str]]:
    """Versions, precision, device and grids of the results."""
    python = sys.version.split()[0]
    versions = ", ".join(f"{name} {version(package)}" for name, package in
                         (("warpgran", "warpgran"), ("warp", "warp-lang"), ("numpy", "numpy")))  # fmt: skip
    return [
        ("versions", f"{versions}, python {python}"),
        ("precision", f"{options.precision}, where a row names none"),
        ("device", options.device),
        ("grids", f"{options.grids}, each with twice the cells of the one before"),
    ]


def summary(name: str, outcome: CheckResult) -> tuple[str, str, str, str]:
    """A case in a row."""
    asked = [row.holds for row in outcome.rows if row.holds is not None]
    return name, outcome.title, f"{sum(asked)} of {len(asked)}", "yes" if outcome.holds else "no"


def _errors_by_grid(page: Page, rows: Sequence[Row]) -> None:
    """Errors on every grid, a table for each set of grids."""
    by_grids: dict[tuple[int, ...], list[Row]] = {}
    for row in rows:
        if row.errors:
            by_grids.setdefault(tuple(cells for cells, _ in row.errors), []).append(row)
    for grids, those in by_grids.items():
        heads = ("error on a grid of", "order", *(f"{cells} cells" for cells in grids))
        lines = [(row.compared, str(row.scheme), *(f"{error:.2e}" for _, error in row.errors)) for row in those]
        page.table(heads, lines)


def _write_csv(outcomes: Mapping[str, CheckResult], path: Path) -> None:
    with replacing(path) as part, part.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(("case", *COLUMNS))
        for name, outcome in outcomes.items():
            writer.writerows((name, *cells_of(row)) for row in outcome.rows)
