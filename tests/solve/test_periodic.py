"""Periodic ends: the first and the last interface are one, so that no place on the grid is special."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from helpers.cases import ENGINES, FIRST, Ran, at_centres, ran
from helpers.second_order import CELLS, PERIODIC

import warpgran as wg
from warpgran.case.case import Case, CaseError
from warpgran.schema import Status

SCHEMES = pytest.mark.parametrize("scheme", [FIRST, {}], ids=["order 1", "order 2"])
WAYS = [("kernels", "float64"), ("kernels", "float32"), pytest.param("numpy", "float64", marks=pytest.mark.slow)]
BED = 0.002 * np.random.default_rng(3).standard_normal(CELLS)


def hill(shift: int = 0, bed: bool = False, /, **changes: Any) -> Case:
    """A pile beside dry cells, with phi that varies, as it is or moved along by a number of cells."""
    x = (np.arange(CELLS) + 0.5) / CELLS
    h = np.maximum(0.1 - 0.5 * np.abs(x - 0.4), 0.0)
    phi = 0.58 + 0.04 * np.sin(2 * np.pi * x)
    moved = [np.roll(a, shift) for a in (h, phi, BED)]
    return at_centres(moved[0], moved[1], moved[2] if bed else None, **{"slope.angle": 25.0, **PERIODIC, **changes})


def fields(done: Ran) -> np.ndarray:
    return np.stack((done.h, done.v, done.phi))


@SCHEMES
@pytest.mark.parametrize(("engine", "precision"), WAYS)
@pytest.mark.parametrize(("angle", "bed"), [(0.0, False), (25.0, False), (0.0, True), (25.0, True)])
def test_a_moved_state_gives_the_moved_result_to_the_bit(
    angle: float, bed: bool, engine: str, precision: str, scheme: dict[str, Any]
) -> None:
    here, *moved = (
        ran(engine, hill(shift, bed, **{"slope.angle": angle, **scheme}), [0.0, 0.1, 0.6], precision)
        for shift in (0, 37, -60)
    )
    assert np.abs(here.h[2] - here.h[0]).max() > 0.004
    for shift, there in zip((37, -60), moved, strict=True):
        assert here.steps == there.steps
        np.testing.assert_array_equal(np.roll(fields(here), shift, axis=-1), fields(there))
        np.testing.assert_array_equal(np.roll(here.U, shift, axis=-1), there.U)


@SCHEMES
@pytest.mark.parametrize("bed", [False, True])
def test_no_mass_is_lost_on_the_way_around(bed: bool, scheme: dict[str, Any]) -> None:
    done = ran("kernels", hill(0, bed, **{"slope.angle": 35.0, **scheme}), [0.0, 2.0])
    before, after = done.scalars["mass"]
    assert after == pytest.approx(before, rel=1e-13)
    assert done.v[1].max() > 1.2  # past the end and around: 2 s at this speed are more than the grid is long


@SCHEMES
@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("angle", [35.0, -35.0])
def test_a_uniform_layer_stays_uniform_to_the_bit(engine: str, angle: float, scheme: dict[str, Any]) -> None:
    layer = at_centres(np.full(CELLS, 0.05), 0.6, **{"slope.angle": angle, **PERIODIC, **scheme})
    done = ran(engine, layer, [0.5])
    assert done.v[0, 0] * np.sign(angle) > 0.4
    for field in fields(done):
        assert np.unique(field).size == 1


def test_the_bed_jumps_between_the_ends() -> None:
    case = hill(0, True, **{"slope.angle": 10.0})
    jump = BED[0] - BED[-1] - np.tan(np.radians(10.0)) / CELLS
    np.testing.assert_allclose(case.dbhat[[0, -1]], jump, rtol=1e-14)
    np.testing.assert_allclose(case.dbhat[1:-1], np.diff(case.bhat), atol=1e-15)


@pytest.mark.parametrize("precision", ["float64", "float32"])
def test_a_batch_of_any_ends_gives_the_bits_of_single_runs(precision: str) -> None:
    walls = {"scheme.left": "wall", "scheme.right": "wall"}
    cases = [hill(), hill(**walls), hill(60), hill(**{"grid.cells": 77}), hill(5, True, **{"grid.cells": 31})]
    cases = [case.with_(**{"time.end": 0.8, "time.snapshots": [0.8]}) for case in cases]
    batch = wg.simulate(cases, precision=precision, threads=2)  # type: ignore[arg-type]
    assert (batch["status"] == Status.OK).all()
    for r, case in enumerate(cases):
        alone = wg.simulate(case, precision=precision, threads=1)  # type: ignore[arg-type]
        for name in ("h", "v", "phi", "mass"):
            expected = alone[name].values[0]
            np.testing.assert_array_equal(batch[name].values[r][..., : expected.shape[-1]], expected)
    assert np.abs(batch["h"][1] - batch["h"][0]).max() > 1e-3  # walls are not that


@pytest.mark.parametrize(("key", "other", "value"), [("left", "right", "open"), ("right", "left", "wall")])
def test_one_periodic_end_is_refused(key: str, other: str, value: str) -> None:
    with pytest.raises(CaseError) as caught:
        Case().with_(**{f"scheme.{key}": "periodic"})
    assert str(caught.value) == (
        f'scheme.{key}: "periodic" needs both ends to be periodic, and scheme.{other} is "{value}"'
    )


def test_a_sweep_from_walls_to_periodic_ends() -> None:
    ends = ["wall", "periodic"]
    study = hill(**{"time.end": 0.8, "time.snapshots": [0.8]}).sweep(
        {"scheme.left": ends, "scheme.right": ends}, mode="zip"
    )
    data = wg.simulate(study)
    for r, case in enumerate(study):
        np.testing.assert_array_equal(data["h"][r], wg.simulate(case)["h"][0])
    assert (data["h"][0] != data["h"][1]).any()
