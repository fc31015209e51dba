"""`warpgran reproduce`, as the command line has it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Literal

import typer

from warpgran.errors import OptionError


def reproduce(
    figures: Annotated[
        list[str] | None, typer.Argument(metavar="[FIGURE]...", help="fig02 to fig25; default: all.")
    ] = None,
    output: Annotated[Path, typer.Option("-o", "--output", metavar="FOLDER", help="Where to write.")] = Path("paper"),
    data: Annotated[
        Path | None, typer.Option("--data", metavar="FOLDER", help="Laboratory measurements to lay over the figures.")
    ] = None,
    runs: Annotated[
        Path | None, typer.Option("--runs", metavar="FOLDER", help="Run files to use instead of those that ship.")
    ] = None,
    setting: Annotated[
        str, typer.Option(metavar="NAME", help="What is drawn: defaults, paper_form, defaults_2x, ...: docs/paper.md.")
    ] = "defaults",
    claims: Annotated[bool, typer.Option("--claims/--no-claims", help="Judge what the paper states.")] = True,
    set_: Annotated[
        list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Change a key of every run file; repeatable.")
    ] = None,
    device: Annotated[str, typer.Option(help="cpu, cuda, cuda:N, or several: cuda:0,cuda:1.")] = "cpu",
    precision: Annotated[Literal["float64", "float32"], typer.Option(help="Of the kernels.")] = "float64",
) -> None:
    """Compute the paper's figures and judge its claims: a folder of pictures, claims.csv and one HTML page."""
    from warpgran.paper.catalogue import chosen
    from warpgran.paper.laboratory import Laboratory, read_laboratory
    from warpgran.paper.reproduce import Plan, reproduce, shipped_runs
    from warpgran.paper.settings import setting_named
    from warpgran.run.options import Options
    from warpgran.solve.device import find_devices, start_quietly

    names = tuple(figures or ())
    chosen(names)
    if runs is not None and not runs.is_dir():
        raise OptionError(f"runs: {runs} is not a folder of run files")
    drawn = setting_named(setting)
    laboratory = read_laboratory(data) if data else Laboratory()
    how = Options(device, precision)
    plan = Plan(runs or shipped_runs(), output, names, laboratory, how, tuple(set_ or ()), drawn, claims)
    start_quietly()
    find_devices(device)
    try:
        with _progress() as (progress, tell):
            page = reproduce(plan, progress, tell)
    except KeyboardInterrupt:
        typer.echo("warpgran: interrupted; what was computed is kept, start again to go on", err=True)
        raise typer.Exit(130) from None
    typer.echo(f"wrote {page}")


@contextmanager
def _progress() -> Iterator[tuple[Callable[[str, int, float], None], Callable[[str], None]]]:
    """A progress bar on standard error for what is being computed, and lines on standard output for what is done."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn

    console = Console(stderr=True)
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.completed:.0f} of {task.total:.0f} runs"),
    )
    with Progress(*columns, console=console, disable=not console.is_terminal, transient=True) as bar:
        task = bar.add_task("preparing", total=1)

        def show(name: str, runs: int, done: float) -> None:
            bar.update(task, description=name, total=runs, completed=done)

        yield show, typer.echo
