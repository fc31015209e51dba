"""Kernels against the NumPy reference: cost of a cell-step on one core, and of each stage, in one run.

    python benchmarks/engines.py

Rounds are interleaved, figures are medians with the least and the largest round. The work is the dense column on a
horizontal plane, 1000 cells to 0.1 s, over the full range of cells (`scheme.window = false`) and with the window.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Sequence
from typing import Any

import warp as wp

from warpgran.case import Case
from warpgran.device import start_quietly
from warpgran.reference import Reference
from warpgran.solver import Solver

ROUNDS = 7
T_START, T_END = 0.1, 0.2  # s, after the first contact with the bed


def case(cells: int, window: bool) -> Case:
    """The dense column on a horizontal plane."""
    changes = {"grid.right": 0.6, "grid.cells": cells, "scheme.window": window}
    times = {"time.end": T_END, "time.snapshots": [T_END], "time.series": []}
    return Case().with_(**changes, **times)


def kernels(cells: int, precision: str, window: bool, runs: int = 1) -> Callable[[], float]:
    """A round that returns ns per cell-step of the kernels."""
    cases = [case(cells, window)] * runs
    solver = Solver(cases, precision_name=precision)

    def go(t: float) -> None:
        solver.start(t)
        while not solver.replay():
            pass

    solver.prepare()
    go(T_START)
    solver.save()

    def round_() -> float:
        for live, saved in solver._kept():
            wp.copy(live, saved)
        before = int(solver.state.steps.numpy().sum())
        began = time.perf_counter()
        go(T_END)
        seconds = time.perf_counter() - began
        return seconds / (int(solver.state.steps.numpy().sum()) - before) / cells * 1e9

    return round_


def numpy_reference(cells: int) -> Callable[[], float]:
    """A round that returns ns per cell-step of the reference: its first 200 steps after T_START."""
    run = Reference(case(cells, window=True))
    run.advance(T_START)
    start = run.U, run.t, run.steps

    def round_() -> float:
        run.U, run.t, run.steps = start
        began = time.perf_counter()
        for _ in range(200):
            run.step()
        return (time.perf_counter() - began) / 200 / cells * 1e9

    return round_


def stages(cells: int, precision: str) -> dict[str, Callable[[], float]]:
    """A round for each kernel of a step, launched 200 times in one graph on a state in motion."""
    solver = Solver([case(cells, window=False)], precision_name=precision)
    solver.prepare()
    solver.start(T_START)
    while not solver.replay():
        pass
    launches: list[tuple[str, Callable[[], None]]] = []
    over_cells, over_runs = solver._over_cells, solver._over_runs

    def note_cells(kernel: Any, *arguments: Any) -> None:
        launches.append((kernel.key, lambda: over_cells(kernel, *arguments)))

    def note_runs(kernel: Any, arguments: Sequence[Any]) -> None:
        launches.append((kernel.key, lambda: over_runs(kernel, arguments)))

    noted: Any = solver
    noted._over_cells, noted._over_runs = note_cells, note_runs
    solver.step()
    solver.state.active.fill_(1)
    return {name.split("__")[-1]: _repeated(launch, cells) for name, launch in launches if "tick" not in name}


def _repeated(launch: Callable[[], None], cells: int) -> Callable[[], float]:
    with wp.ScopedCapture(device="cpu") as capture:
        for _ in range(200):
            launch()

    def round_() -> float:
        began = time.perf_counter()
        wp.capture_launch(capture.graph)
        return (time.perf_counter() - began) / 200 / cells * 1e9

    return round_


def measured(rounds: dict[str, Callable[[], float]]) -> dict[str, list[float]]:
    """All rounds of each, interleaved, after one that does not count."""
    for round_ in rounds.values():
        round_()
    figures: dict[str, list[float]] = {name: [] for name in rounds}
    for _ in range(ROUNDS):
        for name, round_ in rounds.items():
            figures[name].append(round_())
    return figures


def show(title: str, figures: dict[str, list[float]], against: str | None = None) -> None:
    """Print a table of medians."""
    print(f"\n{title}\n{'':34s} median     min     max" + ("   times faster" if against else ""))
    for name, values in figures.items():
        median = statistics.median(values)
        line = f"{name:34s} {median:6.2f}  {min(values):6.2f}  {max(values):6.2f}"
        if against:
            ratios = [a / b for a, b in zip(figures[against], values, strict=True)]
            line += f"   {statistics.median(ratios):6.1f}"
        print(line)


def main() -> None:
    """Measure and print."""
    start_quietly()
    for cells in (1_000, 10_000):
        rounds = {"NumPy reference": numpy_reference(cells)}
        for precision in ("float64", "float32"):
            for window in (False, True):
                label = f"kernels, {precision}, " + ("window" if window else "full range")
                rounds[label] = kernels(cells, precision, window)
        show(f"{cells} cells, 1 run, 1 thread: ns per cell-step", measured(rounds), against="NumPy reference")
    for precision in ("float64", "float32"):
        show(f"by stage, {precision}, 1000 cells: ns per cell", measured(stages(1_000, precision)))


if __name__ == "__main__":
    main()
