"""What advances a batch in time: the Warp kernels, or the NumPy reference, behind the same few methods."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from warpgran.case import Case
from warpgran.reference import DRY, Reference
from warpgran.schema import Status

Array = np.ndarray


@dataclass(frozen=True)
class Failure:
    """Where a run diverged.

    Attributes:
        run: index in the batch.
        time: of the last sound state, s.
        step: the step that spoiled it.
        cell: index, -1 if it is the time step that failed.
        x: centre of the cell, m.
        what: the value that is wrong.
    """

    run: int
    time: float
    step: int
    cell: int
    x: float
    what: str

    def __str__(self) -> str:
        where = f"in cell {self.cell} (x = {self.x:.6g} m)" if self.cell >= 0 else "in the time step"
        return f"run {self.run} diverged after t = {self.time:.6g} s, at step {self.step}, {where}: {self.what}"


class Engine(Protocol):
    """A batch of runs being advanced. Arrays are (runs,).

    Whether a run has diverged is judged at output times alone, so that it does not depend on how the steps between
    are grouped; the step where it happened is then looked for.
    """

    device: str
    status: Array
    failures: list[Failure]

    @property
    def t(self) -> Array:
        """Time of each run, s."""

    @property
    def steps(self) -> Array:
        """Steps of each run."""

    def advance(self, t_out: float, go_on: Callable[[], bool]) -> None:
        """Bring every sound run to t_out [s]; go_on is asked now and then, and may say no."""

    def profiles(self) -> Sequence[Sequence[Array]]:
        """h [m], v [m/s], phi [-], for each an array a run."""

    def scalars(self) -> dict[str, Array]:
        """The scalars of the series."""


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
    return (int(bad[0]), describe(*U[:, bad[0]])) if bad.size else None


def describe(U0: float, U1: float, U2: float) -> str:
    """What is wrong with a state that is not sound."""
    if not np.isfinite([U0, U1, U2]).all():
        return f"not finite: phi h = {U0:g} m, phi h v = {U1:g} m2/s, phi^alpha h = {U2:g} m"
    if U0 < -DRY:
        return f"negative mass: phi h = {U0:g} m"
    return f"phi outside (0, 1]: phi^alpha h = {U2:g} m with phi h = {U0:g} m"


class WarpEngine:
    """The kernels, on any Warp device. Cases of one variant of the scheme make one batch on the device."""

    def __init__(self, cases: Sequence[Case], device: str = "cpu", precision: str = "float64") -> None:
        from warpgran.solver import Solver, variant_of

        self.cases = cases
        self.device = device
        self.status = np.full(len(cases), Status.OK, dtype=np.int8)
        self.failures: list[Failure] = []
        groups: dict[Any, list[int]] = {}
        for r, case in enumerate(cases):
            groups.setdefault(variant_of(case, precision), []).append(r)
        self._solvers = [
            (np.array(members), Solver([cases[r] for r in members], device=device, precision_name=precision))
            for members in groups.values()
        ]
        for _, solver in self._solvers:
            solver.prepare()

    @property
    def t(self) -> Array:
        """Time of each run, s."""
        return self._collect(lambda solver: solver.state.t.numpy())

    @property
    def steps(self) -> Array:
        """Steps of each run."""
        return self._collect(lambda solver: solver.state.steps.numpy())

    def advance(self, t_out: float, go_on: Callable[[], bool]) -> None:
        """Bring every sound run to t_out [s]; go_on is asked now and then, and may say no."""
        for members, solver in self._solvers:
            solver.start(t_out)
            done = False
            while not done:
                done = solver.replay()
                if not go_on():
                    return
            self._examine(members, solver)

    def profiles(self) -> Sequence[Sequence[Array]]:
        """h [m], v [m/s], phi [-], for each an array a run."""
        out: list[list[Array]] = [[np.empty(0)] * len(self.cases) for _ in range(3)]
        for members, solver in self._solvers:
            for target, values in zip(out, solver.profiles(), strict=True):
                for r, value in zip(members, values, strict=True):
                    target[r] = value
        return out

    def scalars(self) -> dict[str, Array]:
        """The scalars of the series."""
        parts = [(members, solver.scalars()) for members, solver in self._solvers]
        out = {name: np.empty(len(self.cases)) for name in parts[0][1]}
        for members, values in parts:
            for name, value in values.items():
                out[name][members] = value
        return out

    def _collect(self, read: Callable[[Any], Array]) -> Array:
        parts = [(members, read(solver)) for members, solver in self._solvers]
        out = np.empty(len(self.cases), dtype=parts[0][1].dtype)
        for members, values in parts:
            out[members] = values
        return out

    def _examine(self, members: Array, solver: Any) -> None:
        """Find the runs that have diverged on the way to an output time, bring them back to their last sound step."""
        for i in solver.diverged():
            r = int(members[i])
            step, cell, state = solver.rewind(i)
            t = float(solver.state.t.numpy()[i])
            x, what = (float(self.cases[r].x[cell]), describe(*state)) if cell >= 0 else (np.nan, "dt is not positive")
            self.failures.append(Failure(r, t, step, cell, x, what))
        self.status[members] = solver.state.status.numpy()
        solver.save()


class NumPyEngine:
    """The reference implementation, one run after another."""

    LOOK = 100  # steps between two questions whether to go on

    def __init__(self, cases: Sequence[Case]) -> None:
        self.device = "cpu"
        self._runs = [Reference(case) for case in cases]
        self.status = np.full(len(cases), Status.OK, dtype=np.int8)
        self.failures: list[Failure] = []

    @property
    def t(self) -> Array:
        """Time of each run, s."""
        return np.array([run.t for run in self._runs])

    @property
    def steps(self) -> Array:
        """Steps of each run."""
        return np.array([run.steps for run in self._runs])

    def advance(self, t_out: float, go_on: Callable[[], bool]) -> None:
        """Bring every sound run to t_out [s]; go_on is asked now and then, and may say no."""
        for r, run in enumerate(self._runs):
            if self.status[r] != Status.OK:
                continue
            before = run.U, run.t, run.steps
            dt = np.inf
            while dt > 0.0 and run.t < t_out and run.steps < run.case.time.step_limit:
                dt = self._step(run, t_out)
                if run.steps % self.LOOK == 0 and not go_on():
                    return
            if run.t < t_out:
                self.status[r] = Status.STEP_LIMIT
            if not dt > 0.0 or fault(run.U):
                run.U, run.t, run.steps = before
                self._find_fault(r, run, t_out)

    def profiles(self) -> Sequence[Sequence[Array]]:
        """h [m], v [m/s], phi [-], for each an array a run."""
        fields = [run.fields for run in self._runs]
        return [[f.h for f in fields], [f.v for f in fields], [f.phi for f in fields]]

    def scalars(self) -> dict[str, Array]:
        """The scalars of the series."""
        each = [run.scalars() for run in self._runs]
        return {name: np.array([one[name] for one in each]) for name in each[0]}

    @staticmethod
    def _step(run: Reference, t_out: float) -> float:
        """A step; dt [s]."""
        with np.errstate(all="ignore"):  # what comes of it is judged at the output time
            return run.step(t_out)

    def _find_fault(self, r: int, run: Reference, t_out: float) -> None:
        """Repeat the steps of a run that has diverged, up to the last sound one."""
        found = None
        while not found:
            before = run.U, run.t, run.steps
            dt = self._step(run, t_out)
            found = fault(run.U) if dt > 0.0 else (-1, "dt is not positive")
        cell, what = found
        x = float(run.case.x[cell]) if cell >= 0 else np.nan
        self.failures.append(Failure(r, before[1], run.steps, cell, x, what))
        self.status[r] = Status.DIVERGED
        run.U, run.t, run.steps = before
