"""What a cell-step of each scheme costs: both orders in one process, in interleaved rounds.

    python benchmarks/orders.py [--rounds N]

The work is that of throughput.py: the dense column on a horizontal plane, cells of 1 mm on 1 m of grid, from rest to
0.3 s, a block of runs that fits the cache of a core, one thread; and a single run of 450 cells, which is bound by
launches. Medians of rounds; a ratio is the median of the ratios of each round.
"""

from __future__ import annotations

import argparse
import statistics
import time
from typing import NamedTuple, get_args

import warpgran as wg
from warpgran.run.options import Precision
from warpgran.solve.blocks import CACHE
from warpgran.solve.device import start_quietly
from warpgran.solve.schedule import Outputs
from warpgran.solve.solver import Solver
from warpgran.solve.state import bytes_of_run
from warpgran.solve.variant import variant_of


class Work(NamedTuple):
    """What is measured: the scheme, how, and the cells of a run; a block of runs, or one."""

    order: int
    precision: Precision
    window: bool
    cells: int = 1000
    block: bool = True


WORKS = [
    Work(order, precision, window) for precision in get_args(Precision) for window in (False, True) for order in (1, 2)
] + [Work(order, "float64", True, 450, block=False) for order in (1, 2)]


class Measured:
    """A solver for a work, and its rounds: cost of a cell-step, ns."""

    def __init__(self, work: Work) -> None:
        scheme = {"scheme.order": work.order, "scheme.window": work.window}
        grid = {"slope.angle": 0.0, "grid.right": 0.8, "grid.cells": work.cells}
        case = wg.Case().with_(
            **{**grid, **scheme, "time.end": 0.3, "time.snapshots": [], "time.series": [0.3]},
            **({"scheme.start": 0} if work.order == 2 else {}),
        )
        size = bytes_of_run(work.cells, Outputs.none(), variant_of(case, work.precision))
        self.cases = [case] * (max(1, int(CACHE / size)) if work.block else 1)
        self.work, self.rounds = work, list[float]()
        self.solver = Solver.holding(self.cases, precision_name=work.precision)

    def round(self) -> float:
        """Compute all runs once."""
        self.solver.load(self.cases)
        began = time.perf_counter()
        while not self.solver.replay():
            pass
        seconds = time.perf_counter() - began
        return 1e9 * seconds / (self.steps * self.work.cells * len(self.cases))

    @property
    def steps(self) -> int:
        """Of a run."""
        return int(self.solver.state.steps.numpy()[0])


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=7)
    rounds: int = parser.parse_args().rounds
    start_quietly()
    measured = [Measured(work) for work in WORKS]
    for one in measured:
        one.round()  # compiles
    for _ in range(rounds):
        for one in measured:
            one.rounds.append(one.round())
    print("ns per cell-step, median (least)    order 1          order 2          ratio   steps")
    for first, second in zip(measured[::2], measured[1::2], strict=True):
        work = first.work
        ratio = statistics.median(b / a for a, b in zip(first.rounds, second.rounds, strict=True))
        what = f"{work.precision}, {'window' if work.window else 'full range'}, {len(first.cases)} x {work.cells}"
        told = [f"{statistics.median(m.rounds):6.2f} ({min(m.rounds):5.2f})" for m in (first, second)]
        print(f"{what:35} {told[0]:16} {told[1]:16} {ratio:5.2f}   {first.steps}, {second.steps}")
        if not work.block:
            steps = [statistics.median(m.rounds) * work.cells * 1e-3 for m in (first, second)]
            print(f"{'  a step of that run, microseconds':35} {steps[0]:6.1f}           {steps[1]:6.1f}")


if __name__ == "__main__":
    main()
