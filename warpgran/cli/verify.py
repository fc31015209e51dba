"""The command `warpgran verify`; `warpgran.cli` registers it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

WIDTH = 150
"""Of the table where standard output is no terminal, characters."""


def verify(
    names: Annotated[list[str] | None, typer.Argument(metavar="NAME", help="Cases; default: all.")] = None,
    folder: Annotated[Path, typer.Option("-o", "--output", metavar="FOLDER", help="Where to write.")] = Path(
        "verification"
    ),
    deep: Annotated[bool, typer.Option("--deep", help="The long cases too.")] = False,
    device: Annotated[str, typer.Option(help="cpu, cuda or cuda:N.")] = "cpu",
    precision: Annotated[Literal["float64", "float32"], typer.Option(help="Of the kernels.")] = "float64",
) -> None:
    """Compare with exact solutions: a table, figures and a page. Exit status 1 if a case does not hold."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

    from warpgran.solve.device import find_device, start_quietly
    from warpgran.verification.collection import chosen, run
    from warpgran.verification.outcome import Setting
    from warpgran.verification.report import printed, write

    checks = chosen(names or [], deep)
    start_quietly()
    find_device(device)
    folder.mkdir(parents=True, exist_ok=True)
    setting = Setting(device, precision)
    errors = Console(stderr=True)
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn())
    with Progress(*columns, console=errors, disable=not errors.is_terminal) as bar:
        task = bar.add_task("", total=len(checks))
        done = iter(range(len(checks)))
        outcomes = run(checks, setting, lambda name: bar.update(task, completed=next(done), description=name))
        bar.update(task, completed=len(checks), description="done")
    page = write(outcomes, folder, setting)
    terminal = Console()
    Console(width=terminal.width if terminal.is_terminal else WIDTH).print(printed(outcomes))
    failed = [name for name, outcome in outcomes.items() if not outcome.holds]
    typer.echo(f"{len(outcomes) - len(failed)} of {len(outcomes)} cases hold")
    if failed:
        typer.echo(f"warpgran: these do not: {', '.join(failed)}", err=True)
    typer.echo(f"wrote {page}")
    raise typer.Exit(1 if failed else 0)
