"""A figure of the paper: its caption, and the function that draws it."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass

from matplotlib.figure import Figure

from warpgran.paper.laboratory import Laboratory
from warpgran.paper.results import Results

Draw = Callable[[Results, Laboratory], Figure]


@dataclass(frozen=True)
class Picture:
    """A figure of the paper, computed anew.

    Attributes:
        name: fig02 to fig25, as the paper numbers them.
        title: What it is of.
        caption: What it shows; which instants are ours where the paper does not say.
        draw: Draws it.
    """

    name: str
    title: str
    caption: str
    draw: Draw


def picture(draw: Draw) -> Picture:
    """Make a picture of the function that draws it: its name, and the first paragraph and the rest of its docstring."""
    title, _, caption = inspect.cleandoc(draw.__doc__ or "").partition("\n\n")
    return Picture(draw.__name__, title, " ".join(caption.split()), draw)
