"""Progress of a computation, as a bar on standard error."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from warpgran.case.study import Study
from warpgran.printable import printable
from warpgran.run.outcome import Progress

RUNS = "{task.completed:.0f} of {task.total:.0f} runs"
"""Amount of a bar that counts runs."""
_TIME = "t = {task.completed:.3f} of {task.total:g} s"
Show = Callable[[float, float, str], None]
"""Takes the amount done, the total, and the words before the bar."""


@contextmanager
def bar(amount: str = RUNS, total: float = 1.0) -> Iterator[Show]:
    """A bar, on a terminal or in a notebook. What is printed meanwhile stands above it.

    Args:
        amount: Text behind the bar, a format string in which `task.completed` and `task.total` are known.
        total: Amount of the whole work, until another is shown.

    Yields:
        What moves the bar.
    """
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn
    from rich.table import Column

    # A title may hold brackets, and be so long that the bar had no room beside it.
    words = TextColumn("{task.description}", markup=False, table_column=Column(no_wrap=True, max_width=36))
    columns = (words, BarColumn(), TextColumn(amount), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), redirect_stdout=sys.stdout.isatty()) as shown:
        task = shown.add_task("preparing kernels", total=total)

        def show(done: float, total: float, words: str) -> None:
            shown.update(task, completed=done, total=total, description=printable(words))

        yield show


@contextmanager
def bar_of(study: Study, runs: int) -> Iterator[Progress]:
    """The bar of a study: the time of its only run, or the number of runs that are done.

    Args:
        study: What is computed.
        runs: How many of its runs.

    Yields:
        What moves the bar, called with the number of runs done.
    """
    amount, total = (_TIME, study.base.time.end) if runs == 1 else (RUNS, float(runs))
    with bar(amount, total) as show:
        yield lambda done: show(done / runs * total, total, study.base.title or "computing")


@contextmanager
def no_bar(study: Study, runs: int) -> Iterator[Progress]:
    """Nothing where there is no bar to be."""
    yield lambda done: None
