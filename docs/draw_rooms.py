"""The picture of docs/architecture.md: the rooms of the package, and who imports whom, read from the sources.

    python docs/draw_rooms.py

writes docs/images/rooms.svg, which says in its metadata what it shows; a test compares that with the sources.
"""

from __future__ import annotations

import ast
import json
import sys
import textwrap
from pathlib import Path
from typing import NamedTuple

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch

DOCS = Path(__file__).parent
sys.path.insert(0, str(DOCS.parent / "tests"))

from helpers.rooms import arrows, modules  # noqa: E402

PICTURE = DOCS / "images" / "rooms.svg"
GROUND = ("schema", "files", "errors", "arrays", "printable")
"""Modules of the top, which import no room: drawn as the ground that the rooms stand on, without arrows."""
COLUMN = {"kernels": 0, "physics": 1, "case": 2, "solve": 0, "analysis": 1, "results": 0, "figures": 1.8, "run": 0,
          "studies": 0, "verification": 1, "paper": 2, "cli": 2.4, "calibration": 4, "viewer": 2.6,
          "sensitivity_analysis": 3}  # fmt: skip
"""Where arrows cross no room: that from cli to viewer passes between two."""
WIDEST = max(COLUMN.values())
COLOUR = {"kernels": "#cfe3f3", "physics": "#cfe3f3", "case": "#e1ecd0", "cli": "#f8e5c8"}
WIDTH, HEIGHT = 1.8, 1.12
"""Of a room, in inches."""
ACROSS, UP = 1.98, 1.5
"""From one room to the next, in inches."""
MARGIN = 0.09
"""Between a frame and the rooms in it, in inches."""


class Box(NamedTuple):
    """The left, lower, right and upper edge of a room or frame, in inches."""

    left: float
    bottom: float
    right: float
    top: float


def shown() -> dict[str, dict[str, list[str] | str]]:
    """What the picture shows: each room's words and the rooms below it, without those that follow from others."""
    imported = {room: below - {*GROUND} for room, below in arrows().items() if room not in GROUND}

    def reached(room: str) -> set[str]:
        return imported[room].union(*map(reached, imported[room]))

    direct = {room: below - set().union(*map(reached, below)) for room, below in imported.items()}
    return {room: {"words": words(room), "imports": sorted(direct[room])} for room in sorted(direct)}


def words(room: str) -> str:
    """The first line of a room's docstring."""
    path = modules()[f"warpgran.{room}"]
    text = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
    return text.partition("\n")[0].partition(": the page")[0].rstrip(".").replace("`", "")


def draw() -> Figure:
    """The rooms on their floors. Rooms of one floor that import the same others stand in a frame."""
    rooms = shown()
    floor: dict[str, int] = {}
    while left := [room for room in rooms if room not in floor]:
        for room in left:
            if all(below in floor for below in rooms[room]["imports"]):
                floor[room] = max((floor[below] + 1 for below in rooms[room]["imports"]), default=0)
    top = max(floor.values())
    figure = Figure((WIDEST * ACROSS + WIDTH + 0.4, top * UP + HEIGHT + 1.14))
    ax = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    ax.set(xlim=(-WIDTH / 2 - 0.2, WIDEST * ACROSS + WIDTH / 2 + 0.2), ylim=(-1.02, top * UP + HEIGHT + 0.12))
    ax.axis("off")
    ground = Box(-WIDTH / 2, -0.92, WIDEST * ACROSS + WIDTH / 2, -0.3)
    draw_box(ax, ground, "#e6e6e6", "    ".join(GROUND), "small modules that the rooms share")

    boxes = {room: Box(COLUMN[room] * ACROSS - WIDTH / 2, floor[room] * UP,
                       COLUMN[room] * ACROSS + WIDTH / 2, floor[room] * UP + HEIGHT) for room in rooms}  # fmt: skip
    ends = dict(boxes)
    for room, entry in rooms.items():
        alike = [boxes[other] for other in rooms if rooms[other]["imports"] == entry["imports"] != []]
        if len(alike) > 1:
            ends[room] = around(alike)
    for frame in sorted({*ends.values()} - {*boxes.values()}):
        draw_box(ax, frame, "#fafafa", "", "")
    for room, box in boxes.items():
        draw_box(ax, box, COLOUR.get(room, "#f1f1f1"), room, str(rooms[room]["words"]))
    for above, below in sorted({(ends[room], ends[below]) for room in rooms for below in rooms[room]["imports"]}):
        draw_arrow(ax, above, below)
    return figure


def around(boxes: list[Box]) -> Box:
    """The frame of some boxes."""
    left, bottom, right, top = zip(*boxes, strict=True)
    return Box(min(left) - MARGIN, min(bottom) - MARGIN, max(right) + MARGIN, max(top) + MARGIN)


def draw_box(ax: Axes, box: Box, colour: str, name: str, text: str) -> None:
    """A room: its name, and what it is."""
    width, middle = box.right - box.left, (box.left + box.right) / 2
    ax.add_patch(FancyBboxPatch((box.left, box.bottom), width, box.top - box.bottom, facecolor=colour,
                                boxstyle="round,pad=0,rounding_size=0.08", edgecolor="0.4", linewidth=0.8))  # fmt: skip
    ax.text(middle, box.top - 0.07, name, ha="center", va="top", fontsize=10, fontweight="bold")
    lines = "\n".join(textwrap.wrap(text, int(width * 13)))
    ax.text(middle, box.top - 0.3, lines, ha="center", va="top", fontsize=9.5, color="0.25", linespacing=1.12)


def draw_arrow(ax: Axes, above: Box, below: Box) -> None:
    """From a room to one on a lower floor; upright where one stands above the other."""
    left, right = max(above.left, below.left), min(above.right, below.right)
    if left < right:
        start = end = (left + right) / 2
    else:
        inward = WIDTH / 6 if above.left > below.left else -WIDTH / 6
        start = (above.left if inward > 0 else above.right) + inward
        end = (below.right if inward > 0 else below.left) - inward
    ax.add_patch(FancyArrowPatch((start, above.bottom), (end, below.top), arrowstyle="-|>", mutation_scale=9,
                                 color="0.35", linewidth=0.9, shrinkA=0, shrinkB=0, zorder=2))  # fmt: skip


def main() -> None:
    """Write the picture."""
    with rc_context({"svg.hashsalt": "rooms", "font.family": "sans-serif"}):
        draw().savefig(PICTURE, metadata={"Date": None, "Description": json.dumps(shown())})


if __name__ == "__main__":
    main()
