"""The commands `warpgran plot` and `warpgran animate`, and what a run writes beside its result."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import Annotated

import typer

from warpgran.cli.arguments import Picture, ResultFile
from warpgran.cli.report import print_caveats
from warpgran.cli.terminal import say, tell
from warpgran.errors import WarpgranError


def plot(
    files: Annotated[list[Path], typer.Argument(metavar="OUT.h5...", help="Result files; several: over each other.")],
    output: Picture = None,
    run: Annotated[
        int | None, typer.Option("--run", min=0, help="One run of a batch, or of each file; default: all together.")
    ] = None,
) -> None:
    """Plot one run (profiles, time series), a batch (results over the swept keys), or files over each other."""
    from warpgran.figures.plot import plot
    from warpgran.results.columns import opened_columns

    made = output or _beside(files, run, ".png")
    with ExitStack() as stack:
        results = [stack.enter_context(opened_columns(file)) for file in files]
        plot(*results, run=run, path=made)
        for file, data in zip(files, results, strict=True):
            print_caveats(data if run is None else data.pick(run), of=file.name if len(files) > 1 else "")
    say(f"wrote {made}")


def animate(
    file: ResultFile,
    output: Picture = None,
    run: Annotated[int | None, typer.Option("--run", min=0, help="Which run of the file; default: 0.")] = None,
    fps: Annotated[
        int | None, typer.Option(min=1, max=60, help="Snapshots per second; default: so that it takes about 5 s.")
    ] = None,
) -> None:
    """Animate the snapshots of a run on its slope, coloured by volume fraction, as GIF or MP4."""
    from warpgran.figures.animation import animate
    from warpgran.results.reading import open_dataset

    made = output or _beside([file], run, ".gif")
    with open_dataset(file) as data:
        film = animate(data, run=run or 0, path=made, fps=fps)
    if film.advice:
        tell(f"few snapshots: {film.advice}")
    say(f"wrote {made}")


def _beside(files: list[Path], run: int | None, suffix: str) -> Path:
    """Where a picture goes by default: that of one run not over that of all."""
    chosen = "" if run is None else f"_run{run}"
    return files[0].with_name("_".join(file.stem for file in files) + chosen + suffix)


def beside(what: str, path: Path, write: Callable[[], object]) -> list[str]:
    """What is written beside a result: its path, or nothing, and why on standard error."""
    try:
        write()
    except (WarpgranError, OSError) as error:
        tell(f"no {what}: {error}")
        return []
    return [str(path)]
