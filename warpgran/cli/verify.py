"""The command `warpgran verify`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from warpgran.cli.arguments import Device, Folder, Precision
from warpgran.cli.terminal import progress_bar, say, stdout, tell

WIDTH = 150
"""Characters of the table where standard output is no terminal."""


def verify(
    names: Annotated[list[str] | None, typer.Argument(metavar="NAME", help="Cases; default: all.")] = None,
    folder: Folder = Path("verification"),
    deep: Annotated[bool, typer.Option("--deep", help="The long cases too.")] = False,
    device: Device = "cpu",
    precision: Precision = "float64",
    order: Annotated[int | None, typer.Option(min=1, max=2, help="Scheme of this order alone; default: both.")] = None,
) -> None:
    """Compare with exact solutions: a table, figures and a page. Exit status 1 if a case does not hold."""
    from warpgran.solve.device import find_device, start_quietly
    from warpgran.verification.check import CheckOptions
    from warpgran.verification.collection import ORDERS, chosen, run
    from warpgran.verification.report import printed, write

    checks = chosen(names or [], deep)
    start_quietly()
    find_device(device)
    folder.mkdir(parents=True, exist_ok=True)
    options = CheckOptions(device, precision)
    with progress_bar("{task.completed:.0f} of {task.total:.0f} cases", len(checks)) as show:
        done = iter(range(len(checks)))
        outcomes = run(checks, options, (order,) if order else ORDERS, lambda name: show(next(done), len(checks), name))
        show(len(checks), len(checks), "done")
    page = write(outcomes, folder, options)
    stdout(WIDTH).print(printed(outcomes))
    failed = [name for name, outcome in outcomes.items() if not outcome.holds]
    say(f"{len(outcomes) - len(failed)} of {len(outcomes)} cases hold")
    if failed:
        tell(f"these do not: {', '.join(failed)}")
    say(f"wrote {page}")
    raise typer.Exit(1 if failed else 0)
