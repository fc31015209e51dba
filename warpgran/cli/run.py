"""The command `warpgran run`."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from warpgran.cli.arguments import Devices, Precision, RunFile, Set, bytes_of, shard_of
from warpgran.cli.pictures import worth_drawing
from warpgran.cli.report import report, warn_of
from warpgran.cli.terminal import read, say, study_bar, tell
from warpgran.errors import OptionError

if TYPE_CHECKING:
    from warpgran.arrays import Array
    from warpgran.run.options import Options
    from warpgran.run.outcome import Compute


def run(
    file: RunFile,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="OUT.h5", help="Default: the run file's name, in this folder."),
    ] = None,
    device: Devices = "cpu",
    precision: Precision = "float64",
    engine: Annotated[Literal["warp", "numpy"], typer.Option(help="Kernels, or the NumPy reference.")] = "warp",
    set_: Set = None,
    threads: Annotated[int | None, typer.Option(help="Blocks of runs computed at once; default: all cores.")] = None,
    memory: Annotated[
        str | None,
        typer.Option(metavar="SIZE", help="Memory of the runs computed at once, as 4GB; default: a quarter."),
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Compute only what an earlier start left out.")] = False,
    force: Annotated[
        bool, typer.Option("--force", help="Replace what is there: another result, or an earlier start.")
    ] = False,
    shard: Annotated[
        str | None, typer.Option(metavar="I/N", help="Compute the I-th of N shards; `warpgran merge` joins them.")
    ] = None,
    cluster: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="Compute on the workers of a dask scheduler, tcp://HOST:8786.")
    ] = None,
    picture: Annotated[bool, typer.Option("--picture/--no-picture", help="Plot the result beside the file.")] = True,
) -> None:
    """Compute a run file: an HDF5 file, a picture and a short table."""
    from warpgran.files import check_ours, check_place
    from warpgran.results.output import result_path
    from warpgran.results.reading import open_dataset
    from warpgran.run.options import Options
    from warpgran.run.to_file import run_to_file

    how = Options(device=device, precision=precision, engine=engine, threads=threads, memory=bytes_of(memory))
    study = read(file, set_)
    warn_of(study)
    runs, infix = shard_of(shard, len(study))
    path = output or Path(f"{file.stem}{infix}.h5")
    if picture:
        result_path(path, study.inputs)
        check_place(path.with_suffix(".png"))
        check_ours(path.with_suffix(".png"))
    if engine == "warp":
        from warpgran.solve.device import find_devices, start_quietly

        start_quietly()
        if cluster is None:
            find_devices(device)
    with _computing(cluster, how) as compute, study_bar(study, len(runs)) as progress:
        outcome = run_to_file(
            study, path, how, runs=runs, resume=resume, force=force, progress=progress, compute=compute
        )
    data = open_dataset(path)
    written = [str(path)]
    if picture and worth_drawing(data):
        from warpgran.figures.plot import plot

        written.append(str(plot(data, path.with_suffix(".png"))))
    report(study, data, outcome)
    say(f"wrote {' and '.join(written)}")
    raise typer.Exit(130 if outcome.interrupted else exit_status(data["status"].values))


@contextmanager
def _computing(cluster: str | None, how: Options) -> Iterator[Compute]:
    """What computes: the threads of this machine, or the cluster of a scheduler."""
    if cluster is None:
        from warpgran.run import threads

        yield threads.compute
        return
    if how.threads is not None:
        raise OptionError("threads: has no part with --cluster; allowed: --nthreads of dask worker")
    from warpgran.run.cluster import compute, connect, threads_of

    with connect(cluster) as client:
        if not threads_of(client):
            tell(f"{cluster} has no worker yet; waiting for one")
        yield partial(compute, client=client)


def exit_status(status: Array) -> int:
    """0 if all runs ended as they should, 130 if any was interrupted, 1 if any ended otherwise."""
    from warpgran.schema import Status

    found = {Status(code) for code in set(status.tolist())}
    if found & {Status.INTERRUPTED, Status.PENDING}:
        return 130
    return 0 if all(s.clean for s in found) else 1
