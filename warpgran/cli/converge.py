"""The command `warpgran converge`."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from warpgran.cli.arguments import Device, Precision, RunFile, Set
from warpgran.cli.report import warn_of
from warpgran.cli.terminal import print_whole, read, say, tell

if TYPE_CHECKING:
    from rich.table import Table

    from warpgran.studies.converge import Convergence


def converge(
    file: RunFile,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="PICTURE", help="Default: the run file's name, in this folder."),
    ] = None,
    levels: Annotated[int, typer.Option(help="Grids, from half the cells on, each with twice as many: 3 to 6.")] = 3,
    csv: Annotated[Path | None, typer.Option("--csv", help="Write the table as CSV, a row per quantity.")] = None,
    device: Device = "cpu",
    precision: Precision = "float64",
    set_: Set = None,
) -> None:
    """Measure how fine a grid must be: a run on half, the same and twice the cells, orders, limits and errors."""
    from warpgran.errors import CaveatWarning, OptionError
    from warpgran.figures.style import PLOT_SUFFIXES, checked
    from warpgran.files import MARK, check_ours, check_place, replacing
    from warpgran.run.options import Options
    from warpgran.solve.device import find_device, start_quietly
    from warpgran.studies.converge import converge

    study = read(file, set_)
    if len(study) > 1:
        raise OptionError(f"{file}: is a sweep of {len(study)} runs; allowed: a single run, so take the sweep out")
    warn_of(study)
    path = checked(output or Path(f"{file.stem}_convergence.png"), PLOT_SUFFIXES)
    heading = b"quantity,"
    for target, mark in ((path, MARK), *([(csv, heading)] if csv else [])):
        check_place(target)
        check_ours(target, mark)
    start_quietly()
    find_device(device)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CaveatWarning)  # told below
        found = converge(study.base, levels=levels, options=Options(device, precision))
    for line in found.reserves:
        tell(line)
    if study.base.title:
        say(study.base.title)
    print_whole(_table(found))
    say(found.verdict())
    found.plot(path)
    written = [str(path)]
    if csv:
        with replacing(csv, ours=heading) as part:
            found.table().to_csv(part, index_label="quantity", lineterminator="\n")
        written.append(str(csv))
    say(f"wrote {' and '.join(written)}")


def _table(found: Convergence) -> Table:
    """Values on each grid, in the units of the summary, with order, limit and the error of the user's grid."""
    from rich.table import Table

    table = Table(box=None, padding=(0, 2, 0, 0), pad_edge=False, header_style="bold")
    own = found.case.grid.cells
    table.add_column("\ncells:", no_wrap=True)
    for cells in found.cells:
        table.add_column(f"{'this grid' if cells == own else ''}\n{cells}", justify="right", no_wrap=True)
    for heading in ("\norder", "\nlimit", f"error on\n{own}", "cells for\n1 %"):
        table.add_column(heading, justify="right", no_wrap=True)
    for quantity in found.quantities:
        unit, factor, digits = _unit(quantity.name)
        shown = [f"{factor * value:.{digits}f}" for value in quantity.values]
        limit = f"{factor * quantity.limit:.{digits}f}" if quantity.limit == quantity.limit else "-"
        order = f"{quantity.order:.2f}" if quantity.order == quantity.order else "-"
        error = f"{quantity.errors[1]:.2%}" if quantity.limit == quantity.limit else "-"
        needed = quantity.needed()
        table.add_row(f"{quantity.name} ({unit})", *shown, order, limit, error, str(needed or "-"))
    return table


def _unit(name: str) -> tuple[str, float, int]:
    """Unit, factor from SI and decimals of a quantity."""
    if name == "stop time":
        return "s", 1.0, 3
    return ("%", 100.0, 3) if name == "dilation" else ("m", 1.0, 4)
