"""What a cell-step of each scheme costs: both orders in one process, in interleaved rounds.

    python benchmarks/orders.py [--rounds N]

The dense column on a horizontal plane, cells of 1 mm on 1 m of grid, from rest to 0.3 s: a block of such as the product
cuts 64 runs into for one thread, by order 1, by order 2 without its start on finer cells, and with it, by default,
where the cell-steps of the start count; and a single run of 450 cells, which is bound by launches. Processor time of
one thread in the time loops, medians of rounds; a ratio is the median of the ratios of each round.
"""

from __future__ import annotations

import argparse
import statistics
import time
from contextlib import closing
from dataclasses import replace
from typing import get_args

import numpy as np
from parts.report import machine, noise
from parts.work import Precision, Round, Work, column, measured, median_ratio

from warpgran.solve.device import start_quietly
from warpgran.solve.schedule import Outputs
from warpgran.solve.solver import Solver
from warpgran.solve.start import solvers

END = 0.3  # s
BLOCKS = [Work(1000, 64, precision, window) for precision in get_args(Precision) for window in (False, True)]
ALONE = Work(450, 1, "float64", window=True)


def from_rest(work: Work) -> Round:
    """A round that computes a block of a work from rest and returns ns per cell-step."""
    block = work.blocks()[0]
    case = column(work.cells, work.window, {"time.end": END, "time.snapshots": [END], **work.scheme})
    solver = Solver(block.capacity, block.padded, block.variant, Outputs.of(case))
    cases = [case] * len(block.runs)

    def round_() -> float:
        seconds = 0.0
        with closing(solvers(solver, cases)) as each:
            for running in each:
                began = time.thread_time()
                while not running.replay():
                    pass
                seconds += time.thread_time() - began
        state = solver.state
        return seconds * 1e9 / float((state.steps.numpy() * np.array(state.cells) + state.start_surplus).sum())

    return round_


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=5)
    rounds: int = parser.parse_args().rounds
    start_quietly()
    print("\n".join(f"{name}: {value}" for name, value in machine().items()))
    schemes = {"order 1": (1, None), "order 2": (2, 0), "with its start": (2, None)}
    works = {
        (work, name): replace(work, order=order, start=start)
        for work in (*BLOCKS, ALONE)
        for name, (order, start) in schemes.items()
    }
    figures, _ = measured({key: from_rest(work) for key, work in works.items()}, rounds)

    def shown(values: list[float]) -> str:
        return f"{statistics.median(values):8.2f} ({min(values):5.2f})"

    print(f"\nns per cell-step, median (least); {noise(figures)}")
    print(" " * 26 + "".join(f"{name:>16s}" for name in schemes) + "   ratios to order 1")
    for work in (*BLOCKS, ALONE):
        first, *others = (figures[work, name] for name in schemes)
        what = f"{work.precision}, {'window' if work.window else 'full range'}, "
        what += f"{work.cells}" if work is ALONE else "block"
        ratios = "".join(f"{median_ratio(other, first):7.2f}" for other in others)
        print(f"{what:26s}" + "".join(f"{shown(values):>16s}" for values in (first, *others)) + ratios)
    steps = "".join(f"{statistics.median(figures[ALONE, name]) * ALONE.cells * 1e-3:16.1f}" for name in schemes)
    print(f"{'  a step, microseconds':26s}{steps}")


if __name__ == "__main__":
    main()
