"""The command `warpgran reproduce`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from warpgran.cli.arguments import Devices, Folder, Precision, Set
from warpgran.cli.terminal import progress_bar, say, tell
from warpgran.errors import OptionError


def reproduce(
    figures: Annotated[list[str] | None, typer.Argument(metavar="FIGURE", help="fig02 to fig25; default: all.")] = None,
    output: Folder = Path("paper"),
    data: Annotated[
        Path | None, typer.Option("--data", metavar="FOLDER", help="Laboratory measurements to plot over the figures.")
    ] = None,
    runs: Annotated[
        Path | None, typer.Option("--runs", metavar="FOLDER", help="Run files to use instead of those that ship.")
    ] = None,
    setting: Annotated[
        str, typer.Option(metavar="NAME", help="Setting of the figures: defaults, paper_form, ...: docs/paper.md.")
    ] = "defaults",
    claims: Annotated[bool, typer.Option("--claims/--no-claims", help="Judge the claims of the paper.")] = True,
    set_: Set = None,
    device: Devices = "cpu",
    precision: Precision = "float64",
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
        with progress_bar() as show:
            page = reproduce(plan, lambda name, runs, done: show(done, runs, name), print)
    except KeyboardInterrupt:
        tell("interrupted; what was computed is kept, start again to resume")
        raise typer.Exit(130) from None
    say(f"wrote {page}")
