"""The commands that draw: `plot` and `animate`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from warpgran.cli.arguments import OutputOption, ResultArgument

if TYPE_CHECKING:
    import xarray as xr


def plot(
    file: ResultArgument,
    output: OutputOption = None,
    run: Annotated[int | None, typer.Option("--run", min=0, help="One run of a batch; default: all together.")] = None,
) -> None:
    """Draw one run (profiles at the snapshots, series beside them), or a batch against what was swept."""
    from warpgran.results.reading import open_dataset

    made = draw(open_dataset(file), output or file.with_suffix(".png"), run)
    typer.echo(f"wrote {made}")


def animate(
    file: ResultArgument,
    output: OutputOption = None,
    run: Annotated[int, typer.Option("--run", min=0, help="Which run of the file.")] = 0,
    fps: Annotated[int, typer.Option(min=1, max=60, help="Snapshots shown a second.")] = 12,
) -> None:
    """Draw the collapse on its slope, coloured by the volume fraction, as a film (GIF or MP4) of the snapshots."""
    from warpgran.figures.animation import animate
    from warpgran.results.reading import open_dataset

    made = animate(open_dataset(file), output or file.with_suffix(".gif"), run=run, fps=fps)
    typer.echo(f"wrote {made}")


def draw(data: xr.Dataset, path: Path, run: int | None) -> Path:
    """Draw one run, or without a number the batch; the picture's path."""
    from warpgran.figures.plot import plot

    return plot(data, path, run)


def worth_drawing(data: xr.Dataset) -> bool:
    """Whether there is a sample or a snapshot of some run."""
    reached = data["end_time"].max()
    return bool(data["front"].notnull().any() or (data["time"] <= reached).any())
