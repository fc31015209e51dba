"""Runs of several results over each other: thickness at instants that they share, and their series."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes

from warpgran.analysis.derived import thick
from warpgran.analysis.run_columns import RunColumns
from warpgran.analysis.units import Lengths, unit_of
from warpgran.arrays import Array
from warpgran.case.defaults import FOLLOWS, default
from warpgran.case.sweep_section import KINDS
from warpgran.errors import ResultError
from warpgran.figures.heading import MAIN_KEYS, MARKUP, heading, reserves
from warpgran.figures.names import named
from warpgran.figures.one_run import BED_GAP, BED_HEIGHT, HEIGHT, POSITION, PROFILES, SERIES
from warpgran.figures.selection import OneRun, computed_snapshots, one_run, wet_range
from warpgran.figures.style import COLOURS, DASHES, THIN, TIME_LABEL, WIDTH, Sheet, hold_open, letter
from warpgran.printable import printable

MAX_RUNS = len(COLOURS)
MAX_INSTANTS = 4
MAX_FACTS = 3  # keys that a label names
COLUMN = 52  # characters of a label that fits half the page


class Line(NamedTuple):
    """One of the runs: its data over x, the snapshots that it reached, and how it is drawn."""

    one: OneRun
    snapshots: OneRun
    look: dict[str, Any]


def draw_overlay(results: Sequence[RunColumns], run: int | None, labels: Sequence[str] | None) -> Sheet:
    """The page of runs over each other.

    Args:
        results: of which all runs are drawn.
        run: the only run that is drawn of each.
        labels: what the results are called; by default by their files.

    Raises:
        ResultError: no such run, too many runs, too few labels, or nothing to draw.
    """
    places = [(n, r) for n, data in enumerate(results) for r in (range(data.run.size) if run is None else [run])]
    if len(places) > MAX_RUNS:
        raise ResultError(
            f"{len(places)} runs are too many to tell apart, {MAX_RUNS} can be drawn over each other: choose one of "
            "each result by its number (--run 0, in Python run=0)"
        )
    if labels is not None and len(labels) != len(results):
        raise ResultError(f"{len(labels)} labels do not name {len(results)} results")
    runs = [one_run(results[n], r) for n, r in places]
    names = _names(results) if labels is None else list(labels)
    numbers = [f"result {n}" + (f", run {r}" if results[n].run.size > 1 else "") for n, r in places]
    said = _labels(runs, [names[n] for n, _ in places], numbers)
    lines = [
        Line(one, computed_snapshots(one), {"color": COLOURS[n], "linestyle": DASHES[n % len(DASHES)], "label": label})
        for n, (one, label) in enumerate(zip(runs, said, strict=True))
    ]
    instants = _shared_instants(lines)
    sampled = any(np.isfinite(one.series("h_max")).any() for one in runs)
    if not instants.size and not sampled:
        raise ResultError("there is nothing to draw over each other: no snapshot is at one time in all runs, no series")
    lengths = Lengths.of(*(one.columns for one in runs))

    columns = 2 if max(len(MARKUP.sub("", label)) for label in said) <= COLUMN else 1
    rows = sum(1 + label.count("\n") for label in said[:: columns if columns > 1 else 1])
    title, below = _heading(runs), 0.5 + 0.16 * rows
    head = 0.25 + 0.18 * (1 + title.count("\n"))
    on_bed = bool(instants.size) and any(np.ptp(one.bed) > 0.0 for one in runs)
    above = head + (BED_HEIGHT + BED_GAP if on_bed else 0.0)
    height = HEIGHT - 1.09 + below + above - head
    figure = Sheet(figsize=(WIDTH, height))
    place = {"top": 1 - above / height, "bottom": below / height, "hspace": 0.18}
    middle = 0.085 if not instants.size else 0.58
    axes: list[Axes] = []
    if on_bed:
        axes.append(figure.add_axes((0.085, 1 - (head + BED_HEIGHT) / height, 0.89, BED_HEIGHT / height)))
        _draw_on_beds(lines, float(instants[-1]), axes[0], lengths)
    if instants.size:
        grid = figure.add_gridspec(instants.size, 1, left=0.085, right=0.475 if sampled else 0.975, **place)
        profiles: list[Axes] = list(grid.subplots(sharex=True, sharey=True, squeeze=False).flat)
        _draw_profiles(lines, instants, profiles, lengths)
        axes += profiles
    if sampled:
        grid = figure.add_gridspec(len(SERIES), 1, left=middle, right=0.975, **place)
        panels: list[Axes] = list(grid.subplots(sharex=True, squeeze=False).flat)
        _draw_series(lines, panels, lengths)
        axes += panels
    letter(axes)
    for edge in {ax.get_position().x0 for ax in axes}:
        figure.align_ylabels([ax for ax in axes if ax.get_position().x0 == edge])
    figure.legend(*axes[-1].get_legend_handles_labels(), loc="lower center", ncols=columns, borderaxespad=0.3)
    figure.suptitle(title, fontsize=9, y=1 - 0.08 / height, linespacing=1.4)
    return figure


def _names(results: Sequence[RunColumns]) -> list[str]:
    """What results are called: by their files, else by their titles; not at all where that is the same for all."""
    sources = [data.source for data in results]
    stems = [Path(source).stem for source in sources]
    names = stems if len(set(stems)) == len(stems) else sources
    titles = [" / ".join(dict.fromkeys(data.parameter("title", "").ravel().tolist())) for data in results]
    names = [name or title for name, title in zip(names, titles, strict=True)]
    return names if len(set(names)) > 1 else [""] * len(names)


def _labels(runs: Sequence[OneRun], names: Sequence[str], numbers: Sequence[str]) -> list[str]:
    """The name of each run's result, the keys in which the runs differ, and what it must not be read without.

    Runs that have no name and differ in no key are called by their numbers.
    """
    differ = _different_keys(runs)
    labels = []
    for one, name, number in zip(runs, names, numbers, strict=True):
        facts = [_fact(one, key) for key in differ[:MAX_FACTS]]
        more = len(differ) - MAX_FACTS
        facts += [f"{more} keys more" if more > 1 else _fact(one, differ[-1])] if more > 0 else []
        name = printable(name).replace("$", r"\$")
        called = name or ("" if facts else number)
        text = ": ".join(filter(None, (called, ", ".join(facts))))
        notes = "; ".join(reserves(one))
        text = f"{text} ({notes})" if notes else text
        labels.append(textwrap.fill(text, 2 * COLUMN) if len(MARKUP.sub("", text)) > 2 * COLUMN else text)
    return labels


def _different_keys(runs: Sequence[OneRun]) -> list[str]:
    """Keys of single values in which runs differ, without those that follow others by default; the main ones first.

    Keys of the grid and the duration are named only where nothing else differs.
    """
    values = {key: [_value(one, key) for one in runs] for key in dict.fromkeys((*MAIN_KEYS, *KINDS))}
    differ = [key for key, found in values.items() if any(value != found[0] for value in found)]
    differ = [key for key in differ if key not in FOLLOWS or not all(_follows(one, key) for one in runs)]
    return [key for key in differ if not key.startswith(("grid.", "time."))] or differ


def _value(one: OneRun, key: str) -> Any:
    """A key of one run, None where it has no part in it."""
    value = one.parameter(key, "")
    return None if value == "" else value


def _follows(one: OneRun, key: str) -> bool:
    """Whether a key has its default, as far as the result says."""
    given = [_value(one, other) for other in FOLLOWS[key][1]]
    if _value(one, key) is None or None in given:
        return True
    return bool(np.isclose(_value(one, key), default(key, lambda other: _value(one, other)), rtol=1e-9, atol=0.0))


def _fact(one: OneRun, key: str) -> str:
    value = _value(one, key)
    words = named(key, np.array([value]) if isinstance(value, float) else None)
    return f"no {key}" if value is None else words.value(value)


def _heading(runs: Sequence[OneRun]) -> str:
    """The title that all runs share, how many they are, and the main parameters that are the same in all."""
    shared = [key for key in MAIN_KEYS if len({_value(one, key) for one in runs}) == 1]
    facts = [f"{len(runs)} runs", *(_fact(runs[0], key) for key in shared if _value(runs[0], key) is not None)]
    titles = {_value(one, "title") for one in runs}
    return heading(runs[0].columns, facts) if len(titles) == 1 else ", ".join(facts)


def _shared_instants(lines: Sequence[Line]) -> Array:
    """Up to four times of snapshots that all runs reached, [s]; of many the first, where all begin, is left out."""
    first, *others = (line.snapshots.time for line in lines)
    shared = np.array([t for t in first if all(np.isclose(other, t, rtol=1e-9, atol=1e-12).any() for other in others)])
    if shared.size <= MAX_INSTANTS:
        return shared
    chosen = np.linspace(1, shared.size - 1, MAX_INSTANTS).round().astype(int)
    return np.asarray(shared[chosen])


def _draw_on_beds(lines: Sequence[Line], t: float, ax: Axes, lengths: Lengths) -> None:
    """The free surface of every run on its bed, at one instant [s]."""
    parts = [line.snapshots.at(cells=wet_range(line.snapshots)) for line in lines]
    along, up = unit_of(lengths.along), unit_of(max(lengths.thick, *(float(np.ptp(there.bed)) for there in parts)))
    for line, there in zip(lines, parts, strict=True):
        instant = int(np.argmin(np.abs(there.time - t)))
        surface = np.where(thick(there)[instant], there.bed + there.h[instant], np.nan)
        ax.plot(along.factor * there.x, up.factor * surface, **line.look)
        ax.plot(along.factor * there.x, up.factor * there.bed, color="0.3", linewidth=0.8, zorder=1)
    ax.margins(x=0.0)
    ax.text(0.985, 0.86, f"$t$ = {t:g} s", transform=ax.transAxes, ha="right", va="top")
    ax.set_ylabel(f"bed $b$, surface\n$b + h$ ({up.name})")


def _draw_profiles(lines: Sequence[Line], instants: Array, axes: Sequence[Axes], lengths: Lengths) -> None:
    """The thickness of every run, a panel an instant."""
    position, panel = POSITION.of(lengths), PROFILES[0].of(lengths)
    for ax, t in zip(axes, instants.tolist(), strict=True):
        for line in lines:
            there = line.snapshots.at(cells=wet_range(line.snapshots))
            h = there.h[int(np.argmin(np.abs(there.time - t)))]
            ax.plot(position.factor * there.x, panel.factor * h, **line.look)
        ax.text(0.97, 0.9, f"$t$ = {t:g} s", transform=ax.transAxes, ha="right", va="top")
        ax.set_ylabel(panel.label)
        hold_open(ax, panel.span)
    axes[0].set_ylim(bottom=0.0)
    axes[-1].margins(x=0.0)
    axes[-1].locator_params(axis="x", nbins=7)
    axes[-1].set_xlabel(position.label)


def _draw_series(lines: Sequence[Line], axes: Sequence[Axes], lengths: Lengths) -> None:
    """Front, thickness, speed and volume change of every run against time."""
    for ax, panel in zip(axes, (panel.of(lengths) for panel in SERIES), strict=True):
        for line in lines:
            ax.plot(line.one.columns.series_time, panel.factor * line.one.series(panel.name), **line.look)
        ax.set_ylabel(r"speed $|v|$ (m/s)" if panel.name == "v_flow" else panel.label)
        if isinstance(panel.reference, float):
            ax.axhline(panel.reference, **THIN)
        hold_open(ax, panel.span)
        if panel.name == "v_flow":
            _speeds_on_a_logarithmic_axis(lines, ax)
    axes[-1].margins(x=0.0)
    axes[-1].locator_params(axis="x", nbins=7)
    axes[-1].set_xlabel(TIME_LABEL)


def _speeds_on_a_logarithmic_axis(lines: Sequence[Line], ax: Axes) -> None:
    """From a third of the speed that counts as rest to twice the fastest, if anything ever moves."""
    rest_speed = min(line.one.parameter("time.rest_speed") for line in lines)
    fastest = max(np.nanmax(line.one.series("v_flow"), initial=0.0) for line in lines)
    if fastest > rest_speed:
        ax.set_yscale("log")
        ax.set_ylim(rest_speed / 3, 2 * fastest)
