"""The command `warpgran check`."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import typer

from warpgran.cli.arguments import Precision, RunFile, Set

if TYPE_CHECKING:
    from warpgran.case.case import Case


def check(file: RunFile, precision: Precision = "float64", set_: Set = None) -> None:
    """Check a run file without running it: grid, outputs, least number of steps, memory and file size."""
    from warpgran.analysis.units import unit_of
    from warpgran.case.read_study import read_study
    from warpgran.results.layout import Layout
    from warpgran.solve.state import bytes_of_run, bytes_of_start
    from warpgran.solve.variant import variant_of

    study = read_study(file, set_ or ())
    layout = Layout(study)
    cell_steps = sum(least_steps(case) * case.grid.cells for case in study)
    per_run = 8 * sum(math.prod(column.shape) for column in layout.columns.values())
    case, outputs = study.base, layout.outputs
    runs = "1 run" if len(study) == 1 else f"{len(study)} runs"
    over = f" over {', '.join(study.keys)}" if study.keys else ""
    typer.echo(f"{file}: {case.title or 'untitled'}")
    typer.echo(f"{runs}{over}")
    dx = unit_of(case.dx).text(case.dx)
    typer.echo(f"{layout.cells} cells of {dx}, t = {case.time.end:g} s, {least_steps(case)} steps or more")
    typer.echo(f"{outputs.snapshots} snapshots and {outputs.samples} samples")
    typer.echo(f"{cell_steps:.3g} cell-steps or more")
    variant = variant_of(case, precision)
    memory = bytes_of_run(layout.cells, outputs, variant) + bytes_of_start(
        layout.cells, case.scheme.start_levels, variant
    )
    typer.echo(f"memory: {size(memory)} a run being computed")
    typer.echo(f"file: {size(per_run * len(study))} before compression")


def least_steps(case: Case) -> int:
    """Least number of steps of a case: those of the initial column at rest, whose waves travel at sqrt(g_c h)."""
    h, _ = case.initial_state()
    return int(case.time.end * float(case.g_c * h.max()) ** 0.5 / (case.scheme.cfl * case.dx)) + 1


def size(n: float) -> str:
    """Bytes with three digits and a unit."""
    for unit in ("B", "kB", "MB", "GB"):
        if n < 1000.0:
            return f"{n:.3g} {unit}"
        n /= 1000.0
    return f"{n:.3g} TB"
