"""What `warpgran run` prints of a study and its results."""

from __future__ import annotations

from typing import TYPE_CHECKING

import typer

from warpgran.cli.terminal import stdout

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from warpgran.case.study import Study
    from warpgran.run.outcome import Outcome

WIDTH = 100
"""Characters of the summary where standard output is no terminal."""


def report(study: Study, data: xr.Dataset, outcome: Outcome) -> None:
    """Print the failures, the summary, the speed, and how far an interrupted study got."""
    from warpgran.analysis.summary import summary

    for run, failure in sorted(outcome.failures.items()):
        typer.echo(f"warpgran: run {run} {_values(study, run)}{failure}", err=True)
    if study.base.title:
        typer.echo(study.base.title)
    print_summary(summary(data))
    if outcome.kernel_seconds > 0.0:
        steps, seconds = outcome.cell_steps / 1e6, outcome.kernel_seconds
        typer.echo(f"{steps:.1f} million cell-steps in {seconds:.3f} s: {steps / seconds:.1f} million a second")
    if outcome.interrupted:
        _report_interruption(data, study.base.time.end)


def print_summary(frame: pd.DataFrame) -> None:
    """Print a summary, at the width of the terminal."""
    from warpgran.cli.table import rich_table

    console = stdout(WIDTH)
    console.print(rich_table(frame, width=console.width))


def _report_interruption(data: xr.Dataset, end: float) -> None:
    """Say how much is in the file, unless all is; `end` is the time that the runs were to reach, s."""
    from warpgran.results.reading import pending

    waiting = pending(data["status"].values)
    if not waiting.any():
        return
    runs = data.sizes["run"]
    if runs == 1:
        t, times = float(data["end_time"].max()), data["time"]
        far = f"at t = {t:.4g} s of {end:g} s; {int((times <= t).sum())} of {times.size} snapshots are"
    else:
        far = f"after {int((~waiting).sum())} of {runs} runs, which are"
    typer.echo(f"warpgran: interrupted {far} in the file; go on with --resume", err=True)


def _values(study: Study, run: int) -> str:
    """The swept values of a run, in brackets."""
    return f"({', '.join(f'{key} = {study.values(key)[run]}' for key in study.keys)}) " if study.keys else ""
