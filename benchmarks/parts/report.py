"""What is shown of the measurements: tables, the machine, a picture."""

from __future__ import annotations

import os
import platform
import statistics
from collections.abc import Callable, Mapping, Sequence
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TypeVar

import numpy as np
from parts.work import Work, median_ratio, middle_half

Key = TypeVar("Key")
Figures = Mapping[Work, list[float]]


def machine() -> dict[str, str | int]:
    """What was measured on, and with which versions."""
    found: dict[str, str | int] = {
        "processor": _processor(),
        "cores": os.cpu_count() or 1,
        "level 2 cache": _line(Path("/sys/devices/system/cpu/cpu0/cache/index2/size")),
        "system": platform.platform(),
        "python": platform.python_version(),
        "date": datetime.now(UTC).date().isoformat(),
    }
    for package in ("warpgran", "warp-lang", "numpy", "numba"):
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "not installed"
    return found


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    facts = {key.strip(): value.strip() for key, _, value in (line.partition(":") for line in lines)}
    name = facts.get("model name", platform.machine())
    return name + (", AVX-512" if "avx512f" in facts.get("flags", "") else "")


def _line(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8").strip()
    except OSError:
        return "not known"


def heading(words: str) -> None:
    """Print a heading."""
    print(f"\n{words}")


def listed(figures: Mapping[Key, list[float]], name: Callable[[Key], str], against: Key | None = None) -> None:
    """Print medians with the least and greatest round, and how many times less than one of them each is."""
    print(f"{'':36s}{'median':>8s}{'least':>8s}{'most':>8s}" + ("" if against is None else f"{'times faster':>14s}"))
    for key, values in figures.items():
        line = f"{name(key):36s}{statistics.median(values):8.2f}{min(values):8.2f}{max(values):8.2f}"
        if against is not None:
            line += f"{median_ratio(figures[against], values):14.2f}"
        print(line)


def grid(figures: Figures, cell: Callable[[Work], str]) -> None:
    """Print a table with a row for each number of cells and runs, and a column for each way to compute them."""
    ways = sorted({(w.precision, w.threads, w.window) for w in figures}, key=lambda w: (-int(w[0][-2:]), *w[1:]))
    rows = list(dict.fromkeys((w.cells, w.runs) for w in figures))
    print(f"{'':14s}" + "".join(f"{precision:>10s}" for precision, _, _ in ways))
    print(f"{'':14s}" + "".join(f"{f'{threads} thr.':>10s}" for _, threads, _ in ways))
    print(f"{'cells':>6s}{'runs':>6s}  " + "".join(f"{'window' if window else 'full':>10s}" for *_, window in ways))
    for cells, runs in rows:
        works = [Work(cells, runs, precision, window, threads) for precision, threads, window in ways]
        shown = "".join(f"{cell(work) if work in figures else '-':>10s}" for work in works)
        print(f"{cells:6d}{runs:6d}  {shown}")


def noise(figures: Mapping[Key, list[float]]) -> str:
    """How wide the middle half of the rounds is, in words."""
    widths = [np.ptp(middle_half(values)) / statistics.median(values) for values in figures.values()]
    return f"the middle half of the rounds spreads by {statistics.median(widths):.0%}, by {max(widths):.0%} at worst"


def warn_of_others(processors: Mapping[Work, float]) -> None:
    """Say if threads did not get a processor each, because something else was running."""
    for threads in sorted({work.threads for work in processors}):
        got = statistics.median(had for work, had in processors.items() if work.threads == threads)
        if got < 0.9 * threads:
            print(f"beware: {threads} threads had only {got:.2f} processors, others used this machine at the time")


def picture(path: Path, over_cells: Figures, over_runs: Figures, words: Sequence[str]) -> None:
    """Draw cost over cells and over runs, medians and the middle half of the rounds; `words` are the two titles."""
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    colours = {"float64": "#1f4e8c", "float32": "#c2571a"}
    threads = sorted({work.threads for work in over_runs})
    figure = Figure(figsize=(7.1, 3.4), layout="constrained")
    axes = figure.subplots(1, 2, sharey=True)
    for axis, figures, title, attribute in zip(axes, (over_cells, over_runs), words, ("cells", "runs"), strict=True):
        for way in dict.fromkeys((w.precision, w.window, w.threads) for w in figures):
            works = [work for work in figures if (work.precision, work.window, work.threads) == way]
            works.sort(key=lambda work: (work.cells, work.runs))
            at = [getattr(work, attribute) for work in works]
            style = {"color": colours[way[0]], "linestyle": "--" if way[1] else "-", "linewidth": 1.1}
            face = colours[way[0]] if way[2] == 1 else "white"
            middle = [statistics.median(figures[work]) for work in works]
            axis.plot(at, middle, marker="o", markersize=4, markerfacecolor=face, **style)
            low_high = np.transpose([middle_half(figures[work]) for work in works])
            axis.fill_between(at, *low_high, color=colours[way[0]], alpha=0.12, linewidth=0)
        axis.set_xscale("log")
        ticks = sorted({getattr(work, attribute) for work in figures})
        axis.set_xticks(ticks, [f"{tick:,}" for tick in ticks])
        axis.minorticks_off()
        axis.set_title(title, fontsize=8)
        axis.tick_params(labelsize=7.5, direction="in")
    axes[0].set_xlabel("cells of a run", fontsize=8)
    axes[1].set_xlabel("runs", fontsize=8)
    axes[0].set_ylabel("cost (ns per cell and step)", fontsize=8)
    axes[0].set_ylim(bottom=0.0)
    keys = [Line2D([], [], color=colour, label=name) for name, colour in colours.items()]
    keys += [
        Line2D([], [], color="0.3", label="full range"),
        Line2D([], [], color="0.3", label="window", linestyle="--"),
    ]
    keys += [
        Line2D([], [], color="0.3", linestyle="", marker="o", markersize=4, markerfacecolor=face,
               label=f"{count} thread{'s' if count > 1 else ''}")
        for face, count in zip(("0.3", "white"), threads, strict=False)
    ]  # fmt: skip
    figure.legend(handles=keys, loc="outside lower center", ncols=len(keys), fontsize=7.5, frameon=False)
    figure.savefig(path, dpi=200)
