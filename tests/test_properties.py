"""What holds of any collapse: drawn over the parameters by hypothesis, computed by the kernels in both precisions."""

from __future__ import annotations

import numpy as np
from cases import small
from hypothesis import given, settings
from hypothesis import strategies as st

import warpgran as wg
from warpgran.case import Case
from warpgran.schema import Status


@st.composite
def collapses(draw: st.DrawFn) -> Case:
    """A column between two walls, on any slope and of any grains that the model is meant for."""

    def between(low: float, high: float) -> float:
        return draw(st.floats(low, high, allow_subnormal=False))

    mu1 = between(0.1, 0.7)
    return small(
        **{
            "rheology.mu1": mu1,
            "rheology.mu2": mu1 + between(0.0, 0.5),
            "rheology.K": between(0.0, 20.0),
            "rheology.grain_diameter": 10.0 ** between(-4.0, -2.0),
            "rheology.phi_eq": draw(st.sampled_from(["f1", "f2"])),
            "slope.angle": between(-45.0, 45.0),
            "column.height": 10.0 ** between(-1.5, 0.5),
            "column.length": between(0.05, 0.6),
            "column.start": between(-0.2, 0.0),
            "column.phi": between(0.3, 0.7),
            "grid.cells": draw(st.integers(40, 300)),
            "scheme.alpha": draw(st.sampled_from([1.5, 2.0, 3.0])),
            "scheme.cfl": between(0.1, 0.5),
            "scheme.left": "wall",
            "scheme.right": "wall",
            "time.series": {"every": 0.05},
        }
    )


@given(case=collapses(), other=collapses(), precision=st.sampled_from(["float64", "float32"]))
@settings(max_examples=60)
def test_any_collapse_is_sound(case: Case, other: Case, precision: str) -> None:
    rounding = 1e-12 if precision == "float64" else 1e-4
    data = wg.simulate([other, case], precision=precision)  # type: ignore[arg-type]
    run = data.isel(run=1, cell=slice(0, case.grid.cells))
    assert run["status"] == Status.OK
    h, v, phi = (run[name].values for name in ("h", "v", "phi"))
    assert np.isfinite([h, v, phi]).all()
    assert h.min() >= 0.0
    assert 0.0 < phi.min()
    assert phi.max() <= max(case.column.phi, case.rheology.phi_stat) * 1.05  # a little above the initial maximum
    mass = run["mass"].values
    assert np.abs(mass / mass[0] - 1.0).max() <= rounding
    alone = wg.simulate(case, precision=precision)  # type: ignore[arg-type]
    np.testing.assert_array_equal(alone["h"][0], h)  # whatever its neighbours in the batch
