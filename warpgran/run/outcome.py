"""What a computation reports beside its results, and where the results go."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from warpgran.arrays import Array
from warpgran.case.case import Case
from warpgran.results.layout import Layout
from warpgran.run.options import Options
from warpgran.solve.finished import Finished


class Sink(Protocol):
    """Where results go."""

    layout: Layout

    def put(self, at: Sequence[int], rows: Mapping[str, Array]) -> None:
        """Store rows of `Layout.rows` at these places."""


@dataclass
class Outcome:
    """What there is to tell of a computation.

    Attributes:
        interrupted: Whether Ctrl-C ended it.
        failures: Words for each run that diverged, by its number in the study.
        cell_steps: Sum over runs of steps times cells.
        kernel_seconds: Of the time loops, averaged over the threads.
        wall_seconds: Of all.
    """

    interrupted: bool = False
    failures: dict[int, str] = field(default_factory=dict)
    cell_steps: int = 0
    kernel_seconds: float = 0.0
    wall_seconds: float = 0.0


def attributes(options: Options, outcome: Outcome) -> dict[str, Any]:
    """Attributes of a result that tell how it was computed."""
    return {
        "device": options.device,
        "precision": options.precision,
        "engine": options.engine,
        "threads": options.workers,
        "cell_steps": outcome.cell_steps,
        "kernel_seconds": outcome.kernel_seconds,
        "wall_seconds": outcome.wall_seconds,
    }


def account(outcome: Outcome, layout: Layout, at: Sequence[int], cases: Sequence[Case], finished: Finished) -> None:
    """Add a block that has ended to what there is to tell."""
    cells = np.array([case.grid.cells for case in cases])
    outcome.cell_steps += int((finished.steps * cells).sum())
    outcome.kernel_seconds += finished.seconds
    for r, failure in finished.failures.items():
        outcome.failures[int(layout.runs[at[r]])] = str(failure)
