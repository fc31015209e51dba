"""Progress bars."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from warpgran.case.study import Study


@contextmanager
def run_progress(study: Study, runs: int) -> Iterator[Callable[[float], None]]:
    """A progress bar on standard error, in simulated time for one run; nothing where that is no terminal."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    console = Console(stderr=True)
    end = study.base.time.end
    per_run, form = (end, f"t = {{task.completed:.3f}} of {end:g} s") if runs == 1 else (1.0, "{task.completed:.0f} of "
                                                                                         f"{runs} runs")  # fmt: skip
    columns = (TextColumn("{task.description}"), BarColumn(), TextColumn(form), TimeRemainingColumn())
    with Progress(*columns, console=console, disable=not console.is_terminal) as bar:
        task = bar.add_task("preparing kernels", total=runs * per_run)

        def show(done: float) -> None:
            bar.update(task, completed=done * per_run, description=study.base.title or "computing")

        yield show
