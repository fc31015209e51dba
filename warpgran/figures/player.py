"""A player of frames for notebooks: all of it in a piece of HTML, which loads nothing."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from io import BytesIO

import jinja2
import numpy as np
from PIL import Image

from warpgran.figures.scene import Scene


def player(scene: Scene, instants: Sequence[int], fps: float, repeat: bool, caption: str) -> str:
    """A figure with the frames, a button and a slider. Where no script runs, the frame in the middle is shown.

    Args:
        scene: what is drawn.
        instants: numbers of its snapshots, one for each frame.
        fps: frames a second.
        repeat: begin again after the last frame.
        caption: what is said beside the slider.
    """
    times = [scene.caption(instant).replace("$", "") for instant in instants]
    frames = list(zip(times, (_frame(scene, instant) for instant in instants), strict=True))
    loader = jinja2.PackageLoader("warpgran.figures", package_path="")
    template = jinja2.Environment(loader=loader, autoescape=True, undefined=jinja2.StrictUndefined).get_template(
        "player.html"
    )
    return template.render(
        frames=frames, middle=len(frames) // 2, wait=round(1000 / fps), repeat=repeat, caption=caption
    )


def _frame(scene: Scene, instant: int) -> str:
    """A frame as PNG in base64, of 256 colours, which take a third of the room."""
    scene.show(instant)
    canvas = scene.figure.canvas
    canvas.draw()
    picture = BytesIO()
    Image.fromarray(np.asarray(canvas.buffer_rgba())[..., :3]).quantize(256).save(picture, "png")  # type: ignore[attr-defined]
    return base64.b64encode(picture.getvalue()).decode("ascii")
