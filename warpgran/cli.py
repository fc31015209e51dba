"""The command line. Exit status: 0 done, 1 some runs did not finish cleanly, 2 bad input, 130 interrupted."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

if TYPE_CHECKING:
    from warpgran.case import Case
    from warpgran.results import Results

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
RunOption = Annotated[int, typer.Option("--run", min=0, help="Which run of the file.")]


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
    device: Annotated[str, typer.Option(help="cpu, cuda or cuda:N.")] = "cpu",
    precision: Annotated[Literal["float64", "float32"], typer.Option(help="Of the kernels.")] = "float64",
    engine: Annotated[Literal["warp", "numpy"], typer.Option(help="Kernels, or the NumPy reference.")] = "warp",
    set_: SetOption = None,
    picture: Annotated[bool, typer.Option("--picture/--no-picture", help="Draw the result beside the file.")] = True,
) -> None:
    """Compute a run file: an HDF5 file, a picture and a short table."""
    with _errors():
        from warpgran import storage
        from warpgran.case import Case
        from warpgran.simulation import compute

        case = Case.from_toml(file, set_ or ())
        path = output or Path(f"{file.stem}.h5")
        if engine == "warp":
            from warpgran.device import start_quietly

            start_quietly()
        with storage.replacing(path) as part:
            with _progress(case) as progress:
                results, failures = compute(
                    [case], device=device, precision=precision, engine=engine, progress=progress
                )
            storage.write(results, part)
        written = [str(path)]
        if picture and _worth_drawing(results):
            from warpgran.figures import plot

            written.append(str(plot(storage.open_dataset(path), path.with_suffix(".png"))))
    for failure in failures:
        typer.echo(f"warpgran: {failure}", err=True)
    _table(results)
    _say_speed(results)
    typer.echo(f"wrote {' and '.join(written)}")
    raise typer.Exit(_exit_status(results))


@app.command()
def check(file: FileArgument, set_: SetOption = None) -> None:
    """Check a run file and say what it asks for, without running it."""
    with _errors():
        from warpgran.case import Case

        case = Case.from_toml(file, set_ or ())
    snapshots, samples, cells = len(case.snapshot_times), len(case.sample_times), case.grid.cells
    typer.echo(f"{file}: {case.title or 'untitled'}")
    typer.echo(f"{cells} cells of {case.dx * 1e3:.4g} mm, t = {case.time.end:g} s, {_steps(case)} steps or more")
    typer.echo(f"{snapshots} snapshots and {samples} samples, a file of about {_size(24 * snapshots * cells)}")


@app.command()
def info() -> None:
    """Versions, devices, and where compiled kernels are kept."""
    with _errors():
        from importlib.metadata import version

        import warp as wp

        from warpgran.device import devices, start_quietly

        start_quietly()
    typer.echo(f"warpgran {version('warpgran')}, warp {wp.__version__}, numpy {version('numpy')}")
    typer.echo(f"python {sys.version.split()[0]}, {sys.platform}")
    for alias, name, memory in devices():
        typer.echo(f"device {alias}: {name}, {memory:.1f} GiB")
    typer.echo(f"compiled kernels: {wp.config.kernel_cache_dir}")


@app.command()
def plot(
    file: ResultArgument,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="PNG, PDF or SVG; default: beside it.")] = None,
    run: RunOption = 0,
) -> None:
    """Draw profiles at the snapshots, and the series beside them."""
    with _errors():
        from warpgran import figures, storage

        made = figures.plot(storage.open_dataset(file), output or file.with_suffix(".png"), run=run)
    typer.echo(f"wrote {made}")


@app.command()
def animate(
    file: ResultArgument,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="GIF or MP4; default: a GIF beside it.")] = None,
    run: RunOption = 0,
    fps: Annotated[int, typer.Option(min=1, max=60, help="Snapshots shown a second.")] = 12,
) -> None:
    """Draw the collapse on its slope, coloured by the volume fraction, as a film of the snapshots."""
    with _errors():
        from warpgran import figures, storage

        made = figures.animate(storage.open_dataset(file), output or file.with_suffix(".gif"), run=run, fps=fps)
    typer.echo(f"wrote {made}")


@contextmanager
def _errors() -> Iterator[None]:
    """What a user can cause is told in a line, exit status 2; all else is our fault and keeps its traceback."""
    from warpgran.errors import CaseError
    from warpgran.storage import StorageError

    try:
        yield
    except (CaseError, StorageError, ValueError, OSError) as error:
        if _debug:
            raise
        for line in str(error).splitlines():
            typer.echo(f"warpgran: {line}", err=True)
        raise typer.Exit(2) from None


@contextmanager
def _progress(case: Case) -> Iterator[Callable[[float], None]]:
    """A progress bar in simulated time on standard error; nothing where that is no terminal."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    console = Console(stderr=True)
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("t = {task.completed:.3f} of {task.total:g} s"),
    )
    with Progress(*columns, TimeRemainingColumn(), console=console, disable=not console.is_terminal) as bar:
        task = bar.add_task("preparing kernels", total=case.time.end)

        def show(t: float) -> None:
            bar.update(task, completed=t, description=case.title or "computing")

        yield show


def _table(results: Results) -> None:
    """The last value of each series that matters, a row a run."""
    from rich.console import Console
    from rich.table import Table

    table = Table(title=results.cases[0].title or None, title_justify="left", box=None, padding=(0, 2, 0, 0))
    for name in ("status", "t (s)", "front (m)", "max h (cm)", "volume (%)", "stop (s)", "steps"):
        table.add_column(name, justify="right", no_wrap=True)
    for r in range(len(results.cases)):
        last = results.last_sample(r)
        table.add_row(
            results.status_word(r), f"{results.end_time[r]:.4g}", _number(last["front"], ".4f"),
            _number(100 * last["h_max"], ".3f"), _number(100 * last["volume_change"], "+.2f"),
            _number(results.stop_time[r], ".3g"), str(results.steps[r]),
        )  # fmt: skip
    Console().print(table)


def _say_speed(results: Results) -> None:
    steps, seconds = results.attributes["cell_steps"], results.attributes["kernel_seconds"]
    if seconds > 0.0:
        typer.echo(
            f"{steps / 1e6:.1f} million cell-steps in {seconds:.3f} s: {steps / seconds / 1e6:.1f} million a second"
        )


def _number(value: float, form: str) -> str:
    return "-" if value != value else format(value, form)


def _worth_drawing(results: Results) -> bool:
    return bool(results.time.size or results.series_time.size > 1)


def _exit_status(results: Results) -> int:
    from warpgran.schema import Status

    if (results.status == Status.INTERRUPTED).any():
        stored = int((results.time <= results.end_time.max()).sum())
        message = f"interrupted at t = {results.end_time.max():.4g} s of {results.cases[0].time.end:g} s"
        typer.echo(f"warpgran: {message}; {stored} of {results.time.size} snapshots are in the file", err=True)
        return 130
    return 0 if (results.status == Status.OK).all() else 1


def _steps(case: Case) -> int:
    """Least number of steps: those of a mass at rest."""
    h, _ = case.initial_state()
    return int(case.time.end * (case.g_c * h.max()) ** 0.5 / (case.scheme.cfl * case.dx)) + 1


def _size(n: float) -> str:
    for unit in ("B", "kB", "MB", "GB"):
        if n < 1000.0:
            return f"{n:.3g} {unit}"
        n /= 1000.0
    return f"{n:.3g} TB"
