"""How the runs of a result differ."""

from __future__ import annotations

import pytest
import xarray as xr
from helpers.cases import small

import warpgran as wg
from warpgran.analysis.runs import swept
from warpgran.errors import ResultError

SAMPLED = {"time.series": {"every": 0.1}}


def joined(*results: xr.Dataset) -> xr.Dataset:
    return xr.concat(results, "run", data_vars="all", coords="different", compat="equals", join="outer")


def test_results_of_different_sweeps_are_joined_by_their_keys() -> None:
    one = wg.simulate(small(**SAMPLED, **{"slope.angle": 16.0, "rheology.phi_eq": "f1"}))
    many = wg.simulate(small(**SAMPLED).sweep({"slope.angle": [0.0, 10.0]}))
    with pytest.raises(ValueError, match="not present in all datasets"):
        joined(one, many)
    keys = ("slope.angle", "rheology.phi_eq", "time.rest_speed")  # which follows from the slope
    together = joined(*(wg.with_keys(data, *keys) for data in (one, many)))
    assert set(keys) <= set(swept(together))
    assert together["slope.angle"].values.tolist() == [16.0, 0.0, 10.0]
    assert together["rheology.phi_eq"].values.tolist() == ["f1", "f2", "f2"]
    assert wg.summary(together)["slope.angle"].tolist() == [16.0, 0.0, 10.0]
    assert float(wg.derive(together, "mu")["mu"].max()) > 0.0


def test_keys_that_no_run_has_and_selections_without_runs_are_refused() -> None:
    one = wg.simulate(small())
    with pytest.raises(ResultError, match=r"what slope\.angel was"):
        wg.with_keys(one, "slope.angel")
    with pytest.raises(ResultError, match=r"data\.isel\(run=\[0\]\)"):
        wg.with_keys(one.isel(run=0), "slope.angle")
