"""The start on finer cells: kernels against the reference, what must not change a bit, how runs end within it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from helpers.cases import EVERY_ENGINE, VIOLENT, assert_same_bits, ran, small
from helpers.second_order import OPEN, PERIODIC, WALLS

import warpgran as wg
from warpgran.case.case import Case
from warpgran.case.study import Study
from warpgran.physics.reference import reference
from warpgran.schema import Status
from warpgran.solve.blocks import plan
from warpgran.solve.engines import run_kernels, run_reference
from warpgran.solve.schedule import Outputs
from warpgran.solve.solver import Solver
from warpgran.solve.state import bytes_of_run, bytes_of_start, padded_cells
from warpgran.solve.variant import variant_of

X = np.linspace(0.0, 0.4, 41)
PROFILE = {"column.profile": {"x": X, "h": 0.1 - 0.2 * X, "v": 2.0 * X - 0.1}}
BED = {"slope.bed": {"x": np.linspace(-1.0, 2.0, 61), "b": 0.01 * np.sin(np.arange(61.0))}}
MANY = np.linspace(0.0, 0.12, 61).tolist()  # a level of 200 cells lasts 0.05 s or less

CASES: list[Any] = [
    pytest.param({"scheme.start": 1}, id="1"),
    pytest.param({"scheme.start": 2, "slope.angle": 0.0, **BED}, id="2, bed"),
    pytest.param({"scheme.start": 3, "grid.cells": 77, "rheology.K": 0.0}, id="3, K = 0"),
    pytest.param({"scheme.start": 2, **PROFILE}, id="2, profile with v"),
    pytest.param({"scheme.start": 2, "rheology.phi_eq": "f1", "scheme.h_bed": 1e-4, **BED}, id="2, f1, layer"),
    pytest.param({"scheme.start": 2, **OPEN, "column.start": 0.1, "slope.angle": -30.0}, id="2, open"),
    pytest.param({"scheme.start": 1, **PERIODIC, **BED}, id="1, periodic"),
    pytest.param({"scheme.start": 2, "scheme.alpha": 1.7, "scheme.window": False}, id="2, alpha = 1.7"),
]  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("changes", CASES)
def test_kernels_agree_with_the_reference_at_all_times(changes: dict[str, Any], device: str) -> None:
    case = small(**changes)
    ours, theirs = (ran(engine, case, MANY) for engine in (device, "numpy"))
    assert ours.steps == theirs.steps
    for name, scale in (("h", 0.1), ("v", 1.0), ("phi", 1.0)):
        assert np.abs(getattr(ours, name) - getattr(theirs, name)).max() <= 1e-10 * scale, name
    for name, values in theirs.scalars.items():
        np.testing.assert_allclose(ours.scalars[name], values, rtol=1e-10, atol=1e-12, err_msg=name)


def test_a_start_changes_the_result() -> None:
    with_it, without = (ran("kernels", small(**{"scheme.start": levels}), [0.0, 0.1]) for levels in (2, 0))
    assert with_it.steps > without.steps
    assert 1e-4 < np.abs(with_it.h[1] - without.h[1]).max()


def kept(
    cases: Sequence[Case], device: str, precision: str = "float64", capacity: int | None = None
) -> list[list[Any]]:
    """Profiles, scalars, steps, end time and cell-steps of each run."""
    padded = padded_cells(max(case.grid.cells for case in cases))
    variant = variant_of(cases[0], precision)
    solver = Solver(capacity or len(cases), padded, variant, Outputs.of(cases[0]), device)
    done = run_kernels(solver, cases, lambda t: True)
    fields = [[field[r, :, : case.grid.cells] for field in done.profiles] for r, case in enumerate(cases)]
    ends = zip(fields, done.scalars, done.steps, done.end_time, done.cell_steps, strict=True)
    return [[*profiles, *rest] for profiles, *rest in ends]


MIXED: list[dict[str, Any]] = [
    {},
    {"grid.cells": 77, "slope.angle": -5.0},
    {"column.start": 0.1, "column.length": 0.1, "scheme.left": "open", "scheme.start": 0},
    {"column.start": 0.2, "column.length": 0.05, "slope.angle": -50.0, "scheme.left": "open", "column.phi": 0.5},
    {"slope.angle": 0.0, "column.phi": 0.55, "grid.cells": 401, "scheme.right": "wall", "scheme.start": 1},
    {"scheme.h_bed": 1e-4, "rheology.K": 1.0},
    {"slope.angle": 0.0, "column.height": 0.02, "time.stop_at_rest": True},
]
OFTEN: dict[str, Any] = {"time.series": {"every": 0.004}, "time.end": 0.1, "time.snapshots": [0.0, 0.01, 0.1]}


@pytest.mark.parametrize("precision", ["float64", "float32"])
def test_a_batch_gives_the_bits_of_single_runs(precision: str, device: str) -> None:
    cases = [small(**{**OFTEN, **changes}) for changes in MIXED]
    singles = [kept([case], device, precision)[0] for case in cases]
    for capacity in (len(cases), 20):  # one run and several that start at a time
        assert_same_bits(kept(cases, device, precision, capacity), singles)


@pytest.mark.parametrize("changes", MIXED)
def test_the_window_changes_no_bit(changes: dict[str, Any], device: str) -> None:
    case = small(**{"grid.cells": 300, **OFTEN, **changes})
    full = case.with_(**{"scheme.window": False})
    assert_same_bits(kept([case], device), kept([full], device))


def test_a_solver_loaded_again_remembers_nothing(device: str) -> None:
    case, other = small(**OFTEN), small(**{**OFTEN, "slope.angle": 40.0, "scheme.h_bed": 1e-3})
    solver = Solver.holding([other] * 5, device=device)
    for cases in ([other] * 5, [case]):
        done = run_kernels(solver, cases, lambda t: True)
    alone = run_kernels(Solver.holding([case], device=device), [case], lambda t: True)
    np.testing.assert_array_equal(done.scalars, alone.scalars)
    assert (done.steps[0], done.cell_steps[0]) == (alone.steps[0], alone.cell_steps[0])


def test_replays_of_any_length_give_the_same_bits(device: str, monkeypatch: pytest.MonkeyPatch) -> None:
    case = small(**OFTEN)
    whole = kept([case], device)
    replay = Solver.replay
    monkeypatch.setattr(Solver, "replay", lambda self, budget=None: replay(self, 7))
    assert_same_bits(kept([case], device), whole)


def test_threads_and_blocks_change_no_bit() -> None:
    study = [small(**{**OFTEN, "column.phi": phi}) for phi in np.linspace(0.56, 0.62, 5)]
    one, two = (wg.simulate(study, threads=threads) for threads in (1, 2))
    for name in ("h", "v", "phi", "front", "steps"):
        np.testing.assert_array_equal(one[name], two[name])
    assert one.attrs["cell_steps"] == two.attrs["cell_steps"]


@pytest.mark.parametrize("precision", ["float64", "float32"])
@pytest.mark.parametrize("engine", EVERY_ENGINE)
def test_what_friction_holds_stays_to_the_bit(engine: str, precision: str) -> None:
    x = np.linspace(0.0, 1.0, 101)
    slope = {"column.profile": {"x": x, "h": 0.05 + 0.1 * x, "phi": 0.6 - 0.1 * x}, "slope.angle": 3.0}
    case = small(**{**slope, **WALLS, "grid.left": 0.0, "grid.right": 1.0})
    done = ran(engine, case, [0.0, 0.002, 0.1], "float64" if engine == "numpy" else precision)
    for field in (done.h, done.phi):
        np.testing.assert_array_equal(field[1:], field[:1].repeat(2, axis=0))
    assert (done.v == 0.0).all() and done.end_time == 0.1


@pytest.mark.parametrize("engine", EVERY_ENGINE)
def test_no_mass_is_lost(engine: str) -> None:
    mass = ran(engine, small(), MANY).scalars["mass"]
    np.testing.assert_allclose(mass, mass[0], rtol=1e-13)


@pytest.mark.parametrize("engine", EVERY_ENGINE)
def test_cell_steps_are_those_of_each_level(engine: str) -> None:
    case = small(**{"time.end": 1e-3, "time.snapshots": [1e-3], "time.series": []})  # within the finest level
    if engine == "numpy":
        done = run_reference([case], lambda t: True)
    else:
        done = run_kernels(
            Solver.holding([case], device="cpu" if engine == "kernels" else engine), [case], lambda t: True
        )
    assert done.cell_steps[0] == done.steps[0] * 4 * case.grid.cells
    both = [
        run_reference([small()], lambda t: True),
        run_kernels(Solver.holding([small()]), [small()], lambda t: True),
    ]
    assert both[0].cell_steps[0] == both[1].cell_steps[0] > both[0].steps[0] * case.grid.cells


@pytest.mark.parametrize("limit", [1, 5, 40, 60, 61])
@pytest.mark.parametrize("engine", EVERY_ENGINE)
def test_the_step_limit_counts_the_steps_of_all_levels(limit: int, engine: str) -> None:
    done = ran(engine, small(**{"time.step_limit": limit}), [0.0, 0.001, 0.2])
    assert (done.steps, done.status) == (limit, Status.STEP_LIMIT)
    assert np.isfinite(done.h[0]).all() and np.isnan(done.h[2]).all()
    assert 0.0 < done.end_time < 0.2


def test_a_limit_at_the_end_of_a_level_is_that_of_the_reference(device: str) -> None:
    run = reference(small())
    ends: list[int] = []
    while len(ends) < 2:
        cells = run.case.grid.cells
        run.step()
        if run.case.grid.cells < cells:
            ends.append(run.steps)
    for limit in (ends[0], ends[0] + 1, ends[1]):
        case = small(**{"time.step_limit": limit})
        ours, theirs = (ran(engine, case, [0.0, 0.2]) for engine in (device, "numpy"))
        assert ours.steps == theirs.steps == limit
        assert ours.status == theirs.status == Status.STEP_LIMIT
        assert ours.end_time == pytest.approx(theirs.end_time, rel=1e-12)


def test_no_more_steps_once_told_to_stop(device: str) -> None:
    cases = [small()] * 3
    solver = Solver.holding(cases, device=device)
    solver.finer(2, 1).steps_per_replay = 7
    done = run_kernels(solver, cases, lambda t: False)
    assert (done.status == Status.INTERRUPTED).all()
    assert done.steps.tolist() == [7, 0, 0]
    assert 0.0 < done.end_time[0] < 0.01 and (done.end_time[1:] == 0.0).all()


def test_rest_within_the_start_is_that_of_the_reference(device: str) -> None:
    case = small(**{"time.stop_at_rest": True, "slope.angle": 0.0, "column.length": 0.8, **WALLS})
    times = [0.0, 0.002, 0.01, 0.1]
    ours, theirs = (ran(engine, case, times) for engine in (device, "numpy"))
    assert ours.status == theirs.status == Status.AT_REST
    assert ours.end_time == theirs.end_time == 0.002
    assert ours.steps == theirs.steps
    np.testing.assert_allclose(ours.h, theirs.h, rtol=1e-12)
    np.testing.assert_array_equal(ours.h[3], ours.h[1])


def test_memory_of_a_block_holds_the_start() -> None:
    case = small(**{"grid.cells": 1000})
    outputs, variant = Outputs.of(case), variant_of(case, "float64")
    size, start = bytes_of_run(1023, outputs, variant), bytes_of_start(1023, 2, variant)
    assert start > 5 * bytes_of_run(1023, Outputs.none(), variant)

    def sizes(memory: float) -> list[int]:
        blocks = plan(Study.of([case] * 9), range(9), outputs, "float64", on_cpu=False, threads=1, memory=memory)
        assert blocks[0].padded == 1024
        return [len(block.runs) for block in blocks]

    assert sizes(9 * size + 3 * start) == [9]
    assert max(sizes(8 * size + 2 * start)) == 5  # two blocks, of 8 at the most
    assert max(sizes(3 * size + start)) == 3
    assert max(sizes(size + start)) == 1
    with pytest.raises(MemoryError, match="with its start on 4 times as many"):
        sizes(size + 0.9 * start)


def test_runs_with_other_starts_are_in_other_blocks() -> None:
    cases = [small(**{"scheme.start": levels}) for levels in (0, 2, 0, 2, 1)]
    blocks = plan(Study.of(cases), range(5), Outputs.of(cases[0]), "float64", on_cpu=True, threads=1, memory=1e12)
    assert sorted(block.runs for block in blocks) == [(0, 2), (1, 3), (4,)]


@pytest.mark.parametrize("times", [[0.1], [0.001, 0.1]])
def test_a_run_that_diverges_in_the_start_is_named_by_its_finer_cell(times: list[float], device: str) -> None:
    ours, theirs = (ran(engine, small(**VIOLENT), times) for engine in (device, "numpy"))
    assert ours.status == theirs.status == Status.DIVERGED
    assert (ours.steps, ours.end_time) == (theirs.steps, theirs.end_time)
    assert ours.failure is not None and theirs.failure is not None
    assert (ours.failure.step, ours.failure.cell) == (theirs.failure.step, theirs.failure.cell)
    assert ours.failure.x == pytest.approx(theirs.failure.x)


def test_a_diverged_run_leaves_the_others_alone(device: str) -> None:
    good, bad = small(**OFTEN), small(**{**OFTEN, **VIOLENT})
    batch, alone = wg.simulate([good, bad, good], device=device, threads=1), wg.simulate(good, device=device)
    assert list(batch["status"]) == [Status.OK, Status.DIVERGED, Status.OK]
    for r in (0, 2):
        np.testing.assert_array_equal(batch["front"][r], alone["front"][0])
