"""The command line. Exit status: 0 done, 1 some runs did not finish cleanly, 2 bad input, 130 interrupted."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import partial, wraps
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from warpgran.paper.command import reproduce
from warpgran.verify import verify

if TYPE_CHECKING:
    import xarray as xr

    from warpgran.jobs import Compute
    from warpgran.simulation import Options, Outcome
    from warpgran.sweep import Study

app = typer.Typer(
    name="warpgran",
    help="Granular collapses with dilatancy: a depth-averaged compressible mu(I) model.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    add_completion=False,
)
_debug = False

FileArgument = Annotated[Path, typer.Argument(metavar="FILE", help="Run file, TOML.")]
ResultArgument = Annotated[Path, typer.Argument(metavar="OUT.h5", help="Result file.")]
SetOption = Annotated[
    list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Change a key of the run file; repeatable.")
]
PrecisionOption = Annotated[Literal["float64", "float32"], typer.Option(help="Of the kernels.")]
OutputOption = Annotated[Path | None, typer.Option("-o", "--output", help="File to write; default: beside it.")]


def main() -> None:
    """Entry point of the `warpgran` command."""
    app()


@app.callback()
def options(
    debug: Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")] = False,
) -> None:
    """Granular collapses with dilatancy: a depth-averaged compressible mu(I) model."""
    global _debug
    _debug = debug


@app.command()
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
    with _errors():
        from warpgran.jobs import exit_status, run_to_file
        from warpgran.simulation import Options
        from warpgran.storage import open_dataset
        from warpgran.sweep import read_study

        how = Options(device, precision, engine, threads, _bytes(memory))
        study = read_study(file, set_ or ())
        share, suffix = _share(shard, len(study))
        path = output or Path(f"{file.stem}{suffix}.h5")
        if engine == "warp":
            from warpgran.device import find_devices, start_quietly

            start_quietly()
            if cluster is None:
                find_devices(device)
        with _where(cluster, how) as (how, compute), _progress(study, len(share)) as progress:
            outcome = run_to_file(study, path, how, runs=share, resume=resume, progress=progress, compute=compute)
        data = open_dataset(path)
        written = [str(path)]
        if picture and _worth_drawing(data):
            written.append(str(_draw(data, path.with_suffix(".png"), None)))
    for number, words in sorted(outcome.failures.items()):
        typer.echo(f"warpgran: run {number} {_values(study, number)}{words}", err=True)
    _tell(study, data, outcome)
    typer.echo(f"wrote {' and '.join(written)}")
    raise typer.Exit(exit_status(data["status"].values))


@app.command()
def check(file: FileArgument, precision: PrecisionOption = "float64", set_: SetOption = None) -> None:
    """Check a run file and say what it asks for, without running it."""
    with _errors():
        from warpgran.results import Layout
        from warpgran.state import bytes_of_run
        from warpgran.sweep import read_study

        study = read_study(file, set_ or ())
        layout = Layout(study)
        cell_steps = sum(_steps(case) * case.grid.cells for case in study)
        per_run = 8 * sum(_product(column.shape) for column in layout.columns.values())
    case, outputs = study.base, layout.outputs
    runs = "1 run" if len(study) == 1 else f"{len(study)} runs"
    typer.echo(f"{file}: {case.title or 'untitled'}")
    typer.echo(f"{runs}{_over(study)}")
    typer.echo(f"{layout.cells} cells of {case.dx * 1e3:.4g} mm, t = {case.time.end:g} s, {_steps(case)} steps or more")
    typer.echo(f"{outputs.snapshots} snapshots and {outputs.samples} samples")
    typer.echo(f"{cell_steps:.3g} cell-steps or more")
    typer.echo(f"memory: {_size(bytes_of_run(layout.cells, outputs, precision))} a run being computed")
    typer.echo(f"file: {_size(per_run * len(study))} before compression")


@app.command()
def info() -> None:
    """Versions, devices, and where compiled kernels are kept."""
    with _errors():
        from importlib.metadata import version

        import warp as wp

        from warpgran.device import devices, start_quietly
        from warpgran.outputs import Outputs
        from warpgran.state import bytes_of_run

        start_quietly()
    typer.echo(f"warpgran {version('warpgran')}, warp {wp.__version__}, numpy {version('numpy')}")
    typer.echo(f"python {sys.version.split()[0]}, {sys.platform}")
    for alias, name, memory in devices():
        runs = [f"{memory * 2**30 / bytes_of_run(1000, Outputs.none(), precision):,.0f} in {precision}"
                for precision in ("float64", "float32")]  # fmt: skip
        typer.echo(f"device {alias}: {name}, {memory:.1f} GiB: runs of 1000 cells that fit: {', '.join(runs)}")
    typer.echo(f"compiled kernels: {wp.config.kernel_cache_dir}")


@app.command()
def plot(
    file: ResultArgument,
    output: OutputOption = None,
    run: Annotated[int | None, typer.Option("--run", min=0, help="One run of a batch; default: all together.")] = None,
) -> None:
    """Draw one run (profiles at the snapshots, series beside them), or a batch against what was swept."""
    with _errors():
        from warpgran.storage import open_dataset

        made = _draw(open_dataset(file), output or file.with_suffix(".png"), run)
    typer.echo(f"wrote {made}")


@app.command()
def animate(
    file: ResultArgument,
    output: OutputOption = None,
    run: Annotated[int, typer.Option("--run", min=0, help="Which run of the file.")] = 0,
    fps: Annotated[int, typer.Option(min=1, max=60, help="Snapshots shown a second.")] = 12,
) -> None:
    """Draw the collapse on its slope, coloured by the volume fraction, as a film (GIF or MP4) of the snapshots."""
    with _errors():
        from warpgran.animation import animate
        from warpgran.storage import open_dataset

        made = animate(open_dataset(file), output or file.with_suffix(".gif"), run=run, fps=fps)
    typer.echo(f"wrote {made}")


@app.command()
def summary(
    file: ResultArgument,
    csv: Annotated[Path | None, typer.Option("--csv", help="Write the table, a row a run, for pandas or R.")] = None,
) -> None:
    """Print a table with a row a run."""
    with _errors():
        from warpgran.storage import open_dataset
        from warpgran.summary import summary, write_csv

        frame = summary(open_dataset(file))
        if csv:
            typer.echo(f"wrote {write_csv(frame, csv)}")
        else:
            _print(frame)


@app.command()
def merge(
    output: Annotated[Path, typer.Argument(metavar="OUT.h5", help="File to write.")],
    shards: Annotated[list[Path], typer.Argument(metavar="SHARD.h5...", help="Files that --shard wrote.")],
) -> None:
    """Join the shares of a study."""
    with _errors():
        from warpgran.merging import merge

        runs = merge(shards, output)
    typer.echo(f"wrote {output}, {runs} runs")


def _draw(data: xr.Dataset, path: Path, run: int | None) -> Path:
    if run is None and data.sizes["run"] > 1:
        from warpgran.batch_figures import plot_batch

        return plot_batch(data, path)
    from warpgran.figures import plot

    return plot(data, path, run=run or 0)


@contextmanager
def _errors() -> Iterator[None]:
    """What a user can cause is told in a line, exit status 2; all else is our fault and keeps its traceback."""
    from warpgran.errors import CaseError
    from warpgran.storage import StorageError

    try:
        yield
    except (CaseError, StorageError, ValueError, OSError, MemoryError, ModuleNotFoundError) as error:
        if _debug:
            raise
        for line in str(error).splitlines():
            typer.echo(f"warpgran: {line}", err=True)
        raise typer.Exit(2) from None


def _guarded(command: Callable[..., None]) -> Callable[..., None]:
    """A command from a module of its own, its errors told as those of the commands here."""

    @wraps(command)
    def guarded(*args: Any, **kwargs: Any) -> None:
        with _errors():
            command(*args, **kwargs)

    return guarded


app.command()(_guarded(verify))
app.command()(_guarded(reproduce))


@contextmanager
def _where(cluster: str | None, how: Options) -> Iterator[tuple[Options, Compute]]:
    """How and by what blocks are computed: here, or on the workers of a scheduler."""
    from warpgran import simulation

    if cluster is None:
        yield how, simulation.compute
        return
    if how.threads is not None:
        raise ValueError("threads: has no part with --cluster; allowed: --nthreads of dask worker")
    from warpgran.cluster import compute, connect, threads_of

    with connect(cluster) as client:
        threads = threads_of(client)
        if not threads:
            typer.echo(f"warpgran: {cluster} has no worker yet; waiting for one", err=True)
        yield replace(how, threads=threads or None), partial(compute, client=client)


@contextmanager
def _progress(study: Study, runs: int) -> Iterator[Callable[[float], None]]:
    """A progress bar on standard error, in simulated time for one run; nothing where that is no terminal."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    console = Console(stderr=True)
    end = study.base.time.end
    per_run, form = (end, f"t = {{task.completed:.3f}} of {end:g} s") if runs == 1 else (1.0, "{task.completed:.0f} of "
                                                                                         f"{runs} runs")  # fmt: skip
    columns = (TextColumn("{task.description}"), BarColumn(), TextColumn(form), TimeRemainingColumn())
    with Progress(*columns, console=console, disable=not console.is_terminal) as bar:
        task = bar.add_task("preparing kernels", total=runs * per_run)

        def show(done: float) -> None:
            bar.update(task, completed=done * per_run, description=study.base.title or "computing")

        yield show


def _tell(study: Study, data: xr.Dataset, outcome: Outcome) -> None:
    """Table, speed, and how far an interrupted study got."""
    from warpgran.storage import pending
    from warpgran.summary import summary

    if study.base.title:
        typer.echo(study.base.title)
    _print(summary(data))
    if outcome.kernel_seconds > 0.0:
        steps, seconds = outcome.cell_steps / 1e6, outcome.kernel_seconds
        typer.echo(f"{steps:.1f} million cell-steps in {seconds:.3f} s: {steps / seconds:.1f} million a second")
    if outcome.interrupted and pending(data["status"].values).any():
        runs, t = data.sizes["run"], float(data["end_time"].max())
        if runs == 1:
            stored = int((data["time"] <= t).sum())
            far = f"at t = {t:.4g} s of {study.base.time.end:g} s; {stored} of {data.sizes['time']} snapshots are"
        else:
            far = f"after {int((~pending(data['status'].values)).sum())} of {runs} runs, which are"
        typer.echo(f"warpgran: interrupted {far} in the file; go on with --resume", err=True)


def _print(frame: Any) -> None:
    """A summary, at its full width where standard output is no terminal."""
    from rich.console import Console

    from warpgran.summary import WIDTH, rich_table

    terminal = Console()
    width = terminal.width if terminal.is_terminal else WIDTH
    Console(width=width).print(rich_table(frame, width=width))


def _values(study: Study, run: int) -> str:
    """The swept values of a run, in brackets."""
    return f"({', '.join(f'{key} = {study.values(key)[run]}' for key in study.keys)}) " if study.keys else ""


def _over(study: Study) -> str:
    return f" over {', '.join(study.keys)}" if study.keys else ""


def _worth_drawing(data: xr.Dataset) -> bool:
    """Whether there is a sample or a snapshot of some run."""
    reached = data["end_time"].max()
    return bool(data["front"].notnull().any() or (data["time"] <= reached).any())


def _share(shard: str | None, runs: int) -> tuple[list[int], str]:
    """The runs of a share, and what it adds to the file's name."""
    if shard is None:
        return list(range(runs)), ""
    first, _, of = shard.partition("/")
    if not (first.isdigit() and of.isdigit() and 1 <= int(first) <= int(of) <= runs):
        raise ValueError(
            f"shard: {shard!r} is not a share; allowed: I/N with 1 <= I <= N <= {runs}, the number of runs"
        )
    return list(range(int(first) - 1, runs, int(of))), f".{int(first)}-of-{int(of)}"


def _bytes(text: str | None) -> float | None:
    """A size such as 500MB, 4GB or 1.5GiB in bytes."""
    if text is None:
        return None
    number = text.rstrip("BbIi").rstrip()
    unit = {"K": 3, "M": 6, "G": 9, "T": 12}.get(number[-1:].upper(), 0)
    try:
        return float(number[:-1] if unit else number) * 10.0**unit
    except ValueError:
        raise ValueError(f"memory: {text!r} is not a size; allowed: a number of bytes, or as 500MB, 4GB") from None


def _steps(case: Any) -> int:
    """Least number of steps: those of a mass at rest."""
    h, _ = case.initial_state()
    return int(case.time.end * (case.g_c * h.max()) ** 0.5 / (case.scheme.cfl * case.dx)) + 1


def _product(shape: tuple[int, ...]) -> int:
    result = 1
    for n in shape:
        result *= n
    return result


def _size(n: float) -> str:
    for unit in ("B", "kB", "MB", "GB"):
        if n < 1000.0:
            return f"{n:.3g} {unit}"
        n /= 1000.0
    return f"{n:.3g} TB"
