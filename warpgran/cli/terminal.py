"""What depends on whether standard output or standard error is a terminal: progress bars and widths."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import Console

    from warpgran.case.study import Study
    from warpgran.run.outcome import Progress
    from warpgran.run.progress import Show


@contextmanager
def progress_bar(*amount_and_total: Any) -> Iterator[Show]:
    """The bar of `run.progress.bar`, which takes the same; nothing where standard error is no terminal."""
    if not sys.stderr.isatty():
        yield lambda done, total, words: None
        return
    from warpgran.run.progress import bar

    with bar(*amount_and_total) as show:
        yield show


@contextmanager
def study_bar(study: Study, runs: int) -> Iterator[Progress]:
    """The bar of so many runs of a study; nothing where standard error is no terminal."""
    from warpgran.run.progress import bar_of, no_bar

    with (bar_of if sys.stderr.isatty() else no_bar)(study, runs) as progress:
        yield progress


def stdout(width: int) -> Console:
    """Standard output as wide as the terminal, or `width` characters where it is none."""
    from rich.console import Console

    terminal = Console()
    return terminal if terminal.is_terminal else Console(width=width)
