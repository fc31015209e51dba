"""Runs that cannot be used: each kind is refused with its number and place, and left out if that is asked for."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr
from helpers.designs import points_of, result_of, study_of

import warpgran as wg
from warpgran.schema import Status

STUDY = study_of(2, samples=16, of=["run_out", "front"])
BAD = np.array([5, 6, 17])  # of the base samples 1 and 4: d + 2 = 4 runs each


def result() -> xr.Dataset:
    return result_of(STUDY, lambda x: x[:, 0] + x[:, 1] ** 2, lambda x: x[:, :1] * np.array([0.0, 1.0, 2.0]))


def diverged(data: xr.Dataset) -> None:
    data["status"][BAD] = int(Status.DIVERGED)


def ran_out_of_steps(data: xr.Dataset) -> None:
    data["status"][BAD] = int(Status.STEP_LIMIT)


def left_the_grid(data: xr.Dataset) -> None:
    data["outflow_final"][BAD] = 0.01


def still_moving(data: xr.Dataset) -> None:
    data["stop_time"][BAD] = np.nan
    data["v_flow_final"][BAD] = 1.0


def no_run_out(data: xr.Dataset) -> None:
    data["run_out"][BAD] = np.nan


def no_front(data: xr.Dataset) -> None:
    data["front"][BAD, 1] = np.inf


KINDS = [
    (diverged, "3 runs ended as diverged: 5, 6, 17; "),
    (ran_out_of_steps, "3 runs ended as step_limit: 5, 6, 17; "),
    (left_the_grid, "3 runs lost solid through an end of the grid (make it longer): 5, 6, 17; "),
    (still_moving, "3 runs had not stopped: no run_out yet (make time.end later, or ask for a series at a time"),
    (no_run_out, "3 runs gave no run-out: 5, 6, 17; "),
    (no_front, "3 runs gave no front at some time: 5, 6, 17; "),
]


@pytest.mark.parametrize(("spoil", "words"), KINDS, ids=[spoil.__name__ for spoil, _ in KINDS])
def test_runs_that_cannot_be_used_are_refused(spoil: Callable[[xr.Dataset], None], words: str) -> None:
    data = result()
    spoil(data)
    with pytest.raises(wg.ResultError) as caught:
        wg.indices(data)
    first, line, last = str(caught.value).splitlines()
    assert first == "3 of 64 runs cannot be used, which concerns 2 of 16 base samples (12.5%):"
    assert line.startswith(words)
    assert "--drop-failed" in last


@pytest.mark.parametrize(("spoil", "words"), KINDS, ids=[spoil.__name__ for spoil, _ in KINDS])
def test_whole_base_samples_are_left_out(spoil: Callable[[xr.Dataset], None], words: str) -> None:
    data = result()
    spoil(data)
    found = wg.indices(data, drop_failed=True)
    assert (found.attrs["samples"], found.attrs["dropped_samples"], found.attrs["runs"]) == (14, 2, 64)
    told = found.attrs["notes"].splitlines()
    assert told[0].startswith("left out 2 of 16 base samples (12.5%)")
    assert told[1].startswith(words)
    rest = np.delete(np.arange(64).reshape(16, 4), [1, 4], axis=0).ravel()
    fewer = result().isel(run=rest)
    y = fewer["run_out"].values.reshape(14, 4)
    variance = y[:, :2].var()
    total = 0.5 * ((y[:, :1] - y[:, 2:]) ** 2).mean(axis=0) / variance
    np.testing.assert_allclose(found["total_order"].sel(output="run_out"), total, rtol=1e-9)
    assert np.isfinite(found["total_order_over_time"][:, 1:]).all()


def test_one_nan_does_not_make_indices_of_0() -> None:
    data = result()
    data["run_out"][5] = np.nan
    with pytest.raises(wg.ResultError, match="1 run gave no run-out: 5; "):
        wg.indices(data)
    assert float(wg.indices(data, drop_failed=True)["total_order"].sum()) > 0.9


def test_where_they_lie_in_the_space() -> None:
    data = result()
    x = points_of(STUDY)
    bad = np.flatnonzero(x[:, 1] > 0.9)
    data["status"][bad] = int(Status.DIVERGED)
    with pytest.raises(wg.ResultError, match=r"; rheology\.K_tilde 0\.19\d* to 0\.\d+ of 0\.1\d* to 0\.\d+"):
        wg.indices(data)
    data["status"][:] = int(Status.DIVERGED)
    with pytest.raises(wg.ResultError, match=r"64 runs ended as diverged: 0, 1, .*, 7 and 56 more; all over the space"):
        wg.indices(data)


def test_a_run_counts_for_one_reason() -> None:
    data = result()
    diverged(data)
    no_run_out(data)
    with pytest.raises(wg.ResultError) as caught:
        wg.indices(data)
    assert len(str(caught.value).splitlines()) == 3


def test_what_is_not_asked_for_does_not_matter() -> None:
    data = result()
    still_moving(data)
    no_run_out(data)
    found = wg.indices(data, of=["front", "front@0.5", "dilation_max"])
    assert found.attrs["dropped_samples"] == 0
    assert found.attrs["notes"] == "dilation_max is the same in all runs, so that it has no indices"


def test_a_stop_time_is_asked_of_runs_that_never_moved_too() -> None:
    data = result()
    data["stop_time"][BAD] = np.nan
    assert wg.indices(data, of=["run_out"]).attrs["dropped_samples"] == 0
    with pytest.raises(wg.ResultError, match="3 runs gave no stop time: 5, 6, 17"):
        wg.indices(data, of=["stop_time"])


def test_too_few_samples_are_not_enough() -> None:
    data = result()
    data["status"][np.arange(9) * 4] = int(Status.DIVERGED)
    with pytest.raises(wg.ResultError, match="without them 7 base samples are left; allowed: >= 8"):
        wg.indices(data, drop_failed=True)


def test_runs_that_are_missing_are_refused_whatever_is_asked() -> None:
    data = result()
    with pytest.raises(wg.ResultError, match="has 63 of the 64 runs of its design; allowed: all, so merge its shards"):
        wg.indices(data.isel(run=slice(63)), drop_failed=True)
    data["status"][3] = int(Status.PENDING)
    with pytest.raises(wg.ResultError, match=r"1 of the 64 runs of the design are not computed; .* --resume"):
        wg.indices(data, drop_failed=True)


def test_another_result_is_no_design() -> None:
    data = result()
    del data.attrs["sensitivity"]
    with pytest.raises(wg.ResultError, match=r"no sensitivity design: its run file has no section \[sensitivity\]"):
        wg.indices(data)


@pytest.mark.parametrize(
    ("of", "words"),
    [
        ([], "of: asks for nothing"),
        (["runout"], "did you mean run_out?"),
        (["front@0.7"], "the nearest are 0.5 and 1"),
    ],
)
def test_what_cannot_be_asked(of: list[str], words: str) -> None:
    with pytest.raises(wg.ResultError) as caught:
        wg.indices(result(), of=of)
    assert words in str(caught.value)
