"""The style of the figures: fonts and lines, axes, legends, small print.

Nothing here or in the figures touches pyplot, so that no window opens and no figure stays in memory.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from importlib.metadata import version
from io import BytesIO
from pathlib import Path
from typing import Any

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.transforms import ScaledTranslation

from warpgran.analysis.units import Lengths, unit_of
from warpgran.errors import OptionError
from warpgran.files import MARK, replacing

PLOT_SUFFIXES = (".png", ".pdf", ".svg")
WIDTH = 180 / 25.4  # of a page, inches
STYLE: Any = {
    "font.family": "sans-serif",
    "font.size": 8,
    "axes.labelsize": 8,
    "axes.linewidth": 0.6,
    "axes.formatter.useoffset": False,
    "axes.titley": 1.0,  # where titles stand anyway; found by itself it takes a layout of all ticks
    "xtick.labelsize": 7.5,
    "ytick.labelsize": 7.5,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "legend.fontsize": 7.5,
    "legend.frameon": False,
    "legend.handlelength": 1.8,
    "legend.columnspacing": 1.2,
    "lines.linewidth": 1.1,
    "svg.fonttype": "none",
    "pdf.fonttype": 42,
}
THIN: dict[str, Any] = {"color": "0.45", "linewidth": 0.7, "zorder": 1}
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "0.2", "#999933")
"""Colours that the colour-blind can tell apart (Okabe and Ito), for what has no order."""
DASHES: Any = ("-", (0, (5, 1.5)), (0, (1.5, 1)), (0, (5, 1.5, 1.5, 1.5)))
"""Line styles beside them, so that print in grey tells lines apart too."""
PARSERS: dict[type, Any] = {}
"""Of formulas, by kinds of drawing: one keeps what it has parsed, and matplotlib makes a new one for each drawing."""
FRONT = r"front position $x_\mathrm{f}$"
FRONT_LABEL = f"{FRONT} (m)"
TIME_LABEL = "time $t$ (s)"


class Sheet(Figure):
    """A figure that is drawn and saved in our style wherever it is taken, and that a notebook shows by itself."""

    def draw(self, renderer: Any) -> None:
        """Draw it."""
        if hasattr(renderer, "mathtext_parser"):  # to parse all formulas takes a fifth of the time of a page
            renderer.mathtext_parser = PARSERS.setdefault(type(renderer), renderer.mathtext_parser)
        with rc_context(STYLE):
            super().draw(renderer)

    def savefig(self, *arguments: Any, **options: Any) -> None:
        """Save it, by default with 200 dots an inch."""
        with rc_context(STYLE):
            super().savefig(*arguments, **{"dpi": 200, **options})

    def _repr_png_(self) -> bytes:
        picture = BytesIO()
        self.savefig(picture, format="png", dpi=120)
        return picture.getvalue()


@dataclass(frozen=True)
class Panel:
    """One panel: what it draws, and how its axis is labelled.

    Attributes:
        name: variable of the result or column of its summary.
        words: quantity and symbol.
        unit: of the axis; "along" or "thick" for lengths along the slope or normal to it, in the unit of the result.
        factor: from SI units to that of the axis.
        span: least extent of the axis, in its unit, so that rounding is not shown as a signal; of lengths the share of
            the typical one.
        thin: whether it is drawn where the material is thinner than `scheme.h_front`.
        reference: level of a thin reference line, a number or the dotted key of a parameter.
    """

    name: str
    words: str
    unit: str
    factor: float = 1.0
    span: float = 0.0
    thin: bool = True
    reference: float | str | None = None

    @property
    def label(self) -> str:
        """Quantity, symbol and unit."""
        return f"{self.words} ({self.unit})"

    def of(self, lengths: Lengths) -> Panel:
        """The panel with the unit of lengths chosen."""
        if self.unit not in lengths._fields:
            return self
        typical: float = getattr(lengths, self.unit)
        name, factor = unit_of(typical)
        return replace(self, unit=name, factor=factor, span=self.span * typical * factor)


def checked(path: str | Path, suffixes: tuple[str, ...]) -> Path:
    """The path, if its suffix is one of these.

    Raises:
        OptionError: It is not.
    """
    path = Path(path)
    if path.suffix.lower() not in suffixes:
        raise OptionError(f"cannot write {path.name!r}: the name must end in {', '.join(suffixes)}")
    return path


def save(figure: Figure, path: Path, dpi: float = 200, **metadata: str | None) -> None:
    """Write a figure over an earlier one of warpgran's, or nothing.

    Args:
        figure: What to write.
        path: A picture, .png, .pdf or .svg.
        dpi: Pixels an inch of a .png.
        metadata: More of what the file says of itself, in the names of its format.

    Raises:
        StorageError: It cannot be written, or something else is there.
    """
    png = path.suffix.lower() == ".png"
    metadata = {"Software" if png else "Creator": f"warpgran {version('warpgran')}", **metadata}
    quick: Any = {"pil_kwargs": {"compress_level": 3}} if png else {}  # in half the time 7 % larger
    picture = BytesIO()  # since matplotlib's writer of .pdf takes a full disk for a defect
    figure.savefig(picture, format=path.suffix.lower()[1:], dpi=dpi, metadata=metadata, **quick)
    with replacing(path, ours=MARK) as part:
        part.write_bytes(picture.getvalue())


def letter(axes: Sequence[Axes]) -> None:
    """Letter panels in this order, and put ticks on all their sides."""
    for name, ax in zip("abcdefghijklmnopqrstuvwxyz", axes, strict=False):
        ax.set_title(f"({name})", loc="left", fontsize=8, pad=3)
        ax.tick_params(which="both", top=True, right=True)


def place_labels(axes: Iterable[Axes], across: float = 0.42, below: float = 0.22) -> None:
    """Put the labels of axes in line, at distances from their panels [inches] that leave room for the ticks."""
    for ax in axes:
        inches = ax.figure.dpi_scale_trans
        ax.yaxis.set_label_coords(0.0, 0.5, ax.transAxes + ScaledTranslation(-across, 0.0, inches))
        ax.xaxis.set_label_coords(0.5, 0.0, ax.transAxes + ScaledTranslation(0.0, -below, inches))


def hold_open(ax: Axes, span: float) -> None:
    """Widen the vertical axis to at least `span`, in its own unit."""
    low, high = ax.get_ylim()
    if high - low < span:
        middle = (low + high) / 2
        ax.set_ylim(middle - span / 2, middle + span / 2)


def small_print(ax: Axes, text: str) -> None:
    """Text at the lower edge of the page, from the left edge of a panel."""
    place: Any = ("axes fraction", "figure points")
    ax.annotate(text, (0, 3.5), xycoords=place, va="bottom", fontsize=7, color="0.3", linespacing=1.3)


def legend(axes: Sequence[Axes], columns: int, below: float = 32.0) -> None:
    """One legend for a column of panels, `below` points under the last of them."""
    found: dict[str, Any] = {}
    for ax in axes:
        for handle, label in zip(*ax.get_legend_handles_labels(), strict=True):
            found[label] = handle
    last = axes[-1]
    shift = ScaledTranslation(0.0, -below / 72, last.figure.dpi_scale_trans)
    last.legend(
        found.values(), found.keys(), ncols=columns, loc="upper center", borderaxespad=0.0,
        bbox_to_anchor=(0.5, 0.0), bbox_transform=last.transAxes + shift,
    )  # fmt: skip
