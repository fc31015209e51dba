"""Runs that go wrong or stop early: found, named, kept from the others; both engines tell the same story."""

from __future__ import annotations

import numpy as np
import pytest
from helpers.cases import DIVERGING, EVERY_ENGINE, ON_ONE_GRID, ran, small

import warpgran as wg
from warpgran.schema import Status
from warpgran.solve.engines import run_kernels, run_reference
from warpgran.solve.finished import fault
from warpgran.solve.solver import Solver


@pytest.mark.parametrize("engine", EVERY_ENGINE)
def test_a_diverged_run_is_named_and_its_sound_part_kept(engine: str) -> None:
    done = ran(engine, small(**DIVERGING), [0.0, 0.1, 0.2])
    assert done.status == Status.DIVERGED
    assert done.failure is not None
    assert (done.failure.time, done.failure.step) == (done.end_time, done.steps + 1)
    assert 0.0 < done.end_time < 0.1
    assert done.failure.what.startswith("phi outside (0, 1]")
    assert done.failure.x == pytest.approx(small().x[done.failure.cell])
    assert str(done.failure).startswith("diverged after t = 0.00")
    assert np.isfinite(done.h[0]).all()
    assert np.isnan(done.h[1:]).all()
    assert np.isnan(done.scalars["front"][1:]).all()


def test_both_engines_find_the_same_fault(device: str) -> None:
    ours, theirs = (ran(engine, small(**DIVERGING), [0.1]).failure for engine in (device, "numpy"))
    assert ours is not None
    assert theirs is not None
    assert (ours.step, ours.cell) == (theirs.step, theirs.cell)
    assert ours.time == pytest.approx(theirs.time, rel=1e-12)


def test_a_diverged_run_leaves_the_others_alone(device: str) -> None:
    good, bad = small(), small(**DIVERGING)
    batch, alone = wg.simulate([good, bad, good], device=device), wg.simulate(good, device=device)
    assert list(batch["status"]) == [Status.OK, Status.DIVERGED, Status.OK]
    assert "phi outside (0, 1]" in str(batch["failure"][1].item())
    for r in (0, 2):
        for name in ("h", "v", "phi", "front"):
            np.testing.assert_array_equal(batch[name][r], alone[name][0])


@pytest.mark.parametrize(("cell", "value"), [(40, np.nan), (40, np.inf), (190, -1e-6)])  # in the flow; ahead of it
def test_a_spoiled_value_is_found_whatever_the_compiler_assumes(cell: int, value: float, device: str) -> None:
    solver = Solver.holding([small(), small()], device=device)
    assert not solver.replay(budget=30)
    U0 = solver.state.U[0].numpy()
    U0[solver.state.row(1) + cell] = value
    solver.state.U[0].assign(U0)
    assert solver.replay()
    assert list(solver.state.status.numpy()) == [Status.OK, Status.DIVERGED]
    assert solver.state.t.numpy()[0] == 0.2


def test_no_more_steps_once_told_to_stop(device: str) -> None:
    case = small(**ON_ONE_GRID)  # for the start: test_start.py
    solver = Solver.holding([case], device=device)
    solver.steps_per_replay = 50
    for done in (run_kernels(solver, [case], lambda t: False), run_reference([case], lambda t: False)):
        assert 0 < done.steps[0] <= 100
        assert 0.0 < done.end_time[0] < 0.2
        assert done.status[0] == Status.INTERRUPTED


@pytest.mark.parametrize("engine", EVERY_ENGINE)
def test_the_step_limit_ends_a_run(engine: str) -> None:
    done = ran(engine, small(**{"time.step_limit": 17}), [0.0, 0.2])
    assert (done.steps, done.status) == (17, Status.STEP_LIMIT)
    assert done.failure is None
    assert np.isfinite(done.h[0]).all()
    assert np.isnan(done.h[1]).all()


@pytest.mark.slow
@pytest.mark.parametrize("engine", EVERY_ENGINE)
def test_a_run_at_rest_may_end_and_repeats_its_last_state(engine: str) -> None:
    case = small(**{"slope.angle": 0.0})
    times = np.linspace(0.0, 1.5, 31)
    free, stopped = (ran(engine, case.with_(**{"time.stop_at_rest": stop}), times.tolist()) for stop in (False, True))
    assert (free.status, stopped.status) == (Status.OK, Status.AT_REST)
    k = int(np.flatnonzero(times == stopped.end_time)[0])
    assert 0.3 < stopped.end_time < 1.0
    assert stopped.steps < free.steps
    assert stopped.scalars["v_flow"][k] < 1e-3
    for name, values in stopped.scalars.items():
        np.testing.assert_array_equal(values[: k + 1], free.scalars[name][: k + 1])
        assert (values[k:] == values[k]).all()
    np.testing.assert_array_equal(stopped.h[: k + 1], free.h[: k + 1])
    assert (stopped.h[k:] == stopped.h[k]).all()
    assert np.abs(stopped.h[-1] - free.h[-1]).max() < 5e-4  # it was at rest


@pytest.mark.parametrize("engine", EVERY_ENGINE)
def test_a_slow_start_is_no_rest(engine: str) -> None:
    case = small(**{"time.stop_at_rest": True, "time.rest_speed": 1.2})
    done = ran(engine, case, [0.0, 0.001, 0.002, 0.1])
    assert done.scalars["v_flow"][1] < done.scalars["v_flow"][2] < 1.2
    assert done.status == Status.OK


@pytest.mark.parametrize(
    ("U", "words"),
    [
        ([0.1, 0.0, 0.06], None),
        ([0.0, 0.0, 0.0], None),
        ([-1e-15, 0.0, 0.0], None),  # rounding of a dry cell
        ([0.1, 0.0, 0.1], None),  # phi = 1
        ([-1e-9, 0.0, 0.0], "negative mass"),
        ([0.1, 0.0, 0.11], "phi outside"),
        ([0.1, 0.0, 0.0], "phi outside"),
        ([0.1, np.inf, 0.06], "not finite"),
        ([np.nan, 0.0, 0.06], "not finite"),
    ],
)
def test_what_is_sound(U: list[float], words: str | None) -> None:
    state = np.array([[0.1, 0.0, 0.06], U]).T
    found = fault(state)
    if words is None:
        assert found is None
    else:
        assert found is not None
        assert found[0] == 1
        assert words in found[1]
