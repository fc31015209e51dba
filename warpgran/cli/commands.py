"""Commands of a few lines: `info`, `summary` and `merge`."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from warpgran.cli.arguments import ResultFile
from warpgran.cli.report import print_caveats, print_summary
from warpgran.cli.terminal import say, tell

NAMED = 8
"""Most missing runs that are named."""


def info() -> None:
    """Print versions, devices, and the folder of compiled kernels."""
    from importlib.metadata import version

    import warp as wp

    from warpgran.case.case import Case
    from warpgran.solve.device import devices, start_quietly
    from warpgran.solve.schedule import Outputs
    from warpgran.solve.state import bytes_of_run
    from warpgran.solve.variant import variant_of

    start_quietly()
    say(f"warpgran {version('warpgran')}, warp {wp.__version__}, numpy {version('numpy')}")
    say(f"python {sys.version.split()[0]}, {sys.platform}")
    for alias, name, memory in devices():
        sizes = {kind: bytes_of_run(1000, Outputs.none(), variant_of(Case(), kind)) for kind in ("float64", "float32")}
        runs = [f"{memory * 2**30 / each:,.0f} in {kind}" for kind, each in sizes.items()]
        say(f"device {alias}: {name}, {memory:.1f} GiB: runs of 1000 cells that fit: {', '.join(runs)}")
    say(f"compiled kernels: {wp.config.kernel_cache_dir}")


def summary(
    file: ResultFile,
    csv: Annotated[Path | None, typer.Option("--csv", help="Write the table as CSV, for pandas or R.")] = None,
) -> None:
    """Print a table of all runs: how each ended, run-out, height, dilation, stop time."""
    from warpgran.analysis.summary import summary, summary_columns, write_csv
    from warpgran.results.columns import opened_columns

    with opened_columns(file) as columns:
        table = summary_columns(columns)
        print_caveats(columns)
        if csv:
            say(f"wrote {write_csv(summary(columns), csv)}")
        else:
            print_summary(table)


def merge(
    output: Annotated[Path, typer.Argument(metavar="OUT.h5", help="File to write.")],
    shards: Annotated[list[Path], typer.Argument(metavar="SHARD.h5...", help="Files written by run --shard.")],
    force: Annotated[bool, typer.Option("--force", help="Replace what is there, whatever it is.")] = False,
) -> None:
    """Merge the shards of a study into one result file; exit status 1 if runs are missing."""
    from warpgran.results.merging import merge
    from warpgran.results.reading import open_dataset

    merged = merge(shards, output, force=force)
    with open_dataset(output) as data:
        print_caveats(data)
    say(f"wrote {output}, {merged.runs} runs")
    if merged.missing:
        which = ", ".join(map(str, merged.missing[:NAMED])) + (", ..." if len(merged.missing) > NAMED else "")
        tell(f"{len(merged.missing)} runs of the study are missing: {which}")
        raise typer.Exit(1)
