"""Runs that go wrong: found, named, kept from the others; and engines that tell the same story."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from cases import engines, small, state_of

from warpgran.engines import NumPyEngine, WarpEngine, fault
from warpgran.schema import Status

# On a dry bed the paper's viscosity makes solid fraction out of nothing: phi passes 1 within a few steps.
DIVERGING: dict[str, Any] = {"scheme.viscosity": "paper", "rheology.K": 0.0}


@pytest.mark.parametrize("engine", engines())
def test_a_diverged_run_is_named_and_taken_back(engine: Any) -> None:
    run = engine([small(**DIVERGING)])
    run.advance(0.1, lambda: True)
    (failure,) = run.failures
    assert run.status[0] == Status.DIVERGED
    assert (failure.run, failure.time, failure.step) == (0, run.t[0], run.steps[0] + 1)
    assert 0.0 < run.t[0] < 0.1
    assert "phi outside (0, 1]" in failure.what
    assert failure.x == pytest.approx(small().x[failure.cell])
    assert str(failure).startswith("run 0 diverged after t = 0.00")
    assert fault(state_of(run)) is None  # what is left is sound
    t = run.t[0]
    run.advance(0.2, lambda: True)
    assert run.t[0] == t
    assert len(run.failures) == 1


def test_both_engines_find_the_same_fault() -> None:
    found = []
    for engine in (WarpEngine, NumPyEngine):
        run = engine([small(**DIVERGING)])
        run.advance(0.1, lambda: True)
        found.append(run.failures[0])
    ours, theirs = found
    assert (ours.step, ours.cell) == (theirs.step, theirs.cell)
    assert ours.time == pytest.approx(theirs.time, rel=1e-12)


def test_a_diverged_run_leaves_the_others_alone() -> None:
    good, bad = small(), small(**DIVERGING)
    batch, alone = WarpEngine([good, bad, good]), WarpEngine([good])
    for run in (batch, alone):
        run.advance(0.1, lambda: True)
        run.advance(0.2, lambda: True)
    assert list(batch.status) == [Status.OK, Status.DIVERGED, Status.OK]
    assert [failure.run for failure in batch.failures] == [1]
    for r in (0, 2):
        for ours, theirs in zip(batch.profiles(), alone.profiles(), strict=True):
            np.testing.assert_array_equal(ours[r], theirs[0])


@pytest.mark.parametrize(("cell", "value"), [(40, np.nan), (40, np.inf), (190, -1e-6)])  # in the flow; ahead of it
def test_a_spoiled_value_is_found_whatever_the_compiler_assumes(cell: int, value: float) -> None:
    run = WarpEngine([small(), small()])
    (_, solver), *_ = run._solvers
    run.advance(0.1, lambda: True)
    U0 = solver.state.U[0].numpy()
    U0[solver.state.rows[1] + cell] = value
    solver.state.U[0].assign(U0)
    solver.save()
    run.advance(0.2, lambda: True)
    assert list(run.status) == [Status.OK, Status.DIVERGED]
    assert run.t[0] == 0.2


@pytest.mark.parametrize("engine", engines())
def test_no_more_steps_once_told_to_stop(engine: Any) -> None:
    run = engine([small()])
    if isinstance(run, WarpEngine):
        run._solvers[0][1].steps_per_replay = 50
    run.advance(0.2, lambda: False)
    assert 0 < run.steps[0] <= 100
    assert 0.0 < run.t[0] < 0.2
    assert run.status[0] == Status.OK


@pytest.mark.parametrize("engine", engines())
def test_the_step_limit_ends_a_run(engine: Any) -> None:
    run = engine([small(**{"time.step_limit": 17})])
    run.advance(0.2, lambda: True)
    assert (run.steps[0], run.status[0]) == (17, Status.STEP_LIMIT)
    assert not run.failures


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
