"""Commands of a few lines: `check`, `info`, `summary` and `merge`."""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Annotated

import typer

from warpgran.cli.arguments import FileArgument, PrecisionOption, ResultArgument, SetOption
from warpgran.cli.told import least_steps, over, print_summary, size


def check(file: FileArgument, precision: PrecisionOption = "float64", set_: SetOption = None) -> None:
    """Check a run file and say what it asks for, without running it."""
    from warpgran.case.read_study import read_study
    from warpgran.results.layout import Layout
    from warpgran.solve.state import bytes_of_run

    study = read_study(file, set_ or ())
    layout = Layout(study)
    cell_steps = sum(least_steps(case) * case.grid.cells for case in study)
    per_run = 8 * sum(math.prod(column.shape) for column in layout.columns.values())
    case, outputs = study.base, layout.outputs
    runs = "1 run" if len(study) == 1 else f"{len(study)} runs"
    typer.echo(f"{file}: {case.title or 'untitled'}")
    typer.echo(f"{runs}{over(study)}")
    typer.echo(
        f"{layout.cells} cells of {case.dx * 1e3:.4g} mm, t = {case.time.end:g} s, {least_steps(case)} steps or more"
    )
    typer.echo(f"{outputs.snapshots} snapshots and {outputs.samples} samples")
    typer.echo(f"{cell_steps:.3g} cell-steps or more")
    typer.echo(f"memory: {size(bytes_of_run(layout.cells, outputs, precision))} a run being computed")
    typer.echo(f"file: {size(per_run * len(study))} before compression")


def info() -> None:
    """Versions, devices, and where compiled kernels are kept."""
    from importlib.metadata import version

    import warp as wp

    from warpgran.solve.device import devices, start_quietly
    from warpgran.solve.schedule import Outputs
    from warpgran.solve.state import bytes_of_run

    start_quietly()
    typer.echo(f"warpgran {version('warpgran')}, warp {wp.__version__}, numpy {version('numpy')}")
    typer.echo(f"python {sys.version.split()[0]}, {sys.platform}")
    for alias, name, memory in devices():
        runs = [f"{memory * 2**30 / bytes_of_run(1000, Outputs.none(), precision):,.0f} in {precision}"
                for precision in ("float64", "float32")]  # fmt: skip
        typer.echo(f"device {alias}: {name}, {memory:.1f} GiB: runs of 1000 cells that fit: {', '.join(runs)}")
    typer.echo(f"compiled kernels: {wp.config.kernel_cache_dir}")


def summary(
    file: ResultArgument,
    csv: Annotated[Path | None, typer.Option("--csv", help="Write the table, a row a run, for pandas or R.")] = None,
) -> None:
    """Print a table with a row a run."""
    from warpgran.analysis.summary import summary, write_csv
    from warpgran.results.reading import open_dataset

    frame = summary(open_dataset(file))
    if csv:
        typer.echo(f"wrote {write_csv(frame, csv)}")
    else:
        print_summary(frame)


def merge(
    output: Annotated[Path, typer.Argument(metavar="OUT.h5", help="File to write.")],
    shards: Annotated[list[Path], typer.Argument(metavar="SHARD.h5...", help="Files that --shard wrote.")],
) -> None:
    """Join the shares of a study."""
    from warpgran.results.merging import merge

    runs = merge(shards, output)
    typer.echo(f"wrote {output}, {runs} runs")
