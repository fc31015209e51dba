"""About how many steps a case takes, compared with those that it took."""

from __future__ import annotations

from typing import Any

import pytest
from helpers.cases import small
from helpers.places import RUNS

import warpgran as wg
from warpgran.case.case import Case
from warpgran.solve.expected_steps import expected_steps

LONG: dict[str, Any] = {"grid.cells": 400, "time.end": 0.8, "time.snapshots": [0.8]}


@pytest.mark.parametrize("levels", range(4))
def test_it_is_about_what_a_run_takes(levels: int) -> None:
    case = Case.from_toml(RUNS / "dense_16deg.toml")
    case = case.with_(**{"grid.cells": case.grid.cells // 4, "scheme.start": levels})
    data, expected = wg.simulate(case), expected_steps(case)
    assert expected.steps == pytest.approx(int(data["steps"][0]), rel=0.2)
    assert expected.cell_steps == pytest.approx(int(data.attrs["cell_steps"]), rel=0.3)


def test_each_level_of_the_start_adds_its_steps_and_cells() -> None:
    none, one, two = (expected_steps(small(**LONG, **{"scheme.start": levels})) for levels in (0, 1, 2))
    # The finest level lasts 20 of its cells, a coarser one 20 of its own less 10 that are past: at 0.45 cells a step.
    assert none.cell_steps == 400 * none.steps
    assert one.steps - none.steps == pytest.approx(10 / 0.45, abs=2)
    assert two.steps - none.steps == pytest.approx(20 / 0.45, abs=3)
    assert one.cell_steps - none.cell_steps == pytest.approx(400 * (2 * 20 - 10) / 0.45, rel=0.05)
    assert two.cell_steps - one.cell_steps == pytest.approx(400 * (4 * 20 - 2 * 10) / 0.45, rel=0.05)


def test_a_run_may_end_within_the_start() -> None:
    case = small(**{"time.end": 1e-3, "time.snapshots": [1e-3]})
    expected = expected_steps(case)
    assert 0 < expected.steps < 45  # of the finest level
    assert expected.cell_steps == 800 * expected.steps
