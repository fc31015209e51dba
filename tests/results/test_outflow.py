"""The share of the solid that has left: 0 to rounding where nothing can leave, else what crosses the ends."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from helpers.cases import small

import warpgran as wg
from warpgran.case.case import Case
from warpgran.physics import first_order, second_order

SCHEMES = [{"scheme.order": 1}, {"scheme.order": 2, "scheme.start": 0}, {"scheme.order": 2, "scheme.start": 2}]
"""Either order, and a start on finer cells."""
ROUNDING = {"float64": 1e-13, "float32": 3e-6}
SAMPLED: dict[str, Any] = {"time.series": {"every": 0.02}}
CLOSED = {
    "walls": {"scheme.right": "wall", "grid.right": 0.1},
    "periodic": {"scheme.left": "periodic", "scheme.right": "periodic", "grid.right": 0.1},
    "far": {},
}
SHORT: dict[str, Any] = {"grid.right": 0.1, "grid.cells": 100}
"""A grid that a third of the mass leaves."""


def wedge(**changes: Any) -> Case:
    """A pile whose mass on finer cells is not that on its own: its crest lies between their centres."""
    profile = {"x": [-0.2, -0.0837, 0.05], "h": [0.0, 0.2, 0.0]}
    return small(**{"column.profile": profile, **SAMPLED, **changes})


@pytest.mark.parametrize("engine", ["warp", "numpy"])
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("ends", CLOSED)
def test_nothing_leaves_between_walls_around_a_period_or_on_a_long_grid(
    ends: str, scheme: dict[str, Any], engine: Any
) -> None:
    case = wedge(**CLOSED[ends], **scheme)
    for precision in ("float64", "float32") if engine == "warp" else ("float64",):
        outflow = wg.simulate(case, engine=engine, precision=precision)["outflow"]
        assert outflow.shape == (1, 11)
        assert abs(outflow).max() <= ROUNDING[precision]


@pytest.mark.parametrize("scheme", SCHEMES)
def test_what_leaves_is_what_crosses_the_ends(scheme: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    crossed = [0.0]
    module, stages = (first_order, 1) if scheme["scheme.order"] == 1 else (second_order, 2)
    flux_through, dt_of_update = module.interface_flux, first_order.update

    def counted(*arguments: Any) -> Any:
        flux = flux_through(*arguments)
        dt = arguments[2] if stages == 2 else 1.0  # of order 1 by the update that follows
        crossed.append((flux.F0[-1] - flux.F0[0]) * dt / stages)
        return flux

    def updated(U: np.ndarray, flux: Any, dt: float, case: Case) -> np.ndarray:
        crossed[-1] *= dt
        return dt_of_update(U, flux, dt, case)

    monkeypatch.setattr(module, "interface_flux", counted)
    monkeypatch.setattr(first_order, "update", updated)
    case = wedge(**SHORT, **scheme)
    outflow = wg.simulate(case, engine="numpy")["outflow"][0].values
    fine = case.refined(case.scheme.start_levels)
    h, phi = fine.initial_state()
    share = sum(crossed) / ((phi * h).sum() * fine.dx)
    assert 0.1 < share < 0.6
    assert outflow[-1] == pytest.approx(share, rel=1e-10)
    assert abs(outflow[0]) <= 1e-13
    assert (np.diff(outflow) >= -1e-13).all()
    for precision, rel in (("float64", 1e-9), ("float32", 1e-4)):
        kernels = wg.simulate(case, precision=precision)["outflow"][0]  # type: ignore[arg-type]
        np.testing.assert_allclose(kernels, outflow, rtol=rel, atol=rel * share)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_what_leaves_a_short_grid_is_what_passes_its_end_on_a_long_one(scheme: dict[str, Any]) -> None:
    steep: dict[str, Any] = {"slope.angle": 35.0, "time.end": 0.3, "time.snapshots": [0.3]}  # faster than waves return
    short = wg.simulate(wedge(**SHORT, **scheme, **steep))
    long = wg.simulate(wedge(**{"grid.right": 1.0, "grid.cells": 400}, **scheme, **steep)).isel(run=0, time=0)
    solid = long["phi"] * long["h"]
    beyond = float(solid[long["x"].values > 0.1].sum() / solid.sum())
    assert float(short["outflow"][0, -1]) == pytest.approx(beyond, rel=0.02)


def test_it_counts_from_the_start_also_where_the_series_begins_later() -> None:
    whole = wg.simulate(wedge(**SHORT))["outflow"]
    late = wg.simulate(wedge(**SHORT, **{"time.series": [0.2]}))["outflow"]
    assert float(late[0, 0]) == pytest.approx(float(whole[0, -1]), rel=1e-4)  # the steps are others
