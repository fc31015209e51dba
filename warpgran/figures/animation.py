"""Animations of a result: the collapse of one run on its slope, a frame a snapshot."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import rc_context
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, FuncAnimation, PillowWriter

from warpgran.analysis.units import Lengths
from warpgran.errors import ResultError
from warpgran.figures.player import player
from warpgran.figures.scene import Scene
from warpgran.figures.selection import OneRun, computed_snapshots, one_run
from warpgran.figures.style import STYLE, checked
from warpgran.files import MARK, replacing

ANIMATION_SUFFIXES = (".gif", ".mp4")
SECONDS = 5.0  # of an animation, by default
MOST_FPS = 25
MOST_SHOWN = 250  # frames in a notebook
FEW, SMOOTH = 20, 60  # snapshots that move by jerks, and that do not


def animate(
    data: xr.Dataset, *, run: int = 0, path: str | Path | None = None, fps: int | None = None, dpi: float = 110
) -> Film:
    """Animate the collapse of one run on its slope, one frame a snapshot, coloured by volume fraction.

    Args:
        data: A result with two snapshots or more.
        run: Which run of the result, counted from 0.
        path: An animation to write, too: .gif, or .mp4 where ffmpeg is installed.
        fps: Frames a second; by default so many that it takes about 5 s.
        dpi: Pixels an inch; a frame is about 8 inches wide.

    Returns:
        The animation, one of matplotlib's. A notebook shows it, and `save` writes it.

    Raises:
        OptionError: Another suffix.
        StorageError: The animation cannot be written, or a file is there that warpgran did not write.
        ResultError: .mp4 without ffmpeg, no such run, or fewer than two snapshots.
    """
    path = None if path is None else checked(path, ANIMATION_SUFFIXES)
    one = computed_snapshots(one_run(data, run))
    held = one.time.size
    if held < 2:
        raise ResultError(f"an animation needs two snapshots or more, run {run} has {held}: {_more_snapshots(one)}")
    fps = fps or int(np.clip(round(held / SECONDS), 1, MOST_FPS))
    writer = None if path is None else _movie_writer(path.suffix.lower(), fps)
    with rc_context(STYLE):
        scene = Scene(one, dpi, Lengths.of(one.columns))
        film = Film(scene, held, fps, _more_snapshots(one) if held < FEW else "")
    if path is not None and writer is not None:
        with replacing(path, ours=MARK) as part:
            film.save(part, writer=writer, dpi=dpi)
    return film


def _more_snapshots(one: OneRun) -> str:
    """How to get enough snapshots for a smooth animation."""
    every = float(f"{one.parameter('time.end') / SMOOTH:.2g}")
    return f"run it again with --set 'time.snapshots={{every={every:g}}}' for about {SMOOTH}"


class Film(FuncAnimation):
    """An animation that is drawn and saved in our style wherever it is taken, and that a notebook shows by itself.

    Attributes:
        figure: What is drawn on.
        advice: how to get more frames, if there are few; else "".
    """

    def __init__(self, scene: Scene, frames: int, fps: int, advice: str) -> None:
        """Show so many snapshots of a scene, so many a second."""
        self.figure, self.advice = scene.figure, advice
        self._scene, self._frames, self._fps = scene, frames, fps
        super().__init__(scene.figure, scene.show, frames=frames, interval=1000.0 / fps)

    def __del__(self) -> None:
        """Say nothing: matplotlib would warn of an animation that was never shown, as a script may well leave one."""

    def save(self, *arguments: Any, **options: Any) -> None:
        """Save it; see matplotlib's own."""
        with rc_context(STYLE):
            super().save(*arguments, **options)

    def to_jshtml(self, fps: float | None = None, embed_frames: bool = True, default_mode: str | None = None) -> str:
        """A player of at most 250 snapshots for a page; unlike matplotlib's it loads nothing from elsewhere.

        Args:
            fps: Frames a second; by default those of the animation.
            embed_frames: always so, whatever is asked.
            default_mode: "once" ends with the last frame; by default it begins again.
        """
        shown = np.unique(np.linspace(0, self._frames - 1, min(self._frames, MOST_SHOWN)).round().astype(int)).tolist()
        with rc_context(STYLE):
            caption = f"{len(shown)} of {self._frames} snapshots" if len(shown) < self._frames else ""
            return player(self._scene, shown, fps or self._fps, default_mode != "once", caption)

    def _repr_html_(self) -> str:
        return self.to_jshtml()


class _MarkedGif(PillowWriter):
    """A GIF that says who wrote it, so that it may be replaced."""

    def finish(self) -> None:
        """Write the file."""
        frames: list[Any] = self.__dict__["_frames"]
        frames[0].info["comment"] = MARK  # matplotlib has no metadata for a GIF
        super().finish()


def _movie_writer(suffix: str, fps: int) -> AbstractMovieWriter:
    """The writer of a GIF or a video."""
    if suffix == ".gif":
        return _MarkedGif(fps=fps)
    if not FFMpegWriter.isAvailable():
        raise ResultError(
            "writing .mp4 needs ffmpeg, which was not found: install it, or choose a name that ends in .gif"
        )
    return FFMpegWriter(fps=fps, metadata={"comment": MARK.decode()})
