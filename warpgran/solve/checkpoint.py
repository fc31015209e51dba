"""A run between two steps, as the numbers from which it goes on to the bits of a run that was never stopped."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple, Protocol

from warpgran.arrays import Array

PER_RUN = ("t", "steps", "output", "due", "v_flow", "max_speed", "max_viscosity")
"""Arrays of a solver's state, an element a run, that a run goes on from; see `solve.state.State`."""
NUMBERS = (*PER_RUN, "start_surplus", "seconds")
"""Names of a checkpoint's numbers: those, cell-steps of the start beyond as many on the cells of the run proper, and
wall time of the time loop so far [s]."""


class Checkpoint(NamedTuple):
    """A run proper on its way; float64 holds every float32.

    Attributes:
        U: phi h [m], phi h v [m2/s], phi^alpha h [m] of its cells, shape (3, cells).
        scalars: The samples so far, shape (samples, scalars); NaN where there is none yet.
        profiles: h [m], v [m/s], phi of the snapshots so far, each (snapshots, cells); NaN where there is none yet.
            Perhaps the run's own arrays, since a snapshot does not change any more.
        numbers: Each of NUMBERS.
    """

    U: Array
    scalars: Array
    profiles: tuple[Array, ...]
    numbers: Mapping[str, float]

    @property
    def cell_steps(self) -> int:
        """Sum over its steps of the cells that each was taken on."""
        return int(self.numbers["steps"]) * self.U.shape[1] + int(self.numbers["start_surplus"])


class Keeper(Protocol):
    """Keeps a single run while it is computed, for a later session."""

    @property
    def kept(self) -> Checkpoint | None:
        """The last checkpoint that it has, of this session or an earlier one; None if there is none."""

    def keep(self, checkpoint: Checkpoint) -> None:
        """Keep a checkpoint instead of the last."""
