"""The interface between a computation and its caller: what computes, where results go, and what is reported."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from warpgran.arrays import Array
from warpgran.case.case import Case
from warpgran.results.layout import Layout
from warpgran.run.options import DECISIVE, Options
from warpgran.solve.checkpoint import Keeper
from warpgran.solve.finished import Finished

Progress = Callable[[float], None]
"""Called now and then with the number of runs done, parts of runs included."""


class Sink(Protocol):
    """Where results go: `results.in_memory.MemoryResults` or `results.part_file.PartFile`."""

    layout: Layout

    @property
    def keeper(self) -> Keeper | None:
        """What keeps the run while it is under way, if it is the only one and the results are there to stay."""

    def put(self, at: Sequence[int], rows: Mapping[str, Array]) -> None:
        """Store rows of `Layout.rows` at these places of `layout.runs`."""

    def spend(self, cell_steps: int, kernel_seconds: float) -> None:
        """Take note of what runs that were stored have taken."""


@dataclass
class Outcome:
    """What a computation reports beside its results.

    Attributes:
        interrupted: Whether Ctrl-C ended it.
        failures: How each run that diverged did so, by its number in the study.
        threads: Threads that computed.
        cell_steps: Sum over the steps of all runs of the cells that each was taken on.
        kernel_seconds: Time loops alone, averaged over the threads.
        wall_seconds: The whole computation.
        spoiled: Runs of an earlier start whose numbers were damaged in the file, so that they were computed again.
        resumed_at, kept_at: Time of the checkpoint from which a single run went on, and of the last one that is kept of
            it, s; None if there is none.
    """

    interrupted: bool = False
    failures: dict[int, str] = field(default_factory=dict)
    threads: int = 0
    cell_steps: int = 0
    kernel_seconds: float = 0.0
    wall_seconds: float = 0.0
    spoiled: int = 0
    resumed_at: float | None = None
    kept_at: float | None = None


class Compute(Protocol):
    """What computes: `threads.compute`, or `cluster.compute` with its client."""

    def __call__(self, sink: Sink, options: Options, runs: Sequence[int], progress: Progress, /) -> Outcome:
        """Compute runs of `sink.layout.study` and store them in the sink as they end.

        Args:
            sink: Where results go.
            options: How to compute.
            runs: Numbers of the runs in the study, each one of `sink.layout.runs`.
            progress: Called with the number of runs done.
        """


def store(
    sink: Sink, outcome: Outcome, runs: Sequence[int], cases: Sequence[Case], finished: Finished, at_once: int
) -> None:
    """Hand a block that has ended, one of so many at a time, to the sink, and count it in the outcome."""
    layout = sink.layout
    sink.put(np.searchsorted(layout.runs, runs).tolist(), layout.rows(cases, finished))
    cell_steps, seconds = int(finished.cell_steps.sum()), finished.seconds / at_once
    sink.spend(cell_steps, seconds)
    outcome.cell_steps += cell_steps
    outcome.kernel_seconds += seconds
    outcome.failures |= {runs[r]: str(failure) for r, failure in finished.failures.items()}


def attributes(options: Options, outcome: Outcome) -> dict[str, Any]:
    """Attributes of a result that say how it was computed."""
    measured = ("threads", "cell_steps", "kernel_seconds", "wall_seconds")
    decided = {name: getattr(options, name) for name in ("device", *DECISIVE)}
    return decided | {name: getattr(outcome, name) for name in measured}
