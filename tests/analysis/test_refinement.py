"""Observed orders and limits of known sequences."""

from __future__ import annotations

import numpy as np
import pytest

from warpgran.analysis.refinement import Refined

CELLS = (100, 200, 400, 800)


def refined(*values: float) -> Refined:
    return Refined("q", CELLS[-len(values) :], values)


@pytest.mark.parametrize("order", [0.5, 1.0, 1.5])
def test_a_power_of_the_cell_size_is_extrapolated_exactly(order: float) -> None:
    found = refined(*(3.0 - 20.0 * n**-order for n in CELLS))
    assert found.order == pytest.approx(order, rel=1e-9)
    assert found.limit == pytest.approx(3.0, rel=1e-9)
    np.testing.assert_allclose(found.errors, [20.0 / 3.0 * n**-order for n in CELLS], rtol=1e-6)


def test_cells_for_one_percent() -> None:
    assert refined(*(1.0 + 3.0 / n for n in CELLS)).enough() == 400  # 3 %, 1.5 %, 0.75 %, 0.375 %
    assert refined(*(1.0 + 0.9 / n for n in CELLS)).enough() == 100
    assert refined(*(1.0 + 9.0 / n for n in CELLS)).enough() is None
    assert refined(1.0, 1.02, 1.0, 1.0).enough() == 400  # good by chance on the coarsest


NO_LIMIT = [
    (1.0, 1.1, 1.2, 1.3),
    (1.0, 1.1, 1.0, 1.1),
    (1.0, 1.1, 1.3, 1.7),
    (1.0, 1.5, 1.9, 1.95),  # falls like an order of 3, by chance
    (1.0, 1.1, 1.185, 1.25),  # of an order of 0.4
]


@pytest.mark.parametrize("values", NO_LIMIT)
def test_what_shows_no_limit_is_given_none(values: tuple[float, ...]) -> None:
    found = refined(*values)
    assert np.isnan(found.order)
    assert np.isnan(found.limit)
    assert found.enough() is None


def test_what_has_settled_needs_no_order() -> None:
    assert refined(1.0, 1.2, 1.0, 1.0005).limit == 1.0005


def test_cells_beyond_the_finest_grid_are_extrapolated() -> None:
    assert refined(*(1.0 + 9.0 / n for n in CELLS)).needed() == 900
    assert refined(*(1.0 + 400.0 / n**2 for n in CELLS)).needed() == 200
    assert refined(1.0, 1.1, 1.2, 1.3).needed() is None


def test_a_volume_change_is_measured_against_the_volume() -> None:
    change = Refined("change", CELLS, tuple(0.04 + 2.0 / n for n in CELLS), offset=1.0)
    np.testing.assert_allclose(change.errors, [2.0 / 1.04 / n for n in CELLS], rtol=1e-6)
    assert Refined("none", CELLS, (0.0,) * 4, offset=1.0).errors.max() == 0.0
