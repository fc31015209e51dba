"""Columns of any aspect ratio: the laws, the band, and that it tells grains from what is none."""

from __future__ import annotations

import numpy as np
import pytest

from warpgran.verification import columns
from warpgran.verification.check import CheckOptions
from warpgran.verification.columns import STEEP, Deposits, band, collapse, column, lajeunesse, lube

COARSE = 50  # cells a column length
RATIOS = (0.3, 0.55, 1.0, 2.0)


@pytest.fixture(scope="module")
def beads() -> Deposits:
    return collapse(column(1, COARSE), RATIOS)


def test_the_laws_of_the_experiments() -> None:
    a = np.array([0.5, 1.0, 8.0])
    np.testing.assert_allclose(lube(a), [0.6, 1.2, 7.6])
    np.testing.assert_allclose(lajeunesse(a), [0.9, 1.8, 9.2])
    low, high = band(a)
    assert (low < lube(a)).all()
    assert (lajeunesse(a) < high).all()


def test_shallow_columns_run_out_as_in_experiments(beads: Deposits) -> None:
    low, high = band(beads.a)
    shallow = beads.a <= 1.0
    assert ((low <= beads.run_out) & (beads.run_out <= high))[shallow].all()
    assert (np.diff(beads.run_out) > 0.0).all()
    np.testing.assert_allclose(beads.height[:2], beads.a[:2], rtol=0.02)  # the summit is not reached
    assert beads.height[2] < 0.95 < beads.height[3]


def test_too_much_friction_falls_out_of_the_band(beads: Deposits) -> None:
    steep = collapse(column(1, COARSE, **STEEP), RATIOS)
    assert (steep.run_out < band(steep.a)[0])[steep.a <= 1.0].all()
    assert all(row.holds is not False for row in columns._rows(beads, steep))
    held = [row.holds for row in columns._rows(steep, beads)]
    assert held[0] is False  # such grains would be noticed
    assert held[2] is False


def test_columns_that_do_not_come_to_rest_are_named() -> None:
    short = column(2, COARSE, **{"time.end": 0.1, "time.snapshots": [0.1]})
    with pytest.raises(RuntimeError, match=r"^columns of aspect ratio 1 did not come to rest"):
        collapse(short, [1.0])


@pytest.mark.parametrize("order", [1, 2])
def test_the_outcome(order: int) -> None:
    outcome = columns.columns(CheckOptions(order=order), 25, (0.4, 0.8, 1.2, 1.6))
    assert outcome.holds
    assert len(outcome.rows) == 6
    assert len(outcome.figures["columns"].axes) == 2
