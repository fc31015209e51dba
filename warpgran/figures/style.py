"""What the figures share: style, one run of a result, axes, legends.

Nothing here or in the figures touches pyplot, so that no window opens and no figure stays in memory.
"""

from __future__ import annotations

import re
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.transforms import ScaledTranslation

from warpgran.analysis.fields import number, parameter
from warpgran.analysis.summary import status_words
from warpgran.errors import OptionError, ResultError
from warpgran.figures.names import named, shown
from warpgran.schema import Status

PLOT_SUFFIXES = (".png", ".pdf", ".svg")
WIDTH = 180 / 25.4  # of a page, inches
STYLE: Any = {
    "font.family": "sans-serif",
    "font.size": 8,
    "axes.labelsize": 8,
    "axes.linewidth": 0.6,
    "axes.formatter.useoffset": False,
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
MARKUP = re.compile(r"\\[a-z]+|[${}_^]")  # what takes no room in a line
CLEAN = tuple(status.word for status in Status if status.clean)
MAIN_KEYS = ("slope.angle", "column.phi", "rheology.K")  # of a heading
FRONT_LABEL = r"front position $x_\mathrm{f}$ (m)"
TIME_LABEL = "time $t$ (s)"


@dataclass(frozen=True)
class Panel:
    """One panel: what it draws, and how its axis is labelled.

    Attributes:
        name: variable of the result or column of its summary.
        label: quantity, symbol and unit.
        factor: from SI units to those of the label.
        span: least extent of the axis, in the unit of the label, so that rounding is not shown as a signal.
        thin: whether it is drawn where the material is thinner than `scheme.h_front`.
        reference: level of a thin reference line, a number or the dotted key of a parameter.
    """

    name: str
    label: str
    factor: float = 1.0
    span: float = 0.0
    thin: bool = True
    reference: float | str | None = None


def checked(path: str | Path, suffixes: tuple[str, ...]) -> Path:
    """The path, if its suffix is one of these."""
    path = Path(path)
    if path.suffix.lower() not in suffixes:
        raise OptionError(f"cannot write {path.name!r}: the name must end in {', '.join(suffixes)}")
    return path


def one_run(data: xr.Dataset, run: int) -> xr.Dataset:
    """One run, without the cells that only pad its grid."""
    runs = data.sizes["run"]
    if not 0 <= run < runs:
        raise ResultError(f"there is no run {run}: the result holds {runs}, counted from 0")
    one = data.isel(run=run).assign_attrs(run=run, runs=runs)
    return one.isel(cell=np.flatnonzero(np.isfinite(one["x"].values)))


def computed_snapshots(one: xr.Dataset) -> xr.Dataset:
    """Only the snapshots that the run reached."""
    return one.isel(time=np.flatnonzero(np.isfinite(one["h"].values).any(axis=-1)))


def wet_range(one: xr.Dataset) -> slice:
    """The cells between the first and the last that is ever thicker than h_front [m], and a margin of 4 %."""
    cells = np.flatnonzero((one["h"].values > number(one, "scheme.h_front")).any(axis=0))
    if cells.size == 0:
        return slice(0, one.sizes["cell"])
    margin = max(2, round(0.04 * (cells[-1] - cells[0])))
    return slice(max(0, int(cells[0]) - margin), int(cells[-1]) + margin + 1)


def run_heading(one: xr.Dataset, width: int = 95) -> str:
    """Title of the case, its main parameters, what else varies between the runs, and how the run ended."""
    varied = [str(name) for name in one.variables if "." in str(name) and name not in MAIN_KEYS]
    facts = main_facts(one)
    facts += [f"{name} = {shown(one[name].item()).strip('$')}" for name in varied]
    if one.attrs["runs"] > 1:
        facts.append(f"run {one.attrs['run']} (0 to {one.attrs['runs'] - 1})")
    status = status_words(one).item()
    if status not in CLEAN:
        facts.append(f"ended early: {status}")
    return heading(one, facts, width)


def main_facts(data: xr.Dataset) -> list[str]:
    """The main parameters that the result has, each where it is the same in all runs."""
    values = {key: parameter(data, key, np.nan) for key in MAIN_KEYS}
    return [named(key).value(float(v.item())) for key, v in values.items() if v.size == 1 and v.notnull()]


def heading(data: xr.Dataset, facts: Sequence[str], width: int = 95) -> str:
    """Title of the case, then facts, in lines of about `width` characters."""
    title = " / ".join(dict.fromkeys(parameter(data, "title", "").values.ravel().tolist()))
    lines = [""]
    for fact in facts:
        longer = f"{lines[-1]}, {fact}".removeprefix(", ")
        if lines[-1] and len(MARKUP.sub("", longer)) > width:
            lines[-1] += ","
            lines.append(fact)
        else:
            lines[-1] = longer
    return "\n".join([*textwrap.wrap(title, width), *lines])


def letter(axes: Sequence[Axes]) -> None:
    """Letter panels in this order, and put ticks on all their sides."""
    for name, ax in zip("abcdefghijklmnopqrstuvwxyz", axes, strict=False):
        ax.set_title(f"({name})", loc="left", fontsize=8, pad=3)
        ax.tick_params(which="both", top=True, right=True)


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
