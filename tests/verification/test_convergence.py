"""The study of resolution: what it makes of known sequences, and that the bulk of a collapse converges."""

from __future__ import annotations

import numpy as np
import pytest

from warpgran.verification.convergence import COLLAPSES, Series, convergence, height_falls_through, refine

CELLS = (100, 200, 400, 800)


def series(*values: float) -> Series:
    return Series("q", CELLS[-len(values) :], values)


@pytest.mark.parametrize("order", [0.5, 1.0, 1.5])
def test_a_power_of_the_cell_size_is_extrapolated_exactly(order: float) -> None:
    found = series(*(3.0 - 20.0 * n**-order for n in CELLS))
    assert found.order == pytest.approx(order, rel=1e-9)
    assert found.limit == pytest.approx(3.0, rel=1e-9)
    np.testing.assert_allclose(found.errors, [20.0 / 3.0 * n**-order for n in CELLS], rtol=1e-6)


def test_cells_for_one_percent() -> None:
    assert series(*(1.0 + 3.0 / n for n in CELLS)).enough == 400  # 3 %, 1.5 %, 0.75 %, 0.375 %
    assert series(*(1.0 + 0.9 / n for n in CELLS)).enough == 100
    assert series(*(1.0 + 9.0 / n for n in CELLS)).enough is None
    assert series(1.0, 1.02, 1.0, 1.0).enough == 400  # good by chance on the coarsest


@pytest.mark.parametrize("values", [(1.0, 1.1, 1.2, 1.3), (1.0, 1.1, 1.0, 1.1), (1.0, 1.1, 1.3, 1.7)])
def test_what_shows_no_limit_is_given_none(values: tuple[float, ...]) -> None:
    found = series(*values)
    assert np.isnan(found.order)
    assert np.isnan(found.limit)
    assert found.enough is None


def test_what_has_settled_needs_no_order() -> None:
    assert series(1.0, 1.2, 1.0, 1.0005).limit == 1.0005


def test_the_front_at_a_height_is_linear_between_centres() -> None:
    x = np.array([0.5, 1.5, 2.5, 3.5])
    assert height_falls_through(0.25, x, np.array([1.0, 0.5, 0.0, 0.0])) == 2.0


def test_the_bulk_of_a_collapse_converges() -> None:
    found = refine(COLLAPSES[1], (125, 250, 500, 1000))
    heights = found[0.48, "maximum height"]
    fronts = found[0.48, "front at h = 10 mm"]
    for quantity, finest in ((heights, 0.0625), (fronts, 0.578)):  # of 8000 cells
        assert quantity.values[-1] == pytest.approx(finest, rel=0.02)
        assert np.abs(quantity.changes[-1]) < 0.6 * np.abs(quantity.changes).max()
    film = np.array(found[0.48, "front at h = 1 mm"].values)
    assert (np.diff(film)[1:] > 0.02).all()  # m: it goes on and on


def test_the_outcome_has_a_row_for_each_quantity_and_a_figure() -> None:
    outcome = convergence((60, 120, 240))
    assert len(outcome.rows) == 2 * 2 * 4
    assert outcome.holds  # nothing is asked without the grid of 2000 cells
    assert list(outcome.figures) == ["convergence"]
    assert len(outcome.figures["convergence"].axes) == 4
