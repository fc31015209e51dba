"""Whose results hold with a reserve, and how that is said."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from helpers.collapses import batch, by_hand, collapse

from warpgran.analysis.caveats import caveats, messages
from warpgran.errors import ResultError


def moving(data: xr.Dataset, *runs: int) -> xr.Dataset:
    """The result with runs that had not stopped."""
    for run in runs:
        data["v_flow"][run, -1] = 0.25
        data["stop_time"][run] = np.nan
    return data


def losing(data: xr.Dataset, **shares: float) -> xr.Dataset:
    """The result with runs that lost a share of the solid from the middle of the samples on."""
    for run, share in shares.items():
        data["outflow"][int(run[1:]), 50:] = share
    return data


def test_a_result_without_reserve_has_none() -> None:
    assert {name: which.tolist() for name, which in caveats(collapse()).items()} == {
        "left_grid": [False],
        "moving": [False],
    }
    assert messages(collapse()) == []


def test_solid_that_left_is_told_with_share_and_time() -> None:
    data = losing(collapse(), _0=0.23)
    assert caveats(data)["left_grid"].tolist() == [True]
    assert messages(data) == [
        "run 0 lost solid through an end of the grid (23 %, from t = 0.4545 s on): its run-out is a lower bound"
    ]
    assert messages(losing(collapse(), _0=9e-4)) == []


def test_a_flow_that_had_not_stopped_is_told() -> None:
    data = moving(collapse(), 0)
    assert caveats(data)["moving"].tolist() == [True]
    assert messages(data) == ["run 0 had not stopped at the end (0.25 m/s at t = 0.9 s): its run-out is not final"]


def test_a_column_that_never_moved_and_a_periodic_flow_need_no_words() -> None:
    at_rest = moving(collapse(), 0)
    at_rest["v_flow"][:] = 1e-5
    assert messages(at_rest) == []
    periodic = moving(collapse(), 0).assign_attrs(case_toml='[time]\nrest_speed = 1e-3\n[scheme]\nleft = "periodic"')
    assert messages(periodic) == []


def test_a_batch_is_counted_and_the_first_are_named() -> None:
    data = losing(batch(slope__angle=np.arange(6.0)), **{f"_{run}": 0.1 * run for run in range(1, 6)})
    (line,) = messages(data)
    assert line == (
        "5 of 6 runs lost solid through an end of the grid, so that their run-outs are lower bounds: "
        "run 1 (slope.angle = 1; 10 %, from t = 0.4545 s on), run 2 (slope.angle = 2; 20 %, from t = 0.4545 s on), "
        "run 3 (slope.angle = 3; 30 %, from t = 0.4545 s on), and 2 more"
    )


def test_every_run_that_did_not_end_cleanly_is_named() -> None:
    assert messages(by_hand()) == [
        "run 5 (slope.angle = 10, rheology.phi_eq = f1) diverged after t = 0.14 s",
        "1 of 3 runs are not computed: 6",
        "1 of 3 runs lost solid through an end of the grid, so that their run-outs are lower bounds: "
        "run 5 (slope.angle = 10, rheology.phi_eq = f1; 20 %, from t = 0.1 s on)",
    ]
    many = batch(slope__angle=np.arange(50.0))
    many["status"][10:] = "step_limit"
    lines = messages(many)
    assert lines[0] == "run 10 (slope.angle = 10) reached its step limit, 1000 steps, at t = 0.9 s"
    assert lines[20:] == ["20 runs more ended as step_limit: 30-49"]


def test_a_selection_without_runs_is_refused() -> None:
    with pytest.raises(ResultError, match=r"data\.isel\(run=\[0\]\)"):
        caveats(collapse().isel(run=0))


def test_without_series_nothing_is_known() -> None:
    assert messages(collapse(samples=0)) == []
