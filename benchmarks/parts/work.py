"""What is measured: the dense column in motion, in blocks of runs on threads as the product has them, round by round.

A round of a work replays its blocks for a number of steps from the same state, by each thread its share of them, one
after another. Runs of a block are alike, which costs as much as runs that differ: the kernels do not branch.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Hashable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, Literal, TypeVar

import numpy as np
import warp as wp

from warpgran.case.case import Case
from warpgran.case.study import Study
from warpgran.run.options import Options
from warpgran.solve.blocks import Block, plan
from warpgran.solve.schedule import Outputs
from warpgran.solve.solver import Solver

T_START = 0.1
"""Time [s] from which steps are measured: the column has begun to move."""
AT_LEAST = 4_000_000
"""Cell-steps of a round of a thread, so that it lasts long enough to be timed."""
TRIES = 3
UNDISTURBED = 0.95
"""Share of the processor time of the best round that a round must have had."""

Array = np.ndarray
Precision = Literal["float64", "float32"]
Round = Callable[[], float]
Key = TypeVar("Key", bound=Hashable)


@dataclass(frozen=True)
class Work:
    """One combination.

    Attributes:
        cells: Of each run.
        runs: Computed together by all threads.
        precision: "float64" or "float32".
        window: Whether only what is wet is visited.
        threads: Blocks at once.
        order: Scheme, by its order.
        start: Levels of its start on finer cells; None for the default.
    """

    cells: int
    runs: int
    precision: Precision = "float64"
    window: bool = False
    threads: int = 1
    order: int = 2
    start: int | None = None

    @property
    def scheme(self) -> dict[str, int]:
        """Keys of the run file that choose the scheme."""
        return {"scheme.order": self.order} | ({} if self.start is None else {"scheme.start": self.start})

    @property
    def case(self) -> Case:
        """The dense column on a horizontal plane, with no output on the way."""
        return column(self.cells, self.window, self.scheme)

    def blocks(self) -> list[Block]:
        """How a computation of this many runs is cut."""
        case = self.case
        memory = Options(precision=self.precision, threads=self.threads).bytes
        study = Study.of([case] * self.runs)
        return plan(study, range(self.runs), Outputs.of(case), self.precision, on_cpu=True, threads=self.threads,
                    memory=memory)  # fmt: skip


def column(cells: int, window: bool, changes: Mapping[str, Any] | None = None) -> Case:
    """The dense column on a horizontal plane, 1000 cells of 1 mm, by the default scheme; changes by dotted key.

    One output by default, later than is reached.
    """
    values: dict[str, Any] = {"grid.right": 0.8, "grid.cells": cells, "scheme.window": window}
    values |= {"time.end": 10.0, "time.snapshots": [10.0], "time.series": []}
    return Case().with_(**(values | dict(changes or {})))


def clock_of(device: Any) -> Callable[[], float]:
    """Processor time of the thread [s], which others on the machine do not touch but for its caches; of a GPU, time."""
    return time.thread_time if device.is_cpu else time.perf_counter


class Moving:
    """A solver full of columns in motion, which can be put back to where it was.

    Args:
        case: Of all its runs.
        block: How many, and their shape.
        start: Time [s] that they have reached.
        where: The device, and other keywords of a solver.

    Attributes:
        solver: It, at `start` or some steps later.
    """

    def __init__(self, case: Case, block: Block, start: float = T_START, **where: Any) -> None:
        self.solver = Solver(block.capacity, block.padded, block.variant, Outputs.of(case), **where)
        self.solver.load([case] * block.capacity)
        state = self.solver.state
        while float(state.t.numpy()[0]) < start:
            self.solver.replay(budget=20)
        self._kept = [(array, wp.clone(array)) for array in _arrays(vars(state).values())]
        self._clock = clock_of(self.solver.device)

    def put_back(self) -> None:
        """Undo all steps since the start."""
        for live, kept in self._kept:
            wp.copy(live, kept)

    def seconds(self, steps: int) -> float:
        """Time of some steps from the start."""
        self.put_back()
        wp.synchronize_device(self.solver.device)
        began = self._clock()
        self.solver.replay(budget=steps)
        return self._clock() - began

    @property
    def U(self) -> Array:
        """State of the first run, shape (3, cells)."""
        return np.stack([self.solver.state.of_run(u, 0) for u in self.solver.state.U])

    @property
    def visited(self) -> float:
        """Share of the cells that the window holds, now."""
        state = self.solver.state
        return min(1.0, float(state.hi.numpy()[0] - state.lo.numpy()[0]) / state.cells[0])


def _arrays(values: Any) -> Iterator[Any]:
    """The Warp arrays among some values and in tuples of them."""
    for value in values:
        if isinstance(value, wp.array):
            yield value
        elif isinstance(value, tuple):
            yield from _arrays(value)


class Crews:
    """Solvers in motion, one for each thread, kept for all works that need the same."""

    def __init__(self) -> None:
        self._kept: dict[Hashable, list[Moving]] = {}

    def of(self, work: Work) -> list[Moving]:
        """As many solvers as the work has threads."""
        block = work.blocks()[0]
        crew = self._kept.setdefault((work.case, block), [])
        while len(crew) < work.threads:
            crew.append(Moving(work.case, block))
        return crew[: work.threads]

    def round_of(self, work: Work, steps: int) -> Round:
        """A round that returns ns per cell-step of a work: time of the thread that takes longest over all it does."""
        crew = self.of(work)
        blocks = work.blocks()
        in_block = blocks[0].capacity * work.cells * steps
        repeats = max(1, -(-AT_LEAST * work.threads // (in_block * len(blocks))))
        count = len(blocks) * repeats
        shares = [len(range(thread, count, work.threads)) for thread in range(work.threads)]

        def share(moving: Moving, blocks: int) -> float:
            return sum(moving.seconds(steps) for _ in range(blocks))

        def round_() -> float:
            with ThreadPoolExecutor(work.threads) as pool:
                longest = max(pool.map(share, crew, shares))
            return longest * 1e9 / (count * in_block)

        return round_


def measured(rounds: Mapping[Key, Round], count: int) -> tuple[dict[Key, list[float]], dict[Key, float]]:
    """All rounds of each, interleaved, after one that does not count; and the processors that the best of them had.

    A round that had clearly less of the processors than another of its kind shared them with a stranger: it is
    repeated, a few times at most.
    """
    figures: dict[Key, list[float]] = {name: [] for name in rounds}
    most = dict.fromkeys(rounds, 0.0)
    for turn in range(count + 1):
        for name, round_ in rounds.items():
            for _ in range(TRIES):
                figure, busy = _watched(round_)
                most[name] = max(most[name], busy)
                if busy > UNDISTURBED * most[name]:
                    break
            if turn > 0:
                figures[name].append(figure)
    return figures, most


def _watched(round_: Round) -> tuple[float, float]:
    """The figure of a round, and how many processors it had."""
    wall, processor = time.perf_counter(), time.process_time()
    figure = round_()
    return figure, (time.process_time() - processor) / (time.perf_counter() - wall)


def median_ratio(above: list[float], below: list[float]) -> float:
    """Median of the ratios of each round, which what slows a whole round does not touch."""
    return statistics.median(a / b for a, b in zip(above, below, strict=True))


def middle_half(values: list[float]) -> tuple[float, float]:
    """Where the middle half of the rounds begins and ends."""
    low, high = np.percentile(values, [25, 75])
    return float(low), float(high)
