"""What depends on whether standard output or standard error is a terminal: progress bars and widths."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console

RUNS = "{task.completed:.0f} of {task.total:.0f} runs"
"""Amount of a progress bar that counts runs."""
Show = Callable[[float, float, str], None]
"""Takes the amount done, the total, and the words before the bar."""


@contextmanager
def progress_bar(amount: str = RUNS, total: float = 1.0) -> Iterator[Show]:
    """A progress bar on standard error; nothing where that is no terminal. What is printed meanwhile stands above it.

    Args:
        amount: Text behind the bar, a format string in which `task.completed` and `task.total` are known.
        total: Amount of the whole work, until another is shown.

    Yields:
        What moves the bar.
    """
    if not sys.stderr.isatty():
        yield lambda done, total, words: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), TextColumn(amount), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), redirect_stdout=sys.stdout.isatty()) as bar:
        task = bar.add_task("preparing kernels", total=total)

        def show(done: float, total: float, words: str) -> None:
            bar.update(task, completed=done, total=total, description=words)

        yield show


def stdout(width: int) -> Console:
    """Standard output as wide as the terminal, or `width` characters where it is none."""
    from rich.console import Console

    terminal = Console()
    return terminal if terminal.is_terminal else Console(width=width)
