"""The dataset of indices, its tables and its files."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pandas as pd
import pytest
import xarray as xr
from helpers.cases import small
from helpers.designs import KEYS, TIMES, g_function, g_indices, ishigami, ishigami_indices, result_of, study_of

import warpgran as wg
from warpgran.sensitivity_analysis.table import shown_rows, table, write_dataset, write_table

OF = ["run_out", "front", "front@0.5"]


@pytest.fixture(scope="module")
def found() -> xr.Dataset:
    """Indices of Ishigami's function as the run-out, and of a front that is 0, then it, then twice its first part."""
    study = study_of(3, samples=4096, of=OF)
    return wg.indices(
        result_of(study, ishigami, lambda x: np.stack([0 * x[:, 0], ishigami(x), 2.0 * np.sin(x[:, 0])], axis=1))
    )


def test_indices_by_the_names_of_the_run_file(found: xr.Dataset) -> None:
    first, total = ishigami_indices()
    for name in ("run_out", "front@0.5"):
        one = found.sel(output=name)
        np.testing.assert_allclose(one["first_order"], first, atol=0.03)
        np.testing.assert_allclose(one["total_order"], total, atol=0.03)
    second = found["total_order"].sel(output="run_out", parameter="rheology.K_tilde")
    assert float(second) == pytest.approx(total[1], abs=0.03)
    assert (found["first_order_low"] < found["first_order"]).all()
    assert (found["first_order"] < found["first_order_high"]).all()
    assert found["distribution"].values.tolist() == ["0.1 to 0.2"] * 3
    assert found["output_units"].values.tolist() == ["m", "m"]
    assert found["first_order"].attrs == {"long_name": "first-order Sobol index", "units": "1"}


def test_indices_over_time(found: xr.Dataset) -> None:
    series = found["total_order_over_time"].sel(series="front")
    assert series["series_time"].values.tolist() == [*TIMES]
    assert np.isnan(series.isel(series_time=0)).all()  # it does not vary yet
    np.testing.assert_allclose(series.sel(series_time=0.5), found["total_order"].sel(output="front@0.5"), rtol=1e-12)
    np.testing.assert_allclose(series.sel(series_time=1.0), [1.0, 0.0, 0.0], atol=0.02)
    assert found["sd_over_time"].sel(series="front").values[0] == 0.0


def test_moments_are_of_the_independent_runs(found: xr.Dataset) -> None:
    assert float(found["mean"].sel(output="run_out")) == pytest.approx(3.5, abs=0.02)
    exact = np.sqrt(49.0 / 8.0 + 0.1 * np.pi**4 / 5.0 + 0.01 * np.pi**8 / 18.0 + 0.5)
    assert float(found["sd"].sel(output="run_out")) == pytest.approx(exact, abs=0.03)


def test_main_effects_are_conditional_means(found: xr.Dataset) -> None:
    at = (found["main_effect_at"].sel(parameter="rheology.K_tilde") - 0.1) / 0.1
    mean = found["main_effect"].sel(output="run_out", parameter="rheology.K_tilde")
    exact = 7.0 * np.sin(np.pi * (2.0 * at - 1.0)) ** 2  # the others have the mean 0
    assert found.sizes["bin"] == 16
    np.testing.assert_allclose(mean, exact, atol=0.6)
    low, high = (found[f"main_effect_{end}"].sel(output="run_out") for end in ("low", "high"))
    assert (low < found["main_effect"].sel(output="run_out")).all()
    assert (high > found["main_effect"].sel(output="run_out")).all()


def test_morris(found: xr.Dataset) -> None:
    study = study_of(4, samples=500, method="morris", of=OF)
    effects = wg.indices(result_of(study, g_function, lambda x: g_function(x)[:, None] * np.array([0.0, 1.0, 2.0])))
    strong = effects["mu_star"].sel(output="run_out")
    order = effects["parameter"].values[np.argsort(-strong.values)].tolist()
    assert order == [*KEYS[:4]]  # as the exact total indices have it
    assert np.all(np.diff(g_indices()[1]) < 0.0)
    np.testing.assert_allclose(effects["mu_star_over_time"].isel(series=0, series_time=2), 2.0 * strong, rtol=1e-12)
    assert (effects["mu_star_low"] <= effects["mu_star"]).all()


def test_the_table_has_a_row_for_each_time_and_parameter(found: xr.Dataset, tmp_path: Path) -> None:
    rows = table(found)
    assert len(rows) == 2 * 3 + 3 * 3
    assert rows["time"].isna().sum() == 6
    again = pd.read_csv(write_table(found, tmp_path / "a.csv"))
    pd.testing.assert_frame_equal(again, rows, check_exact=False, check_dtype=False)
    row = rows[(rows["output"] == "front") & (rows["time"] == 1.0) & (rows["parameter"] == KEYS[0])]
    assert float(row["total_order"].iloc[0]) == pytest.approx(1.0, abs=0.02)
    assert set(shown_rows(found)["time"].dropna()) == {0.5, 1.0}


def test_the_file_holds_what_there_is(found: xr.Dataset, tmp_path: Path) -> None:
    with xr.open_dataset(write_dataset(found, tmp_path / "a.nc"), engine="h5netcdf") as again:
        xr.testing.assert_identical(again.load(), found)


def test_a_file_of_somebody_else_is_not_replaced(found: xr.Dataset, tmp_path: Path) -> None:
    with h5py.File(tmp_path / "a.nc", "w") as file:
        file["gone"] = h5py.SoftLink("/nowhere")
    with pytest.raises(wg.StorageError, match=r"a\.nc: what is there was not written by warpgran; remove it first"):
        write_dataset(found, tmp_path / "a.nc")


def test_from_a_case_to_indices() -> None:
    case = small(**{"time.series": {"every": 0.05}, "grid.cells": 50})
    over = {"slope.angle": {"low": 0.0, "high": 20.0}, "column.height": {"low": 0.1, "high": 0.14}}
    found = wg.sensitivity(case, over, of=["front@0.2", "h_max"], samples=8, threads=1)
    assert found["total_order"].sel(output="front@0.2").values.min() > 0.05
    assert found["total_order_over_time"].sel(series="h_max").isel(series_time=0).values.tolist() == pytest.approx(
        [0.0, 1.0], abs=0.5
    )
    assert found.attrs["runs"] == 8 * 4
    again = wg.sensitivity(case, over, of=["front@0.2", "h_max"], samples=8, threads=1)
    xr.testing.assert_identical(found, again)
