"""The two engines that compute a block of runs, Warp kernels and NumPy reference; both return a `Finished`."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from contextlib import closing
from copy import copy
from typing import TYPE_CHECKING

import numpy as np

from warpgran.arrays import Array
from warpgran.case.case import Case
from warpgran.physics.reference import reference
from warpgran.physics.state import Run
from warpgran.schema import Status
from warpgran.solve.checkpoint import Keeper
from warpgran.solve.finished import SCALARS, Failure, Finished, fault
from warpgran.solve.schedule import Outputs

if TYPE_CHECKING:
    from warpgran.solve.solver import Solver

GoOn = Callable[[float], bool]
"""Called now and then with the mean time reached [s]; False interrupts the runs."""
KEEP_EVERY = 60.0
"""Seconds between two checkpoints of a run."""
MOST_KEEPING = 0.02
"""Largest share of its time that a run spends on them, or they are farther apart."""


def run_kernels(solver: Solver, cases: Sequence[Case], go_on: GoOn, keeper: Keeper | None = None) -> Finished:
    """Compute cases, with their start on finer cells, in a solver of their variant and of sufficient capacity.

    Whether a run has diverged is judged at output times alone, so that it does not depend on how the steps between
    are grouped; the step where it happened is then searched for.

    Args:
        solver: Of their variant.
        cases: No more than its capacity.
        go_on: See GoOn.
        keeper: Of a single case: it goes on from what is kept. The run proper is kept now and then, and where it is
            interrupted; its start on finer cells is not.
    """
    from warpgran.solve.start import solvers

    n, state, seconds, interrupted = len(cases), solver.state, 0.0, False
    kept = keeper.kept if keeper else None
    before = kept.numbers["seconds"] if kept else 0.0
    with closing(solvers(solver, cases, kept)) as each:
        for running in each:
            began = time.perf_counter()
            keep_at = began + KEEP_EVERY
            while not interrupted and not running.replay():
                interrupted = not go_on(float(state.t.numpy()[:n].mean()))
                now = time.perf_counter()
                if keeper and running is solver and (interrupted or now > keep_at):
                    keeper.keep(state.checkpoint(before + seconds + now - began))
                    keep_at = now + max(KEEP_EVERY, (time.perf_counter() - now) / MOST_KEEPING)
            seconds += time.perf_counter() - began
            if interrupted:
                break
    status = state.status.numpy()[:n].astype(np.int8)
    status[state.active.numpy()[:n] != 0] = Status.INTERRUPTED
    diverged = np.flatnonzero(status == Status.DIVERGED).tolist()
    outputs = state.output.numpy()
    precision, device = state.variant.precision, str(solver.device)
    failures = {r: _find_failure(cases[r], int(outputs[r]), precision, device) for r in diverged}
    steps, end_time = state.steps.numpy()[:n].copy(), state.t.numpy()[:n].copy()
    for r, failure in failures.items():
        steps[r], end_time[r] = failure.step - 1, failure.time
    cell_steps = steps * np.array(state.cells[:n]) + state.start_surplus[:n] - (kept.cell_steps if kept else 0)
    profiles = tuple(field[:n] for field in state.recorded_profiles())
    return Finished(state.recorded_scalars()[:n], profiles, status, steps, end_time, cell_steps, failures, seconds)


def _find_failure(case: Case, output: int, precision: str, device: str) -> Failure:
    """Compute a run alone, which gives the same bits, and check every step up to the output that it did not reach.

    Args:
        case: One that diverges.
        output: Index of the first output time at which it was not sound.
        precision: "float64" or "float32".
        device: A Warp device.
    """
    from warpgran.solve.solver import Solver
    from warpgran.solve.start import solvers

    alone = Solver.holding([case], precision_name=precision, device=device)
    for running in solvers(alone, [case]):
        state, ended = running.state, False
        while not ended:
            t = float(state.t.numpy()[0])
            ended = running.replay(budget=1)
            found = None
            if int(alone.state.output.numpy()[0]) >= output:
                found = fault(np.stack([state.of_run(u, 0) for u in state.U]).astype(float))
            if ended and not found and state.status.numpy()[0] == Status.DIVERGED:
                found = -1, f"dt = {state.dt_exact.numpy()[0]:g} s"
            if found:
                cell, what = found
                grid = case.grid
                x = grid.left + (cell + 0.5) * (grid.right - grid.left) / state.cells[0] if cell >= 0 else float("nan")
                return Failure(t, int(state.steps.numpy()[0]), cell, x, what)
    raise AssertionError("a run that has diverged does so again")


def run_reference(cases: Sequence[Case], go_on: GoOn) -> Finished:
    """Compute cases by the NumPy reference, one after another."""
    return _joined([_run_one(case, go_on) for case in cases])


CALL_EVERY = 100  # steps of the reference between two calls of GoOn


def _run_one(case: Case, go_on: GoOn) -> Finished:
    outputs = Outputs.of(case)
    scalars = np.full((1, outputs.samples, len(SCALARS)), np.nan)
    profiles = tuple(np.full((1, outputs.snapshots, case.grid.cells), np.nan) for _ in range(3))
    run = reference(case)
    status, failure, speed = Status.OK, None, 0.0
    began = time.perf_counter()
    for k, (t, snapshot, sample) in enumerate(zip(outputs.times, outputs.snapshot_at, outputs.sample_at, strict=True)):
        before = copy(run)
        status = _advance(run, float(t), go_on)
        if status == Status.DIVERGED or (status == Status.OK and fault(run.U)):
            status, (failure, run) = Status.DIVERGED, _find_fault(before, float(t))
        if status != Status.OK:
            break
        values = run.scalars()
        rest = sample >= 0 and k > 0 and case.time.stop_at_rest
        rest = rest and values["v_flow"] < case.rest_speed and values["v_flow"] <= speed
        if sample >= 0:
            scalars[0, sample : None if rest else sample + 1] = [values[name] for name in SCALARS]
            speed = values["v_flow"]
        later = outputs.snapshot_at[k:] if rest else [snapshot]
        for place in (place for place in later if place >= 0):
            for target, field in zip(profiles, run.fields, strict=True):
                target[0, place] = field
        if rest:
            status = Status.AT_REST
            break
    seconds = time.perf_counter() - began
    each = np.array([status], dtype=np.int8), np.array([run.steps]), np.array([run.t]), np.array([run.cell_steps])
    return Finished(scalars, profiles, *each, {0: failure} if failure else {}, seconds)


def _advance(run: Run, t_out: float, go_on: GoOn) -> Status:
    """Advance a run to t_out [s]; how that ended."""
    while run.t < t_out:
        if run.steps >= run.case.time.step_limit:
            return Status.STEP_LIMIT
        with np.errstate(all="ignore"):  # the result is judged at the output time
            dt = run.step(t_out)
        if not dt > 0.0:
            return Status.DIVERGED
        if run.steps % CALL_EVERY == 0 and not go_on(run.t):
            return Status.INTERRUPTED
    return Status.OK


def _find_fault(run: Run, t_out: float) -> tuple[Failure, Run]:
    """Repeat the steps of a run that has diverged; where it does, and the run after the last sound one."""
    found = None
    before = run
    while not found:
        before = copy(run)
        with np.errstate(all="ignore"):
            dt = run.step(t_out)
        found = fault(run.U) if dt > 0.0 else (-1, f"dt = {dt:g} s")
    cell, what = found
    x = float(run.case.x[cell]) if cell >= 0 else float("nan")
    return Failure(before.t, run.steps, cell, x, what), before


def _joined(parts: Sequence[Finished]) -> Finished:
    cells = max(part.profiles[0].shape[2] for part in parts)

    def padded(field: Array) -> Array:
        return np.pad(field, ((0, 0), (0, 0), (0, cells - field.shape[2])), constant_values=np.nan)

    return Finished(
        np.concatenate([part.scalars for part in parts]),
        tuple(np.concatenate([padded(part.profiles[n]) for part in parts]) for n in range(3)),
        np.concatenate([part.status for part in parts]),
        np.concatenate([part.steps for part in parts]),
        np.concatenate([part.end_time for part in parts]),
        np.concatenate([part.cell_steps for part in parts]),
        {r: part.failures[0] for r, part in enumerate(parts) if part.failures},
        sum(part.seconds for part in parts),
    )
