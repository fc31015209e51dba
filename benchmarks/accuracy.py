"""What accuracy costs: error of four collapses against the seconds they take, both schemes, and NumPy beside them.

    python benchmarks/accuracy.py [--quick] [--json FILE] [--plot FILE.png]

Compared are the front (compacted thickness 1 mm and 5 mm) and the greatest thickness, in motion and at rest, with their
limits under refinement. The error of a grid is the largest of the six; what one percent costs is the time of the
coarsest grid from which on all are within it. Kernel seconds of one thread, medians of interleaved rounds. A limit is
Richardson's, from the second-order scheme on the three finest grids; h_min is part of the model, so that each scheme
is held against the limit with its own default.
"""

from __future__ import annotations

import argparse
import json
import math
import statistics
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure

import warpgran as wg
from warpgran.analysis.front import compacted, front
from warpgran.analysis.refinement import Refined
from warpgran.figures.style import STYLE, WIDTH, letter
from warpgran.solve.device import start_quietly

LEVELS = (1e-3, 5e-3)
"""Compacted thickness at the front, m."""
WANTED = 0.01


@dataclass(frozen=True)
class Collapse:
    """A column of 0.14 m x 0.20 m and the two times at which it is compared.

    Attributes:
        name: Words.
        times: In motion and at rest, s.
        length: Of the grid, m, from -0.2 m on.
        changes: Of the defaults, by dotted key.
    """

    name: str
    times: tuple[float, float]
    length: float
    changes: dict[str, Any]

    def case(self, mm: float, scheme: dict[str, Any]) -> wg.Case:
        """On cells of so many millimetres."""
        cells = round(1e3 * self.length / mm)
        times = list(self.times)
        grid = {"grid.left": -0.2, "grid.right": self.length - 0.2, "grid.cells": cells}
        output = {"time.end": times[-1], "time.snapshots": times, "time.series": []}
        return wg.Case().with_(**{**grid, **output, **self.changes, **scheme})


COLLAPSES = (
    Collapse("0 degrees, K = 0", (0.2, 1.0), 0.8, {"slope.angle": 0.0, "rheology.K": 0.0}),
    Collapse("0 degrees, dense", (0.2, 1.0), 0.8, {"slope.angle": 0.0}),
    Collapse("10 degrees, loose", (0.3, 1.2), 1.0, {"slope.angle": 10.0, "column.phi": 0.55}),
    Collapse("22 degrees, dense", (0.48, 1.8), 1.8, {"slope.angle": 22.0}),
)


class Scheme(NamedTuple):
    """A scheme: its keys, cells [mm] from coarse to fine, the engine, and colour and mark of its line."""

    keys: dict[str, Any]
    mm: tuple[float, ...]
    engine: Any
    colour: str
    mark: str


ORDER_1 = {"scheme.order": 1}
ORDER_2 = {"scheme.order": 2, "scheme.start": 0}
STARTED = {"scheme.order": 2}
SECOND_MM = (10.0, 8.0, 5.0, 4.0, 2.5, 2.0, 1.6, 1.25, 1.0, 0.5)
SCHEMES = {
    "order 1": Scheme(ORDER_1, (8.0, 4.0, 2.0, 1.0, 0.5, 0.25, 0.125), "warp", "#d55e00", "s"),
    "order 2": Scheme(ORDER_2, SECOND_MM, "warp", "#0072b2", "o"),
    "order 2, started on finer cells": Scheme(STARTED, SECOND_MM, "warp", "#009e73", "D"),
    "order 1, NumPy": Scheme(ORDER_1, (8.0, 4.0, 2.0), "numpy", "#d55e00", "x"),
    "order 2, NumPy": Scheme(ORDER_2, (8.0, 4.0, 2.0), "numpy", "#0072b2", "+"),
}
LIMIT_MM = (0.5, 0.25, 0.125)
QUICK_MM = (8.0, 4.0)


def measures(case: wg.Case, data: Any) -> list[float]:
    """Ways of the two fronts from the foot of the column and greatest thickness [m], at each snapshot."""
    found = []
    for h, h_c in zip(data["h"].values[0], compacted(data).values[0], strict=True):
        found += [*(front(case.x, h_c, level) for level in LEVELS), float(h.max())]
    return found


def limits(collapse: Collapse, h_min: float, mm: tuple[float, ...]) -> list[float]:
    """Richardson's limit of each measure, from the second-order scheme; the finest value where it has settled."""
    keys = {**ORDER_2, "scheme.h_min": h_min}
    cases = [collapse.case(size, keys) for size in mm]
    values = np.array([measures(case, wg.simulate(case)) for case in cases])
    cells = tuple(case.grid.cells for case in cases)
    found = [Refined("", cells, tuple(column)) for column in values.T]
    return [quantity.limit if math.isfinite(quantity.limit) else quantity.values[-1] for quantity in found]


class Point(NamedTuple):
    """A grid: cells [mm], largest error, seconds in kernels (median), seconds of each round."""

    mm: float
    error: float
    seconds: float
    rounds: list[float]


def curves(collapse: Collapse, rounds: int, quick: bool) -> dict[str, list[Point]]:
    """Error and seconds of every scheme on every grid; the rounds go over all of them in turn."""
    known: dict[float, list[float]] = {}
    seconds: dict[tuple[str, float], list[float]] = {}
    errors: dict[tuple[str, float], float] = {}
    for attempt in range(rounds):
        for name, scheme in SCHEMES.items():
            for mm in scheme.mm:
                if (quick and mm not in QUICK_MM) or (scheme.engine == "numpy" and attempt):
                    continue
                case = collapse.case(mm, scheme.keys)
                data = wg.simulate(case, threads=1, engine=scheme.engine)
                seconds.setdefault((name, mm), []).append(float(data.attrs["kernel_seconds"]))
                if attempt == 0:
                    if case.h_min not in known:
                        known[case.h_min] = limits(collapse, case.h_min, (*QUICK_MM, 2.0) if quick else LIMIT_MM)
                    found = zip(measures(case, data), known[case.h_min], strict=True)
                    errors[name, mm] = max(abs(value / limit - 1.0) for value, limit in found)
    points: dict[str, list[Point]] = {}
    for (name, mm), each in seconds.items():
        points.setdefault(name, []).append(Point(mm, errors[name, mm], statistics.median(each), each))
    return points


def cost(points: list[Point]) -> Point | None:
    """The coarsest grid from which on all are within the error wanted; None if the finest is not."""
    found = None
    for point in reversed(points):
        if point.error > WANTED:
            break
        found = point
    return found


def extrapolated(points: list[Point]) -> tuple[float, float]:
    """Cells [mm] and seconds that the error wanted would take, by what the finest three grids show."""
    mm, error, seconds = np.log([(point.mm, point.error, point.seconds) for point in points[-3:]]).T
    order, growth = np.polyfit(mm, error, 1)[0], np.polyfit(mm, seconds, 1)[0]
    step = (math.log(WANTED) - error[-1]) / order
    return float(np.exp(mm[-1] + step)), float(np.exp(seconds[-1] + growth * step))


def report(found: dict[str, dict[str, list[Point]]]) -> dict[str, float]:
    """Print what one percent costs, and against order 1; the geometric means of the ratios."""
    ratios: dict[str, list[float]] = {}
    reached: dict[str, list[float]] = {}
    for collapse, schemes in found.items():
        print(f"\n{collapse}: largest error and seconds in kernels, one thread")
        for name, points in schemes.items():
            listed = "  ".join(f"{p.mm:g} mm {p.error:.2%} {p.seconds:.3g} s" for p in points)
            print(f"  {name}: {listed}")
        first = schemes["order 1"]
        paid = cost(first) or first[-1]  # counted as done on the finest grid, though it is not
        real_mm, real = (paid.mm, paid.seconds) if cost(first) else extrapolated(first)
        print(f"  1 %: order 1 {paid.seconds:.3g} s on {paid.mm:g} mm", end="")
        print(
            ""
            if cost(first)
            else f", where its error is {paid.error:.1%}; by its order {real:.3g} s on {real_mm:.2g} mm"
        )
        for name in ("order 2", "order 2, started on finer cells"):
            point = cost(schemes[name])
            if point is None:
                print(f"       {name}: on no grid")
                continue
            ratios.setdefault(name, []).append(paid.seconds / point.seconds)
            reached.setdefault(name, []).append(real / point.seconds)
            print(f"       {name}: {point.seconds:.3g} s on {point.mm:g} mm, {ratios[name][-1]:.0f} times less")
    means = {name: statistics.geometric_mean(values) for name, values in ratios.items() if len(values) == len(found)}
    print("\nGeometric mean of the ratios of the cost of 1 %")
    for name, mean in means.items():
        print(f"  {name}: {mean:.0f}; where order 1 really gets there: {statistics.geometric_mean(reached[name]):.0f}")
    return means


def draw(found: dict[str, dict[str, list[Point]]]) -> Figure:
    """Error over seconds, a panel a collapse."""
    with rc_context(STYLE):
        figure = Figure(figsize=(WIDTH, 5.0), layout="constrained")
        axes = figure.subplots(2, 2, sharex=True, sharey=True)
        for ax, (collapse, schemes) in zip(axes.flat, found.items(), strict=False):
            for name, points in schemes.items():
                style = SCHEMES[name]
                x, y = [p.seconds for p in points], [p.error for p in points]
                line = "--" if style.engine == "numpy" else "-"
                ax.loglog(x, y, line, marker=style.mark, color=style.colour, markersize=3.5, label=name)
            ax.axhline(WANTED, color="0.45", linewidth=0.7, zorder=1)
            ax.set_title(collapse, fontsize=8)
        letter(list(axes.flat))
        for ax in axes[-1]:
            ax.set_xlabel("seconds in kernels, one thread (s)")
        for ax in axes[:, 0]:
            ax.set_ylabel("largest error (-)")
        figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=3)
    return figure


def main() -> None:
    """Measure, print, and write what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="coarse grids alone, one round")
    parser.add_argument("--json", type=Path, help="write every figure")
    parser.add_argument("--plot", type=Path, help="write a picture")
    parser.add_argument("--rounds", type=int, default=3)
    arguments = parser.parse_args()
    start_quietly()
    found = {c.name: curves(c, 1 if arguments.quick else arguments.rounds, arguments.quick) for c in COLLAPSES}
    means = report(found)
    if arguments.json:
        points = {c: {n: [p._asdict() for p in points] for n, points in s.items()} for c, s in found.items()}
        arguments.json.write_text(json.dumps({"means": means, "points": points}, indent=1))
    if arguments.plot:
        draw(found).savefig(arguments.plot, dpi=200)


if __name__ == "__main__":
    main()
