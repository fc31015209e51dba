"""The figure of a batch: results of its runs over the swept keys, and their fronts over time.

One page: run-out, final maximum thickness, stop time and largest dilation against each swept key; the front positions
over time, as lines or, of many runs, as bands; with two swept keys, the run-out over both. Runs that ended early are
crosses at their parameters and count nowhere else: where they ended says nothing of their parameters. Runs that are
still to be computed are left out. Open marks are runs whose result is not what it seems: `analysis.caveats`.
"""

from __future__ import annotations

import textwrap
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.gridspec import GridSpec

from warpgran.analysis.run_columns import WAITING, RunColumns
from warpgran.analysis.summary import summary_columns
from warpgran.analysis.units import Lengths
from warpgran.arrays import Array
from warpgran.errors import ResultError
from warpgran.figures.heading import heading, main_facts
from warpgran.figures.style import FRONT, TIME_LABEL, WIDTH, Panel, Sheet, hold_open, legend, letter, small_print
from warpgran.figures.swept_keys import Key, runs_along, varied_keys
from warpgran.schema import CLEAN

GAP = 0.2  # between panels, inches
MAX_KEYS = 4  # columns of panels that fit the page
MAX_LINES = 50  # fronts drawn one by one, and lines of joined points in a panel
MAX_JOINED = 30  # values of a key whose points are joined
OPEN = {"moving": "o", "left_grid": "^"}  # marks of caveats, the later one where a run has both
CROSS: Any = {"color": "tab:red", "marker": "x", "markersize": 3.5, "markeredgewidth": 0.8, "linestyle": "none"}
QUANTITIES = (
    Panel("run_out", "run-out\n" + r"$x_\mathrm{f} - x_\mathrm{f}(0)$", "along", span=0.02),
    Panel("h_max", "final max.\nthickness", "thick", span=0.07),
    Panel("stop_time", "stop time\n" + r"$t_\mathrm{stop}$", "s", span=0.01),
    Panel("dilation_max", "max. dilation\n" + r"$\Delta V/V_0$", "%", factor=100.0, span=1.0),
)


@dataclass(frozen=True)
class Batch:
    """The data of the page.

    Attributes:
        frame: the summary, without the values of runs that ended early.
        front: front position [m], shape (run, sample).
        time: times of the samples [s].
        done: which runs did all that was asked of them, shape (run,).
        failed: which ended early, shape (run,); those still to be computed are in neither.
        caveats: which are marked for what, shape (run,) each.
        panels: the quantities, in the units of this result.
        along: the front in its unit.
        keys: all keys that vary.
        drawn: the keys that have a column of panels.
        correlation: rank correlation of each key with the run-out, by name.
    """

    frame: dict[str, Array]
    front: Array
    time: Array
    done: np.ndarray
    failed: np.ndarray
    caveats: dict[str, np.ndarray]
    panels: tuple[Panel, ...]
    along: Panel
    keys: list[Key]
    drawn: list[Key]
    correlation: dict[str, float]


def draw_batch(data: RunColumns) -> Sheet:
    """The page of a batch, just as high as its parts ask: heading, panels, fronts and map, small print.

    Raises:
        ResultError: no run has a front to draw.
    """
    batch = _batch(data)
    columns, mapped = len(batch.drawn), len(batch.keys) == len(batch.drawn) == 2
    title, caption = _heading(data, batch), _caption(batch, mapped)
    across = 3 if columns <= 2 else 2
    legend_rows = max((_legend_rows(_colour_key(batch, key), across) for key in batch.drawn), default=0)
    front_rows = 1 if len(batch.done) > MAX_LINES else _legend_rows(_front_key(batch), 3 if mapped else 6)
    # Inches from the top of the page.
    panel, rows, fronts = ((1.35, 2, 1.9) if columns == 1 else (1.02, 4, 1.6)) if columns else (0.0, 0, 1.9)
    panels_top = 0.25 + 0.18 * (1 + title.count("\n"))
    panels_end = panels_top + rows * (panel + GAP) - GAP
    fronts_top = panels_end + (0.65 if columns <= 2 else 0.8) + 0.15 * legend_rows if rows else panels_top
    fronts_end = fronts_top + fronts
    height = fronts_end + 0.63 + 0.15 * front_rows + 0.13 * (1 + caption.count("\n"))

    figure = Sheet(figsize=(WIDTH, height))
    place: Any = {"left": 0.095, "right": 0.98}
    axes: list[Axes] = []
    if rows:
        grid = figure.add_gridspec(
            rows, max(2, columns), top=1 - panels_top / height, bottom=1 - panels_end / height, hspace=GAP / panel,
            wspace=0.26 if columns == 1 else 0.12, **place,
        )  # fmt: skip
        axes += _draw_panels(batch, grid)
    grid = figure.add_gridspec(
        1, 2 if mapped else 1, top=1 - fronts_top / height, bottom=1 - fronts_end / height, wspace=0.26, **place
    )
    axes.append(figure.add_subplot(grid[0, 0]))
    _draw_fronts(axes[-1], batch)
    legend(axes[-1:], 3 if mapped else 6)
    small_print(axes[-1], caption)
    if mapped:
        axes.append(figure.add_subplot(grid[0, 1]))
        _draw_map(axes[-1], batch)
    letter(axes)
    for edge in {ax.get_position().x0 for ax in axes}:
        figure.align_ylabels([ax for ax in axes if ax.get_position().x0 == edge])
    figure.suptitle(title, fontsize=9, y=1 - 0.08 / height, linespacing=1.4)
    return figure


def _batch(data: RunColumns) -> Batch:
    """Choose and compute the data of the page."""
    frame = summary_columns(data)
    done, waiting = (np.isin(data.status, words) for words in (CLEAN, WAITING))
    if waiting.all():
        raise ResultError("there is nothing to draw: none of the runs is computed yet")
    if not np.isfinite(frame["front"]).any():
        empty = "`time.series` is empty" if not data.series["front"].size else "no run has a front"
        alone = "; a run alone has snapshots: --run 0" if data.fields["h"].size else ""
        raise ResultError(f"there is nothing to draw of all runs together, since {empty}{alone}")
    frame |= {panel.name: np.where(done, frame[panel.name], np.nan) for panel in QUANTITIES}
    lengths = Lengths.of(data)
    keys = varied_keys(data)
    correlation = {key.name: key.correlation(frame["run_out"]) for key in keys}
    ranked = sorted(keys, key=lambda key: -abs(correlation[key.name]))
    drawn = keys if len(keys) <= MAX_KEYS else ranked[:MAX_KEYS]
    drawn = drawn if any(key.numeric for key in drawn) else []
    return Batch(
        frame=frame,
        front=np.asarray(data.series["front"]),
        time=data.series_time,
        done=done,
        failed=~done & ~waiting,
        caveats={name: done & frame[name] for name in OPEN},
        panels=tuple(panel.of(lengths) for panel in QUANTITIES),
        along=Panel("front", FRONT, "along", span=0.02).of(lengths),
        keys=keys,
        drawn=drawn,
        correlation=correlation,
    )


def _heading(data: RunColumns, batch: Batch) -> str:
    """Title, number of runs, the keys that vary, and the main parameters that do not."""
    varied = [key.span() for key in batch.drawn or batch.keys[:MAX_KEYS]]
    return heading(data, [f"{len(batch.done)} runs", *varied, *main_facts(data)])


def _caption(batch: Batch, mapped: bool) -> str:
    """The small print: runs and keys left out, and the meaning of the marks."""
    runs, ended = len(batch.done), Counter(batch.frame["status"][batch.failed].tolist())
    waiting = int((~batch.done & ~batch.failed).sum())
    said = [f"{waiting} of {runs} runs are still to be computed and left out."] if waiting else []
    if ended:
        where = ["at the lower edges"] * bool(batch.drawn) + ["in the map"] * mapped + ["where their fronts ended"]
        words = " and ".join(f"{count} {word.replace('_', ' ')}" for word, count in ended.most_common())
        said.append(f"Without a result: {words} of {runs} runs, crosses {', '.join(where)}, else left out.")
    if batch.drawn:
        resting = int(np.isfinite(batch.frame["stop_time"]).sum())
        said.append(f"{resting} of {runs} runs came to rest and have a stop time.")
    said += [
        f"{sign} {count} of {runs} runs {words}." for sign, count, words in _caveats(batch) if count and batch.drawn
    ]
    left_out = [key.name for key in batch.keys if key not in batch.drawn]
    if batch.drawn and left_out:
        found = ", ".join(f"{key.name} {batch.correlation[key.name]:+.2f}" for key in batch.drawn)
        said.append(
            f"Of the {len(batch.keys)} swept keys, the {MAX_KEYS} whose rank correlation (Spearman) with the run-out "
            f"is strongest: {found}; without {', '.join(left_out)}."
        )
    return textwrap.fill(" ".join(said).replace(" -", " \N{MINUS SIGN}"), 120)


def _caveats(batch: Batch) -> Iterator[tuple[str, int, str]]:
    """Sign, number and meaning of the open marks."""
    yield (
        "\N{WHITE UP-POINTING TRIANGLE}",
        int(batch.caveats["left_grid"].sum()),
        ("left the grid: their run-out is a lower bound"),
    )
    yield "\N{WHITE CIRCLE}", int(batch.caveats["moving"].sum()), "still moved at the end"


def _colour_key(batch: Batch, but: Key | None = None) -> Key | None:
    """The key that colours a column of panels: among the others with few values, the one that matters most."""
    others = [key for key in batch.keys if key is not but and key.few]
    return max(others, key=lambda key: abs(batch.correlation[key.name]), default=None)


def _front_key(batch: Batch) -> Key | None:
    """The key in whose colours fronts are drawn one by one."""
    return _colour_key(batch) or next(iter(batch.drawn), None)


def _legend_rows(key: Key | None, columns: int) -> int:
    """Lines of a legend that names the values of a key."""
    return 0 if key is None else -(-key.levels.size // columns) if key.few else 1


def _draw_panels(batch: Batch, grid: GridSpec) -> list[Axes]:
    """Every quantity against every key: a column a key, or two by two for a single key. Returns them in order."""
    alone = len(batch.drawn) == 1
    panels: Any = grid.subplots(sharex="all" if alone else "col", sharey=False if alone else "row")
    lines = 1 if len(batch.drawn) <= 2 else 2
    by_key = [list(panels.flat)] if alone else [list(column) for column in panels.T]
    for key, column in zip(batch.drawn, by_key, strict=True):
        colour = _colour_key(batch, key)
        groups = runs_along(key, batch.keys) if key.numeric and key.levels.size <= MAX_JOINED else []
        groups = groups if len(groups) <= MAX_LINES else []
        for ax, panel in zip(column, batch.panels, strict=True):
            _draw_points(ax, batch, panel, key, groups)
            edge = ax.get_xaxis_transform()
            ax.plot(key.at[batch.failed], np.full(sum(batch.failed), 0.06), **CROSS, transform=edge, rasterized=True)
        for ax in column[-2:] if alone else column[-1:]:
            key.label_axis(ax, lines)
        if colour:
            legend(column, 3 if lines == 1 else 2, 22.0 + 10.0 * lines)
    for ax, panel in zip(by_key[0], batch.panels, strict=True):
        ax.set_ylabel(panel.label)
        _make_room(ax, panel, batch)
    return [ax for column in by_key for ax in column]


def _make_room(ax: Axes, panel: Panel, batch: Batch) -> None:
    """Widen the axis of a quantity to its least span, with room for the crosses; write "none" if no run has it."""
    if not np.isfinite(batch.frame[panel.name]).any():
        ax.set_yticks([])
        ax.text(0.5, 0.5, "none", transform=ax.transAxes, ha="center", va="center", color="0.3")
        return
    hold_open(ax, panel.span)
    if batch.failed.any():
        low, high = ax.get_ylim()
        ax.set_ylim(low - 0.1 * (high - low), high)


def _draw_points(ax: Axes, batch: Batch, panel: Panel, key: Key, groups: list[np.ndarray]) -> None:
    """One quantity against one key: joined points, or points alone; open where the end was not the end."""
    values = panel.factor * batch.frame[panel.name]
    colour = _colour_key(batch, key)
    size = float(np.clip(40.0 / np.sqrt(values.size), 1.0, 3.0))
    look: dict[str, Any] = {"markersize": size, "linestyle": "none", "rasterized": values.size > 200}
    look["alpha"] = 1.0 if values.size <= 500 else 0.6
    mark = np.full(values.size, "")
    for name in OPEN if panel.name in ("run_out", "h_max") else ():
        mark = np.where(batch.caveats[name], OPEN[name], mark)
    levels = range(1) if colour is None else range(colour.levels.size)
    for level in levels:
        of_level = np.ones(values.size, dtype=bool) if colour is None else colour.level == level
        tint = "0.2" if colour is None else colour.colours[level]
        closed = of_level & (mark == "")
        label = colour.label(level) if colour else None
        ax.plot(key.at[closed], values[closed], "o", color=tint, label=label, **look, markeredgewidth=0.0)
        for sign in set(mark[of_level]) - {""}:
            runs = of_level & (mark == sign)
            ax.plot(key.at[runs], values[runs], sign, color=tint, **_opened(look))
    for runs in groups:
        shade = colour.colours[colour.level[runs[0]]] if colour else "0.2"
        ax.plot(key.at[runs], values[runs], color=shade, linewidth=0.8, zorder=1.9)


def _opened(look: dict[str, Any]) -> dict[str, Any]:
    """The look of an open mark, a little larger so that it is seen to be open."""
    return {**look, "markersize": 1.4 * look["markersize"], "markerfacecolor": "white", "markeredgewidth": 0.9}


def _draw_fronts(ax: Axes, batch: Batch) -> None:
    """Front positions over time: lines, or median and bands of many runs; those of runs that ended early in red."""
    front = batch.along.factor * batch.front
    done = front[batch.done]
    if len(batch.done) <= MAX_LINES:
        _draw_lines(ax, batch)
    elif np.isfinite(done).any():
        known = np.isfinite(done).any(axis=0)
        low, lower, middle, upper, high = np.nanpercentile(done[:, known], [5, 25, 50, 75, 95], axis=0)
        ax.fill_between(batch.time[known], low, high, color="0.88", linewidth=0.0, label="5 to 95 % of runs")
        ax.fill_between(batch.time[known], lower, upper, color="0.7", linewidth=0.0, label="25 to 75 %")
        ax.plot(batch.time[known], middle, color="black", label="median")
    known = np.isfinite(front[batch.failed])
    last = known.shape[1] - 1 - np.argmax(known[:, ::-1], axis=1)
    ends = front[batch.failed][np.arange(last.size), last]
    ax.plot(batch.time[last], ends, **CROSS, rasterized=True)
    ax.set_xlabel(TIME_LABEL)
    ax.set_ylabel(batch.along.label)
    if batch.time.size > 1:
        ax.set_xlim(batch.time[0], batch.time[-1])
    hold_open(ax, batch.along.span)


def _draw_lines(ax: Axes, batch: Batch) -> None:
    """The front of each run, in the colours of a key; a few names in the legend."""
    key = _front_key(batch)
    named_levels: set[int] = set()
    for r in np.flatnonzero(batch.done | batch.failed).tolist():
        look: dict[str, Any] = {"color": "0.3" if batch.done[r] else "tab:red"}
        if key is not None and batch.done[r]:
            level = int(key.level[r])
            look = {"color": key.colours[level], "label": None if level in named_levels else key.label(level)}
            named_levels.add(level)
        ax.plot(batch.time, batch.along.factor * batch.front[r], linewidth=0.8, **look)


def _draw_map(ax: Axes, batch: Batch) -> None:
    """The run-out over the two keys: cells where the values form a full grid, else points."""
    a, b = batch.drawn
    run_out = batch.panels[0]
    value = run_out.factor * batch.frame["run_out"]
    known = value[np.isfinite(value)]
    low, high = (known.min(), known.max()) if known.size else (0.0, 1.0)
    look: dict[str, Any] = {
        "cmap": "viridis",
        "vmin": low,
        "vmax": max(high, low + run_out.span or 1.0),
        "rasterized": True,
    }
    shape = (b.levels.size, a.levels.size)
    if value.size == a.levels.size * b.levels.size == np.unique(b.level * shape[1] + a.level).size:
        cells = np.full(shape, np.nan)
        cells[b.level, a.level] = value
        picture: Any = ax.pcolormesh(a.edges, b.edges, cells, **look)
    else:
        size = float(np.clip(2000.0 / value.size, 2.0, 20.0))
        picture = ax.scatter(a.at[batch.done], b.at[batch.done], size, value[batch.done], linewidths=0.0, **look)
    ax.plot(a.at[batch.failed], b.at[batch.failed], **CROSS)
    for name, sign in OPEN.items():
        runs = batch.caveats[name]
        ax.plot(a.at[runs], b.at[runs], sign, color="0.3", **_opened({"markersize": 2.5, "linestyle": "none"}))
    ax.figure.colorbar(picture, ax=ax, label=f"run-out ({run_out.unit})", pad=0.03)
    a.label_axis(ax, 1)
    b.label_axis(ax, 1, horizontal=False)
