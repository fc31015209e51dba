"""The command `warpgran run`."""

from __future__ import annotations

from contextlib import nullcontext
from typing import Annotated

import typer

from warpgran.cli.arguments import (
    Cluster,
    Devices,
    Engine,
    Force,
    Memory,
    OutputFile,
    Precision,
    Resume,
    RunFile,
    Set,
    Shard,
    Threads,
    bytes_of,
)
from warpgran.cli.computing import compute_file, exit_status
from warpgran.cli.drawing import SUFFIX, Drawing
from warpgran.cli.report import report
from warpgran.cli.terminal import read, say
from warpgran.cli.view import page_beside


def run(
    file: RunFile,
    output: OutputFile = None,
    device: Devices = "cpu",
    precision: Precision = "float64",
    engine: Engine = "warp",
    set_: Set = None,
    threads: Threads = None,
    memory: Memory = None,
    resume: Resume = False,
    force: Force = False,
    shard: Shard = None,
    cluster: Cluster = None,
    picture: Annotated[bool, typer.Option("--picture/--no-picture", help="Plot the result beside the file.")] = True,
    view: Annotated[bool, typer.Option("--view", help="Write a page to look at the result in a browser.")] = False,
) -> None:
    """Compute a run file: an HDF5 file, a picture and a short table."""
    with Drawing() if picture else nullcontext() as drawing:
        from warpgran.results.columns import opened_columns
        from warpgran.run.options import Options

        how = Options(device=device, precision=precision, engine=engine, threads=threads, memory=bytes_of(memory))
        study = read(file, set_)
        suffixes = [suffix for suffix, asked in ((SUFFIX, picture), (".html", view)) if asked]
        path, outcome = compute_file(
            file, study, output, how, resume=resume, force=force, shard=shard, cluster=cluster,
            pictures=suffixes,
        )  # fmt: skip
        if drawing:
            drawing.begin(path)
        written = [str(path)]
        with opened_columns(path) as columns:
            report(study, columns, outcome)
            written += drawing.end(path, columns) if drawing else []
            written += page_beside(path) if view else []
    say(f"wrote {' and '.join(written)}")
    raise typer.Exit(130 if outcome.interrupted else exit_status(columns.status))
