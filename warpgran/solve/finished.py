"""What an engine returns: runs that have ended, and where those that diverged did so."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from warpgran.arrays import Array
from warpgran.physics.state import DRY
from warpgran.physics.state import SCALARS as SCALARS


@dataclass(frozen=True)
class Failure:
    """Where a run diverged.

    Attributes:
        time: Time of the last sound state, s.
        step: The step that spoiled it.
        cell: Index, -1 if it is the time step that failed.
        x: Centre of the cell, m.
        what: The value that is wrong.
    """

    time: float
    step: int
    cell: int
    x: float
    what: str

    def __str__(self) -> str:
        where = f"in cell {self.cell} (x = {self.x:.6g} m)" if self.cell >= 0 else "in the time step"
        return f"diverged after t = {self.time:.6g} s, at step {self.step}, {where}: {self.what}"


@dataclass(frozen=True)
class Finished:
    """Runs that have ended. What was not recorded is NaN.

    Attributes:
        scalars: Those of physics.state.SCALARS, shape (runs, samples, scalars).
        profiles: h [m], v [m/s], phi of the snapshots, each (runs, snapshots, cells or more).
        status, steps, end_time: Per run; codes of schema.Status, -, s.
        cell_steps: Per run, sum over its steps of the cells that each was taken on; those of this session.
        failures: By run, those that have diverged.
        seconds: Wall time of the time loop alone, in this session.
    """

    scalars: Array
    profiles: tuple[Array, ...]
    status: Array
    steps: Array
    end_time: Array
    cell_steps: Array
    failures: dict[int, Failure]
    seconds: float


def fault(U: Array) -> tuple[int, str] | None:
    """First cell of a state (3, cells) that is not sound and what is wrong there, None if all are.

    Sound is: finite, no negative mass (beyond the rounding of a dry cell), and phi in (0, 1] where it is wet.
    """
    U0, _, U2 = U
    wet = U0 > DRY
    finite = np.isfinite(U).all(axis=0)
    with np.errstate(invalid="ignore"):
        sound = finite & (U0 >= -DRY) & (~wet | ((U2 > 0.0) & (U2 <= U0)))
    bad = np.flatnonzero(~sound)
    return (int(bad[0]), _describe(*U[:, bad[0]])) if bad.size else None


def _describe(U0: float, U1: float, U2: float) -> str:
    """What is wrong with a state that is not sound."""
    if not np.isfinite([U0, U1, U2]).all():
        return f"not finite: phi h = {U0:g} m, phi h v = {U1:g} m2/s, phi^alpha h = {U2:g} m"
    if U0 < -DRY:
        return f"negative mass: phi h = {U0:g} m"
    return f"phi outside (0, 1]: phi^alpha h = {U2:g} m with phi h = {U0:g} m"
