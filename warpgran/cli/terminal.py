"""The one place where the command line writes lines, and what tables and progress bars are written to.

Titles, keys and paths come from files that others may have written: what steers a terminal is escaped here, and what
rich takes for markup is not taken for it.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from warpgran.printable import printable

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from warpgran.case.study import Study
    from warpgran.run.outcome import Progress
    from warpgran.run.progress import Show


MANY = 5000
"""Runs whose check takes long enough for a bar."""


def say(text: str) -> None:
    """A line on standard output."""
    typer.echo(printable(text))


def tell(text: str) -> None:
    """A line on standard error, for what a user has to know beside the results."""
    typer.echo(f"warpgran: {printable(text)}", err=True)


@contextmanager
def progress_bar(*amount_and_total: Any) -> Iterator[Show]:
    """The bar of `run.progress.bar`, which takes the same; nothing where standard error is no terminal."""
    if not sys.stderr.isatty():
        yield lambda done, total, words: None
        return
    from warpgran.run.progress import bar

    with bar(*amount_and_total) as show:
        yield show


def read(file: Path, overrides: Sequence[str] | None, most: int | None = None) -> Study:
    """The study of a run file, with a bar while its runs are checked; see `read_study`."""
    from warpgran.case.read_study import read_study

    with ExitStack() as stack:
        shown: list[Show] = []

        def examined(done: int, total: int) -> None:
            if total >= MANY and not shown:
                shown.append(stack.enter_context(progress_bar()))
            for show in shown:
                show(done, total, "checking")

        return read_study(file, overrides or (), most=most, examined=examined)


@contextmanager
def study_bar(study: Study, runs: int) -> Iterator[Progress]:
    """The bar of so many runs of a study; nothing where standard error is no terminal."""
    from warpgran.run.progress import bar_of, no_bar

    with (bar_of if sys.stderr.isatty() else no_bar)(study, runs) as progress:
        yield progress


def stdout(width: int) -> Console:
    """Standard output for tables, as wide as the terminal, or `width` characters where it is none."""
    from rich.console import Console

    terminal = Console(markup=False, emoji=False, highlight=False)
    return terminal if terminal.is_terminal else Console(width=width, markup=False, emoji=False, highlight=False)


def print_whole(table: Table) -> None:
    """A table with each name and number to its last character: a terminal that is narrower breaks the lines."""
    from rich.console import Console

    console = Console(width=10_000, markup=False, emoji=False, highlight=False)
    console.width = console.measure(table).maximum
    console.print(table)
