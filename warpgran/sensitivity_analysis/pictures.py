"""The figures of indices: bars with intervals, indices over time, Morris's plane, main effects."""

from __future__ import annotations

import textwrap
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from warpgran.figures.names import Parameter, named
from warpgran.figures.style import STYLE, THIN, TIME_LABEL, WIDTH, letter, save
from warpgran.sensitivity_analysis.indices import OVER_TIME

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "0.2", "#8c564b", "#7f7f00", "#9467bd")
"""Of the parameters, in their order; the colour-blind can tell them apart."""
MARKS = "osD^v<>phX"
ACROSS = 4
"""Most panels side by side."""
SILENT = 0.01
"""Share of the largest standard deviation over time below which no indices are drawn."""
FEW = 8
"""Most outputs of a figure of bars or main effects."""
UNITS = {"m": (1.0, "m"), "1": (1.0, "-"), "s": (1.0, "s"), "m s-1": (1.0, "m/s"), "m2": (1.0, r"m$^2$"),
         "m4 s-2": (1.0, r"m$^4$/s$^2$")}  # fmt: skip


NAMES = ("indices", "main_effects", "plane", "over_time")
"""Ends of the names of the pictures."""


def draw(found: xr.Dataset, stem: Path, suffix: str = ".png") -> list[Path]:
    """Draw all figures that the indices have.

    Args:
        found: What `indices` returns.
        stem: Name of the files before what each shows.
        suffix: .png, .pdf or .svg.

    Returns:
        The files written.

    Raises:
        StorageError: One cannot be written, or a file is there that warpgran did not write.
    """
    sobol = found.attrs["method"] == "sobol"
    figures: dict[str, Callable[[xr.Dataset], Figure]] = {}
    if "output" in found.dims:
        figures |= {"indices": draw_bars, "main_effects": draw_main_effects} if sobol else {"plane": draw_plane}
    if "series" in found.dims and found.sizes["series_time"] > 1:
        figures["over_time"] = draw_over_time
    written = []
    for name, make in figures.items():
        path = stem.with_name(f"{stem.name}_{name}{suffix}")
        with rc_context(STYLE):
            save(make(found), path)
        written.append(path)
    return written


def draw_bars(found: xr.Dataset) -> Figure:
    """First-order and total indices of each single result, with their 95 % intervals."""
    keys = _keys(found)
    shown = found.isel(output=slice(FEW))
    figure, axes = _panels(shown.sizes["output"], 0.75 + 0.3 * len(keys), share_y=True)
    at = np.arange(len(keys))
    for ax, output in zip(axes, shown["output"].values, strict=True):
        one = shown.sel(output=output)
        for name, label, up, colour in (
            ("first_order", "first order: alone", -0.19, "#0072b2"),
            ("total_order", "total: with all its interactions", 0.19, "#9ecae1"),
        ):
            value = one[name].values
            ends = np.abs(np.stack([one[f"{name}_{end}"].values for end in ("low", "high")]) - value)
            ax.barh(at + up, value, 0.36, label=label, color=colour)
            ax.errorbar(value, at + up, xerr=ends, fmt="none", ecolor="0.15", elinewidth=0.8, capsize=1.8)
        ax.axvline(0.0, **THIN)
        ax.set_xlim(min(-0.05, ax.get_xlim()[0]), max(1.0, ax.get_xlim()[1]))
        ax.set_xlabel("Sobol index (-)")
    axes[0].set_yticks(at, [_short(key) for key in keys])
    axes[0].invert_yaxis()
    _name_panels(axes, shown["output_words"])
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=2)
    _entitle(figure, found, "bars: 95 % intervals")
    return figure


def draw_over_time(found: xr.Dataset) -> Figure:
    """Of each series mean and standard deviation over the runs, and below the indices over time with intervals."""
    sobol = found.attrs["method"] == "sobol"
    name, label = ("total_order", "total Sobol index (-)") if sobol else ("mu_star", r"$\mu^*$")
    count = min(found.sizes["series"], ACROSS)
    rows = 3 if sobol else 2
    figure = Figure(figsize=(WIDTH, 0.9 + 1.45 * rows), layout="constrained")
    panels: Any = figure.subplots(rows, count, sharex=True, squeeze=False)
    t = found["series_time"].values
    for n, column in enumerate(panels.T[:count]):
        one = found.isel(series=n)
        _, unit = UNITS[str(one["series_units"].item())]
        mean, sd = one[f"mean{OVER_TIME}"].values, one[f"sd{OVER_TIME}"].values
        column[0].fill_between(t, mean - sd, mean + sd, color="0.85", linewidth=0.0, label="± standard deviation")
        column[0].plot(t, mean, color="black", label="mean of the runs")
        column[0].set_ylabel(f"({unit})")
        drawn = [(name, label), ("first_order", "first-order index (-)")] if sobol else [(name, f"{label} ({unit})")]
        for ax, (quantity, words) in zip(column[1:], drawn, strict=True):
            _draw_indices(ax, one, quantity, t)
            if n == 0 or not sobol:
                ax.set_ylabel(words)
            ax.set_ylim(*((-0.05, 1.05) if sobol else (0.0, None)))
        column[-1].set_xlabel(TIME_LABEL)
        column[-1].set_xlim(t[0], t[-1])
    _name_panels([ax for row in panels for ax in row], found["series_words"][:count])
    handles, labels = panels[1, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=min(5, len(labels)))
    _entitle(figure, found, "grey: standard deviation; bands: 95 % intervals")
    return figure


def _draw_indices(ax: Axes, one: xr.Dataset, quantity: str, t: np.ndarray) -> None:
    """The index of each parameter as a line in its band, where there is something to explain."""
    sd = one[f"sd{OVER_TIME}"].values
    varies = sd > SILENT * np.nanmax(sd)
    for i, key in enumerate(_keys(one)):
        found = one.isel(parameter=i)
        names = (f"{quantity}{end}{OVER_TIME}" for end in ("", "_low", "_high"))
        value, low, high = (np.where(varies, found[name].values, np.nan) for name in names)
        colour = COLOURS[i % len(COLOURS)]
        ax.fill_between(t, low, high, color=colour, alpha=0.2, linewidth=0.0)
        ax.plot(t, value, color=colour, label=named(key).label.rpartition(" (")[0])
    ax.axhline(0.0, **THIN)


def draw_plane(found: xr.Dataset) -> Figure:
    """Morris's plane of each single result: how strong a parameter is, against how much that varies."""
    keys = _keys(found)
    shown = found.isel(output=slice(FEW))
    figure, axes = _panels(shown.sizes["output"], 2.2, across=3)
    for ax, output in zip(axes, shown["output"].values, strict=True):
        one = shown.sel(output=output)
        factor, unit = _scale(one)
        top = factor * max(float(one["mu_star_high"].max()), float(one["sigma"].max())) * 1.08 or 1.0
        ax.plot([0.0, top], [0.0, top], **THIN, linestyle="--")
        for i, key in enumerate(keys):
            at = one.isel(parameter=i)
            strong, ends = factor * float(at["mu_star"]), [float(at[f"mu_star_{end}"]) for end in ("low", "high")]
            look: dict[str, Any] = {"color": COLOURS[i % len(COLOURS)], "marker": MARKS[i % len(MARKS)]}
            ax.errorbar(
                strong, factor * float(at["sigma"]), xerr=np.abs(factor * np.array(ends)[:, None] - strong),
                markersize=4.5, elinewidth=0.8, capsize=1.8, linestyle="none", **look,
                label=named(key).label.rpartition(" (")[0],
            )  # fmt: skip
        ax.set_xlim(0.0, top)
        ax.set_ylim(0.0, top)
        ax.set_xlabel(rf"$\mu^*$ ({unit})")
        ax.set_ylabel(rf"$\sigma$ ({unit})")
    _name_panels(axes, shown["output_words"])
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=min(4, len(keys)))
    _entitle(figure, found, "bars: 95 % intervals")
    return figure


def draw_main_effects(found: xr.Dataset) -> Figure:
    """Mean of each single result over each parameter, and where 90 % of the runs lie, whatever the others are."""
    keys = _keys(found)
    shown = found.isel(output=slice(FEW))
    columns = min(len(keys), 6)
    keys = keys[:columns] if len(keys) <= columns else _strongest(found, columns)
    rows = shown.sizes["output"]
    figure = Figure(figsize=(WIDTH, 0.75 + 1.35 * rows), layout="constrained")
    panels: Any = figure.subplots(rows, columns, sharex="col", sharey="row", squeeze=False)
    for row, output in zip(panels, shown["output"].values, strict=True):
        one = shown.sel(output=output)
        factor, unit = _scale(one)
        for ax, key in zip(row, keys, strict=True):
            at = one.sel(parameter=key)
            x = named(key).factor * at["main_effect_at"].values
            low, mean, high = (factor * at[f"main_effect{end}"].values for end in ("_low", "", "_high"))
            colour = COLOURS[_keys(found).index(key) % len(COLOURS)]
            ax.fill_between(x, low, high, color=colour, alpha=0.2, linewidth=0.0)
            ax.plot(x, mean, color=colour, marker="o", markersize=2.2)
            if "logarithmic" in str(at["distribution"].item()):
                ax.set_xscale("log")
            else:
                ax.locator_params(axis="x", nbins=4)
        row[0].set_ylabel(textwrap.fill(str(one["output_words"].item()), 18) + f"\n({unit})")
    for ax, key in zip(panels[-1], keys, strict=True):
        ax.set_xlabel(_two_lines(named(key)))
    letter([ax for row in panels for ax in row])
    _entitle(figure, found, "bands: 5 to 95 % of the runs")
    return figure


def _panels(count: int, height: float, across: int = ACROSS, share_y: bool = False) -> tuple[Figure, list[Axes]]:
    """A figure of so many panels in rows, each so high in inches."""
    across = min(count, across)
    rows = -(-count // across)
    figure = Figure(figsize=(WIDTH if across > 2 else 0.72 * WIDTH, 0.75 + rows * height), layout="constrained")
    panels: Any = figure.subplots(rows, across, squeeze=False, sharey=share_y)
    axes = list(panels.flat)
    for ax in axes[count:]:
        ax.remove()
    return figure, axes[:count]


def _name_panels(axes: list[Axes], words: xr.DataArray) -> None:
    """Letter all panels, and name what the first ones show."""
    letter(axes)
    for ax, name in zip(axes, words.values.tolist(), strict=False):
        ax.set_title(f"{ax.get_title(loc='left')} {name}", loc="left", fontsize=8, pad=3)


def _scale(one: xr.Dataset) -> tuple[float, str]:
    """Factor and unit of a single result: cm where lengths are below one metre, % of a share."""
    unit = str(one["output_units"].item())
    size = abs(float(one["mean"])) + float(one["sd"])
    if unit == "m" and size < 0.5:
        return 100.0, "cm"
    if unit == "1":
        return 100.0, "%"
    return UNITS[unit]


def _strongest(found: xr.Dataset, count: int) -> list[str]:
    """The parameters with the largest total indices of any output, in their order."""
    largest = found["total_order"].max("output").values
    return [_keys(found)[i] for i in sorted(np.argsort(-np.nan_to_num(largest))[:count].tolist())]


def _keys(found: xr.Dataset) -> list[str]:
    return [str(key) for key in np.atleast_1d(found["parameter"].values)]


def _short(key: str) -> str:
    """Symbol of a key, with words where there is none."""
    return named(key).symbol or named(key).words


def _two_lines(parameter: Parameter) -> str:
    words, symbol = parameter.words, parameter.symbol
    unit = parameter.unit.strip() or "-"
    return f"{words}\n{symbol} ({unit})" if symbol else f"{words}\n({unit})"


def _entitle(figure: Figure, found: xr.Dataset, marks: str) -> None:
    """What was computed, and what the marks are, above all panels."""
    kind = "base samples" if found.attrs["method"] == "sobol" else "trajectories"
    dropped = found.attrs["dropped_samples"]
    left_out = f", {dropped} more left out" if dropped else ""
    words = f"{found.attrs['samples']} {kind} ({found.attrs['runs']} runs){left_out}; {marks}"
    title = found.attrs.get("title", "")
    figure.suptitle(f"{title}\n{words}" if title else words, fontsize=9, linespacing=1.4)
