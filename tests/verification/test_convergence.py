"""The study of resolution: that the bulk of a collapse converges."""

from __future__ import annotations

import numpy as np
import pytest

from warpgran.verification.check import CheckOptions
from warpgran.verification.convergence import COLLAPSES, convergence, refine


def test_the_bulk_of_a_collapse_converges() -> None:
    found = refine(COLLAPSES[1], CheckOptions(order=1), (125, 250, 500, 1000))
    heights = found[0.48, "maximum height"]
    fronts = found[0.48, "front at 5 mm"]
    for quantity, finest in ((heights, 0.0625), (fronts, 0.615)):  # of 8000 cells
        assert quantity.values[-1] == pytest.approx(finest, rel=0.02)
        assert np.abs(quantity.changes[-1]) < 0.6 * np.abs(quantity.changes).max()


def test_order_2_is_within_a_percent_on_500_cells() -> None:
    found = refine(COLLAPSES[1], CheckOptions(), (125, 250, 500))
    finest = {"front at 1.4 mm": 0.6902, "front at 5 mm": 0.6170, "maximum height": 0.06235}  # of 8000 cells
    for name, value in finest.items():
        assert found[0.48, name].values[-1] == pytest.approx(value, rel=0.01), name


@pytest.mark.parametrize("order", [1, 2])
def test_the_outcome_has_a_row_for_each_quantity_and_a_figure(order: int) -> None:
    outcome = convergence(CheckOptions(order=order), (60, 120, 240))
    assert len(outcome.rows) == 2 * 2 * 4
    assert outcome.holds  # nothing is asked without the grid of 2000 cells
    with_limit = [row for row in outcome.rows if "no limit" not in row.bound]
    assert with_limit and all([cells for cells, _ in row.errors] == [60, 120, 240] for row in with_limit)
    assert all(row.errors[-1][1] == row.error for row in with_limit)
    assert list(outcome.figures) == ["convergence"]
    assert len(outcome.figures["convergence"].axes) == 4
