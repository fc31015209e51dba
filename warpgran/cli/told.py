"""What the commands report of a study and its results."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import typer

if TYPE_CHECKING:
    import xarray as xr

    from warpgran.case.study import Study
    from warpgran.run.outcome import Outcome


def report(study: Study, data: xr.Dataset, outcome: Outcome) -> None:
    """Table, speed, and how far an interrupted study got."""
    from warpgran.analysis.summary import summary
    from warpgran.results.reading import pending

    if study.base.title:
        typer.echo(study.base.title)
    print_summary(summary(data))
    if outcome.kernel_seconds > 0.0:
        steps, seconds = outcome.cell_steps / 1e6, outcome.kernel_seconds
        typer.echo(f"{steps:.1f} million cell-steps in {seconds:.3f} s: {steps / seconds:.1f} million a second")
    if outcome.interrupted and pending(data["status"].values).any():
        runs, t = data.sizes["run"], float(data["end_time"].max())
        if runs == 1:
            stored = int((data["time"] <= t).sum())
            far = f"at t = {t:.4g} s of {study.base.time.end:g} s; {stored} of {data.sizes['time']} snapshots are"
        else:
            far = f"after {int((~pending(data['status'].values)).sum())} of {runs} runs, which are"
        typer.echo(f"warpgran: interrupted {far} in the file; go on with --resume", err=True)


def print_summary(frame: Any) -> None:
    """A summary, at its full width where standard output is no terminal."""
    from rich.console import Console

    from warpgran.cli.table import WIDTH, rich_table

    terminal = Console()
    width = terminal.width if terminal.is_terminal else WIDTH
    Console(width=width).print(rich_table(frame, width=width))


def values_of(study: Study, run: int) -> str:
    """The swept values of a run, in brackets."""
    return f"({', '.join(f'{key} = {study.values(key)[run]}' for key in study.keys)}) " if study.keys else ""


def over(study: Study) -> str:
    """The swept keys, in words."""
    return f" over {', '.join(study.keys)}" if study.keys else ""


def least_steps(case: Any) -> int:
    """Least number of steps: those of a mass at rest."""
    h, _ = case.initial_state()
    return int(case.time.end * (case.g_c * h.max()) ** 0.5 / (case.scheme.cfl * case.dx)) + 1


def size(n: float) -> str:
    """Bytes with three digits."""
    for unit in ("B", "kB", "MB", "GB"):
        if n < 1000.0:
            return f"{n:.3g} {unit}"
        n /= 1000.0
    return f"{n:.3g} TB"
