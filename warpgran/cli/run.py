"""The command `warpgran run`."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from warpgran.cli.arguments import FileArgument, PrecisionOption, SetOption, bytes_of, share_of
from warpgran.cli.drawn import draw, worth_drawing
from warpgran.cli.progress import run_progress
from warpgran.cli.told import report, values_of
from warpgran.errors import OptionError

if TYPE_CHECKING:
    from warpgran.run.options import Options
    from warpgran.run.to_file import Compute


def run(
    file: FileArgument,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="OUT.h5", help="Default: the run file's name, here.")
    ] = None,
    device: Annotated[str, typer.Option(help="cpu, cuda, cuda:N, or several: cuda:0,cuda:1.")] = "cpu",
    precision: PrecisionOption = "float64",
    engine: Annotated[Literal["warp", "numpy"], typer.Option(help="Kernels, or the NumPy reference.")] = "warp",
    set_: SetOption = None,
    threads: Annotated[int | None, typer.Option(help="Blocks of runs at once; default: all cores.")] = None,
    memory: Annotated[
        str | None, typer.Option(metavar="SIZE", help="For the runs being computed, as 4GB; default: a quarter.")
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Compute only what an earlier start left out.")] = False,
    shard: Annotated[
        str | None, typer.Option(metavar="I/N", help="Compute the I-th of N shares; `warpgran merge` joins them.")
    ] = None,
    cluster: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="Compute on the workers of a dask scheduler, tcp://HOST:8786.")
    ] = None,
    picture: Annotated[bool, typer.Option("--picture/--no-picture", help="Draw the result beside the file.")] = True,
) -> None:
    """Compute a run file: an HDF5 file, a picture and a short table."""
    from warpgran.case.read_study import read_study
    from warpgran.results.reading import open_dataset
    from warpgran.run.options import Options
    from warpgran.run.to_file import exit_status, run_to_file

    how = Options(device, precision, engine, threads, bytes_of(memory))
    study = read_study(file, set_ or ())
    share, suffix = share_of(shard, len(study))
    path = output or Path(f"{file.stem}{suffix}.h5")
    if engine == "warp":
        from warpgran.solve.device import find_devices, start_quietly

        start_quietly()
        if cluster is None:
            find_devices(device)
    with _where(cluster, how) as (how, compute), run_progress(study, len(share)) as progress:
        outcome = run_to_file(study, path, how, runs=share, resume=resume, progress=progress, compute=compute)
    data = open_dataset(path)
    written = [str(path)]
    if picture and worth_drawing(data):
        written.append(str(draw(data, path.with_suffix(".png"), None)))
    for number, words in sorted(outcome.failures.items()):
        typer.echo(f"warpgran: run {number} {values_of(study, number)}{words}", err=True)
    report(study, data, outcome)
    typer.echo(f"wrote {' and '.join(written)}")
    raise typer.Exit(exit_status(data["status"].values))


@contextmanager
def _where(cluster: str | None, how: Options) -> Iterator[tuple[Options, Compute]]:
    """How and by what blocks are computed: here, or on the workers of a scheduler."""
    from warpgran.run.threads import compute as on_threads

    if cluster is None:
        yield how, on_threads
        return
    if how.threads is not None:
        raise OptionError("threads: has no part with --cluster; allowed: --nthreads of dask worker")
    from warpgran.run.cluster import compute, connect, threads_of

    with connect(cluster) as client:
        threads = threads_of(client)
        if not threads:
            typer.echo(f"warpgran: {cluster} has no worker yet; waiting for one", err=True)
        yield replace(how, threads=threads or None), partial(compute, client=client)
