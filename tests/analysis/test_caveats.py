"""Whose results hold with a reserve, and how that is said."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from helpers.cases import small
from helpers.collapses import batch, by_hand, collapse

import warpgran as wg
from warpgran.analysis.caveats import caveats, messages
from warpgran.errors import ResultError
from warpgran.run.options import EngineName


def moving(data: xr.Dataset, *runs: int) -> xr.Dataset:
    """The result with runs that had not stopped."""
    for run in runs:
        data["v_flow_final"][run] = 0.25
        data["stop_time"][run] = np.nan
    return data


def losing(data: xr.Dataset, **shares: float) -> xr.Dataset:
    """The result with runs that lost a share of the solid from the middle of the samples on."""
    for run, share in shares.items():
        data["outflow"][int(run[1:]), 50:] = data["outflow_final"][int(run[1:])] = share
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
    said = "run 0 had not stopped at the end (0.25 m/s at t = 0.9 s): its run-out is not final"
    assert messages(data) == [f"{said}, and grew by 0 % in the last tenth of the time"]
    data["front"][:] = np.linspace(0.0, 0.5, 100) ** 2
    assert messages(data) == [f"{said}, and grew by 17 % in the last tenth of the time"]
    assert messages(data.drop_vars("front")) == [said]
    assert messages(losing(data, _0=0.23))[1:] == [said]  # at the end of the grid its front is stuck


def test_a_column_that_never_moved_and_a_periodic_flow_need_no_words() -> None:
    at_rest = moving(collapse(), 0)
    at_rest["v_flow_final"][:] = 1e-5
    assert messages(at_rest) == []
    periodic = moving(collapse(), 0).assign_attrs(case_toml='[time]\nrest_speed = 1e-3\n[scheme]\nleft = "periodic"')
    assert messages(periodic) == []


def test_a_batch_is_counted_and_the_first_are_named() -> None:
    data = losing(batch(slope__angle=np.arange(6.0)), **{f"_{run}": 0.1 * run for run in range(1, 6)})
    assert messages(data) == ["5 of 6 runs left the grid (1, 2, 3, ...; up to 50 %): run-outs are lower bounds"]
    assert messages(moving(batch(slope__angle=np.arange(6.0)), 2, 5)) == [
        "2 of 6 runs had not stopped (2, 5; up to 0.25 m/s): run-outs are not final"
    ]


def test_a_caveat_of_a_large_batch_fits_the_line_of_a_terminal() -> None:
    data = moving(batch(slope__angle=np.linspace(0.0, 22.0, 2000)), *range(1500, 2000))
    lines = messages(losing(data, **{f"_{run}": 0.1234 for run in range(1000, 2000)}))
    assert len(lines) == 2 and max(map(len, lines)) < 100


def test_every_run_that_did_not_end_cleanly_is_named() -> None:
    assert messages(by_hand()) == [
        "run 5 (slope.angle = 10, rheology.phi_eq = f1) diverged after t = 0.14 s",
        "1 of 3 runs are not computed: 6",
        "1 of 3 runs left the grid (5; up to 20 %): run-outs are lower bounds",
    ]
    many = batch(slope__angle=np.arange(50.0))
    many["status"][10:] = "step_limit"
    lines = messages(many)
    assert lines[0] == "run 10 (slope.angle = 10) reached its step limit, 1000 steps, at t = 0.9 s"
    assert lines[20:] == ["20 runs more ended as step_limit: 30-49"]


def test_a_selection_without_runs_is_refused() -> None:
    with pytest.raises(ResultError, match=r"data\.isel\(run=\[0\]\)"):
        caveats(collapse().isel(run=0))


@pytest.mark.parametrize("engine", ["warp", "numpy"])
@pytest.mark.parametrize("series", [[], [0.0, 0.01]])
def test_caveats_do_not_depend_on_the_series(engine: EngineName, series: list[float]) -> None:
    short = small(**{"grid.right": 0.1, "grid.cells": 60, "time.end": 0.3, "time.snapshots": []})
    said = messages(wg.simulate(short.with_(time={"series": [0.3]}), engine=engine))
    assert len(said) == 2 and "lost solid through an end of the grid" in said[0] and "had not stopped" in said[1]
    without = wg.simulate(short.with_(time={"series": series}), engine=engine)
    assert without.sizes["series_time"] == len(series)
    assert messages(without) == [said[0].replace(", from t = 0.3 s on", ""), said[1]]
