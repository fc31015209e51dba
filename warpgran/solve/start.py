"""The start of runs on finer cells (`scheme.start`): blocks of their own, level after level, before the run proper.

A level computes some of the runs of a block at a time, so that it takes about as much memory as the block proper. Its
solver pauses each run at its next output time or at the end of the level. An output is recorded by the solver of the
run proper, from means over its cells; at the end of a level its means are the state that the next one starts from. How
runs are grouped has no part in what each does: its bits are those of the run alone.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator, Sequence
from itertools import groupby

import numpy as np
import warp as wp

from warpgran.arrays import Array
from warpgran.case.case import Case
from warpgran.case.wave_steps import wave_speed
from warpgran.kernels.build import build_means
from warpgran.kernels.clock import OK, STEP_LIMIT
from warpgran.kernels.precision import BLOCK
from warpgran.physics.second_order import end_of_level
from warpgran.solve.checkpoint import Checkpoint
from warpgran.solve.solver import Solver, calls
from warpgran.solve.state import padded_cells


def solvers(
    solver: Solver, cases: Sequence[Case], checkpoint: Checkpoint | None = None
) -> Generator[Solver, None, None]:
    """Load cases, and hand out what computes them: each is to be replayed until it returns True.

    The last is the solver itself, whose state has the time, the steps and the output of all levels; with a checkpoint
    of a single case, which is one of the run proper, it is the only one. A caller may leave at any time.
    """
    solver.load(cases, checkpoint)
    if checkpoint is not None:
        yield solver
        return
    waves = [wave_speed(case.refined(case.scheme.start_levels)) for case in cases]
    levels = [case.scheme.start_levels if wave > 0.0 else 0 for case, wave in zip(cases, waves, strict=True)]
    started = np.flatnonzero(levels)
    if started.size:
        with calls:
            _put(solver.state.due, started, 0)  # output at t = 0 is that of the finest level
        for highest, runs in groupby(sorted(started.tolist(), key=levels.__getitem__), key=levels.__getitem__):
            yield from _start(solver, cases, waves, list(runs), highest)
        solver.find_fastest()
    yield solver


def group_size(capacity: int, levels: int) -> int:
    """Runs that are computed at a time on the finer cells of that many levels, of a block of some capacity."""
    return max(1, capacity >> levels)


def _start(
    solver: Solver, cases: Sequence[Case], waves: Sequence[float], runs: list[int], highest: int
) -> Iterator[Solver]:
    """The start of runs that have as many levels."""
    size = group_size(solver.state.runs, highest)
    for first in range(0, len(runs), size):
        group = np.array(runs[first : first + size])
        levels = [
            _Level(solver, group, [cases[r] for r in group], [waves[r] for r in group], level, size)
            for level in range(highest, 0, -1)
        ]
        for n, level in enumerate(levels):
            level.load(levels[n - 1].finer if n else None)
            yield from level.segments()
        with calls:
            hand_over(levels[-1].finer, solver, level.going(group), 1)


class _Level:
    """A level of the start of some runs.

    Attributes:
        finer: Its solver.
    """

    def __init__(
        self, solver: Solver, runs: Array, cases: Sequence[Case], waves: Sequence[float], level: int, size: int
    ) -> None:
        self._solver, self._runs, self._level = solver, runs, level
        self._cases = [case.refined(level) for case in cases]
        self._ends = np.array([end_of_level(case, wave) for case, wave in zip(self._cases, waves, strict=True)])
        self._limits = np.array([min(case.time.step_limit, 2**62) for case in cases])
        self.finer = solver.finer(level, size)

    def load(self, before: Solver | None) -> None:
        """Put the runs at their initial state, or at the end of the level before."""
        self.finer.load(self._cases)
        if before is not None:
            state, coarse = self.finer.state, self._solver.state
            places = np.arange(self._runs.size)
            with calls:
                _put(state.t, places, coarse.t.numpy()[self._runs])
                _put(state.steps, places, coarse.steps.numpy()[self._runs])
                hand_over(before, self.finer, self.going(places), 1)
            self.finer.find_fastest()

    def segments(self) -> Iterator[Solver]:
        """The solver, again and again until every run has ended or reached the end of the level."""
        while self._set_stops():
            try:
                yield self.finer
            finally:
                self._report()

    def going(self, places: Array) -> Array:
        """The places of the runs that have not ended, -1 for the others."""
        return np.where(self._solver.state.active.numpy()[self._runs] != 0, places, -1)

    def _set_stops(self) -> bool:
        """Record the runs that are due and let each run up to its next stop; whether any has one."""
        finer, coarse, n = self.finer.state, self._solver.state, self._runs.size
        times = coarse.outputs.times
        with calls:
            t = finer.t.numpy()[:n]
            due = np.where(self._next(times) <= t, self.going(self._runs), -1)
            if (due >= 0).any():
                _put(coarse.due, due[due >= 0], 1)
                hand_over(self.finer, self._solver, due, self._level)
                self._solver.launch(self._solver.stages.look)
            going = self.going(self._runs)
            spent = going[(going >= 0) & (finer.steps.numpy()[:n] >= self._limits)]
            _put(coarse.status, spent, STEP_LIMIT)
            _put(coarse.active, spent, 0)
            advances = (self.going(self._runs) >= 0) & (t < self._ends)
            _put(finer.t_stop, np.arange(n), np.minimum(self._next(times), self._ends))
            _put(finer.active, np.arange(n), advances)
        return bool(advances.any())

    def _next(self, times: Array) -> Array:
        """Next output time of each run [s]; the last, where all are recorded."""
        return times[np.minimum(self._solver.state.output.numpy()[self._runs], times.size - 1)]

    def _report(self) -> None:
        """Tell the state of the run proper how far the runs are, and which have ended within a step."""
        finer, coarse, n = self.finer.state, self._solver.state, self._runs.size
        with calls:
            steps, status = finer.steps.numpy()[:n], finer.status.numpy()[:n]
            cells = np.array(finer.cells[:n]) - np.array(coarse.cells)[self._runs]
            coarse.start_surplus[self._runs] += (steps - coarse.steps.numpy()[self._runs]) * cells
            _put(coarse.t, self._runs, finer.t.numpy()[:n])
            _put(coarse.steps, self._runs, steps)
            ended = status != OK
            _put(coarse.status, self._runs[ended], status[ended])
            _put(coarse.active, self._runs[ended], 0)


def hand_over(fine: Solver, coarse: Solver, to: Array, levels: int) -> None:
    """Set runs of a coarser state to the means of U over 2^levels cells of a finer one, and widen their windows.

    Args:
        fine: What has the runs.
        coarse: What gets them.
        to: For each run of `fine` its place in `coarse`, -1 if it stays as it is there.
        levels: Between the two.
    """
    a, b = fine.state, coarse.state
    every = np.full(a.runs, -1, dtype=np.int32)
    every[: to.size] = to
    moved = every >= 0
    if not moved.any():
        return
    targets = wp.array(every, dtype=wp.int32, device=coarse.device)
    cells = max(b.cells[r] for r in every[moved])
    wp.launch(
        build_means(b.variant.precision),
        dim=(a.runs, cells),
        inputs=[levels, a.params, *a.U, targets, b.params, b.due, *b.U],
        device=coarse.device,
        block_dim=coarse.lanes,
    )
    # A window ends in cells that are empty; so many of the coarser ones are added as a step asks for.
    at, empty = every[moved], b.scheme.empty
    longest = np.array([padded_cells(b.cells[r]) for r in at])
    lo = np.maximum((a.lo.numpy()[moved] >> levels) - empty, 0) // BLOCK * BLOCK
    last = -(-a.hi.numpy()[moved] // 2**levels) + empty
    hi = np.minimum(-(-(last + 1) // BLOCK) * BLOCK, longest)
    _put(b.lo, at, np.minimum(b.lo.numpy()[at], lo))
    _put(b.hi, at, np.maximum(b.hi.numpy()[at], hi))


def _put(array: wp.array, at: Array, values: Array | int) -> None:
    """Set elements of an array of the device."""
    if at.size:
        changed = np.array(array.numpy())
        changed[at] = values
        array.assign(changed)
