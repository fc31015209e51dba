"""How fast warpgran computes on the CPU: cost of a cell-step, against NumPy and numba, by stage, and of whole runs.

    python benchmarks/throughput.py [--quick] [--only PART ...] [--json FILE] [--plot FILE.png]

By order 2, the default scheme; from rest, on one core and by launch with order 1 beside it. All in one process, in
interleaved rounds: figures are medians of rounds, ratios medians of those of each round.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
from dataclasses import asdict, dataclass
from itertools import product
from pathlib import Path
from typing import Any, get_args

from parts.end_to_end import headline, whole_run
from parts.report import Figures, grid, heading, listed, machine, noise, picture, warn_of_others
from parts.rivals import NUMBA, NUMPY, rivals
from parts.stages import divider, stages
from parts.work import Crews, Precision, Work, measured, median_ratio

from warpgran.solve.device import start_quietly

CELLS = (500, 1000, 4000, 16_000)
RUNS = (1, 16, 64, 512)
TOTAL = 64_000  # cells of all runs together, where cost is compared over the cells of a run
PRECISIONS: tuple[Precision, ...] = get_args(Precision)
PARTS = ("throughput", "from_rest", "one_core", "stages", "whole")
THREADS = tuple(dict.fromkeys((1, os.cpu_count() or 1)))


@dataclass(frozen=True)
class Effort:
    """How much is measured.

    Attributes:
        rounds: Of each figure.
        steps: Of a round.
        most: Cell-steps that a round may have; what has more is skipped.
        headline: Runs of 1000 cells computed from rest to 0.3 s.
        study: Runs of the whole study.
        studies: How many times it is computed.
    """

    rounds: int = 5
    steps: int = 300
    most: int = 160_000_000
    headline: int = 64
    study: int = 1000
    studies: int = 3


QUICK = Effort(rounds=3, steps=100, most=10_000_000, headline=16, study=100, studies=1)


def works(effort: Effort) -> tuple[list[Work], list[str]]:
    """The combinations to measure, and words for what is left out."""
    pairs = [(cells, runs) for cells in CELLS for runs in sorted({*RUNS, TOTAL // cells})]
    fits = [pair for pair in pairs if pair[0] * pair[1] * effort.steps <= effort.most]
    skipped = [f"{runs} x {cells} ({runs * cells * effort.steps / 1e6:.0f} million cell-steps a round, more than "
               f"{effort.most / 1e6:.0f})" for cells, runs in pairs if (cells, runs) not in fits]  # fmt: skip
    skipped += [f"1 run on {threads} threads (it is one block)" for threads in THREADS if threads > 1]
    return [
        Work(cells, runs, precision, window, threads)
        for cells, runs in fits
        for precision in PRECISIONS
        for threads in THREADS
        for window in (False, True)
        if runs >= threads
    ], skipped


def throughput(crews: Crews, effort: Effort) -> tuple[Figures, list[dict[str, Any]]]:
    """Cost of a cell-step for every combination."""
    wanted, skipped = works(effort)
    figures, processors = measured({work: crews.round_of(work, effort.steps) for work in wanted}, effort.rounds)
    medians = {work: statistics.median(values) for work, values in figures.items()}
    heading(f"Cost in ns per cell-step, {effort.steps} steps from t = 0.1 s; {noise(figures)}")
    grid(figures, lambda work: f"{medians[work]:.2f}")
    heading("The same as throughput, million cell-steps per second")
    grid(figures, lambda work: f"{1e3 / medians[work]:.0f}")
    print("\n".join(f"skipped: {words}" for words in skipped))
    blocks = {work: work.blocks() for work in wanted}
    return figures, [
        asdict(work)
        | {"blocks": len(blocks[work]), "runs_in_block": blocks[work][0].capacity, "processors": processors[work]}
        | {"visited": crews.of(work)[0].visited, "rounds": values}
        for work, values in figures.items()
    ]


def growth(figures: Figures) -> tuple[Figures, Figures]:
    """How the cost of a cell-step changes with the cells of a run and with the number of runs."""
    over_cells = {work: values for work, values in figures.items() if work.cells * work.runs == TOTAL}
    over_runs = {work: values for work, values in figures.items() if work.cells == 1000 and work.runs in RUNS}

    def against(base: dict[str, int], of: Figures) -> None:
        def ratio(work: Work) -> str:
            return f"{median_ratio(of[work], of[Work(**(asdict(work) | base))]):.2f}"

        grid(of, ratio)

    heading(f"Growth with cells, {TOTAL} cells in all: cost of a cell-step over that of 64 runs of 1000")
    against({"cells": 1000, "runs": 64}, over_cells)
    heading("Growth with runs of 1000 cells: cost of a cell-step over that of 16 runs")
    against({"runs": 16}, {work: values for work, values in over_runs.items() if work.runs >= 16})
    return over_cells, over_runs


def from_rest(effort: Effort) -> list[dict[str, Any]]:
    """A batch from rest to 0.3 s, in the way of the product."""
    wanted = [Work(1000, effort.headline, precision, window, threads, order)
              for order in (1, 2) for precision in PRECISIONS for window in (False, True)
              for threads in THREADS]  # fmt: skip
    figures, processors = measured({work: headline(work) for work in wanted}, effort.rounds)
    heading(f"{effort.headline} runs of 1000 cells from rest to 0.3 s, ns per cell-step; {noise(figures)}")
    listed(figures, _way, wanted[0])
    warn_of_others(processors)
    return [asdict(work) | {"processors": processors[work], "rounds": values} for work, values in figures.items()]


def _way(work: Work) -> str:
    threads = f"{work.threads} thread{'s' if work.threads > 1 else ''}"
    return f"order {work.order}, {work.precision}, {'window' if work.window else 'full'}, {threads}"


def against_others(crews: Crews, effort: Effort) -> dict[str, dict[str, list[float]]]:
    """One run on one core by the kernels, NumPy and, order 1 alone, numba."""
    found = {}
    for order, cells in product((2, 1), (1_000, 10_000)):
        figures, _ = measured(rivals(crews, cells, order), effort.rounds)
        found[f"order {order}, {cells} cells"] = figures
        heading(f"One run of {cells} cells by order {order} on one core, ns per cell-step; {noise(figures)}")
        listed(figures, str, NUMPY)
        if NUMBA in figures:
            for precision in PRECISIONS:
                ratio = median_ratio(figures[NUMBA], figures[f"kernels, {precision}, full range"])
                print(f"kernels in {precision} over the full range: {ratio:.2f} times as fast as numba")
        elif order == 1:
            print("numba is not installed, so not compared: pip install -e '.[bench]'")
    return found


def by_stage(crews: Crews, effort: Effort) -> dict[str, dict[str, list[float]]]:
    """Each launch of a step, and the divider."""
    found: dict[str, dict[str, list[float]]] = {}
    for order, precision in product((2, 1), PRECISIONS):
        work = Work(1000, 64, precision, order=order)
        figures, _ = measured(stages(crews.of(work)[0], work.cells), effort.rounds)
        found[f"order {order}, {precision}"] = figures
        capacity = work.blocks()[0].capacity
        heading(f"By launch, order {order}, {precision}, a block of {capacity} runs of 1000 cells, ns per cell")
        listed(figures, str)
        print(f"{'sum':36s}{sum(map(statistics.median, figures.values())):8.2f}, {len(figures)} launches a step")
    figures, _ = measured(divider(), effort.rounds)
    found["divider"] = figures
    heading("The divider, ns an element")
    listed(figures, str)
    return found


def whole(effort: Effort) -> list[dict[str, float]]:
    """A study from nothing to its file."""
    rounds = [whole_run(effort.study) for _ in range(effort.studies)]
    middle = sorted(rounds, key=lambda parts: parts["file"])[len(rounds) // 2]
    total = middle["start"] + middle["study"] + middle["file"]
    heading(
        f"A study of {effort.study} runs of 500 cells, 51 samples, 5 snapshots: {total:.2f} s, median of {len(rounds)}"
    )
    print(f"{middle['ns_per_cell_step']:.2f} ns per cell-step, file of {middle['megabytes']:.1f} MB, "
          f"{middle['processors']:.2f} processors from the study to the file")  # fmt: skip
    words = {"start": "interpreter, imports, Warp", "study": "cases made and checked", "kernels": "time loops",
             "around": "file opened, brought to its end", "rest": "other Python"}  # fmt: skip
    for name, meaning in words.items():
        print(f"{meaning:36s}{middle[name]:8.2f} s {middle[name] / total:6.1%}")
    print(f"rows stored within these: {middle['storing']:.2f} s")
    return rounds


def main() -> None:
    """Measure, print, and write what is asked for."""
    parser = argparse.ArgumentParser(description="How fast warpgran computes on the CPU.")
    parser.add_argument(
        "--quick", action="store_true", help="one minute instead of five: fewer combinations and rounds"
    )
    parser.add_argument("--only", nargs="+", choices=PARTS, default=PARTS, help="measure some parts alone")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all rounds")
    parser.add_argument("--plot", type=Path, metavar="FILE.png", help="draw cost over cells and over runs")
    chosen = parser.parse_args()
    effort = QUICK if chosen.quick else Effort()
    start_quietly()
    found: dict[str, Any] = {"machine": machine(), "effort": asdict(effort), "unit": "ns per cell-step, but s in whole"}
    print("\n".join(f"{name}: {value}" for name, value in found["machine"].items()))
    crews = Crews()
    if "throughput" in chosen.only:
        figures, found["throughput"] = throughput(crews, effort)
        over = growth(figures)
        if chosen.plot:
            picture(chosen.plot, *over, (f"{TOTAL:,} cells in all", "runs of 1,000 cells"))
    if "from_rest" in chosen.only:
        found["from_rest"] = from_rest(effort)
    if "one_core" in chosen.only:
        found["one_core"] = against_others(crews, effort)
    if "stages" in chosen.only:
        found["stages"] = by_stage(crews, effort)
    if "whole" in chosen.only:
        found["whole"] = whole(effort)
    if chosen.json:
        chosen.json.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
