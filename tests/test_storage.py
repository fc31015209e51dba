"""Result files: what xarray reads is what was computed, and nothing half-written is left."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import xarray as xr
from cases import small

import warpgran as wg
from warpgran import storage
from warpgran.case import Case
from warpgran.results import Results, stop_time
from warpgran.schema import Status
from warpgran.simulation import compute

SERIES = {"time.series": {"every": 0.02}}


def written(path: Path, cases: list[Case]) -> Results:
    results, _ = compute(cases)
    with storage.replacing(path) as part:
        storage.write(results, part)
    return results


@pytest.fixture(scope="module")
def batch(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Results]:
    path = tmp_path_factory.mktemp("batch") / "batch.h5"
    cases = [
        small(**SERIES),
        small(**{"slope.angle": 10.0, "grid.cells": 150, **SERIES}),
        small(**{"scheme.viscosity": "paper", "rheology.K": 0.0, **SERIES}),  # diverges
    ]
    return path, written(path, cases)


def test_xarray_opens_it_by_name(batch: tuple[Path, Results]) -> None:
    path, results = batch
    with xr.open_dataset(path, engine="h5netcdf") as data:
        assert data["h"].dims == ("run", "time", "cell")
        assert data["h"].attrs == {"units": "m", "long_name": "thickness normal to the slope"}
        assert data["h"].sel(run=0, time=0.2).max() == results.fields["h"][0, 1].max()
        assert data["x"].dims == ("run", "cell")  # the grids differ
        assert data["status"].attrs["flag_meanings"] == "ok diverged step_limit interrupted"
        assert {name: data[name].attrs["units"] for name in ("v", "phi", "time", "series_time", "stop_time")} == {
            "v": "m s-1", "phi": "1", "time": "s", "series_time": "s", "stop_time": "s",
        }  # fmt: skip
    with xr.open_dataset(path, engine="h5netcdf", group="series") as series:
        assert series["front"].dims == ("run", "sample")
        assert series["energy"].attrs["units"] == "m4 s-2"
    with h5py.File(path) as file:
        assert h5py.check_enum_dtype(file["status"].dtype) == {status.word: int(status) for status in Status}
        assert list(file["params/slope.angle"]) == [22.0, 10.0, 22.0]


def test_every_variable_has_units_and_a_name(batch: tuple[Path, Results]) -> None:
    data = wg.open_dataset(batch[0])
    for name in (*data.data_vars, "x", "time", "series_time"):
        assert data[name].attrs["units"], name
        assert data[name].attrs["long_name"], name


def test_the_file_holds_what_simulate_returns(batch: tuple[Path, Results]) -> None:
    path, results = batch
    xr.testing.assert_identical(wg.open_dataset(path).load(), results.to_dataset())


def test_one_run_on_one_grid(tmp_path: Path) -> None:
    results = written(tmp_path / "one.h5", [small(**SERIES)])
    data = wg.open_dataset(tmp_path / "one.h5")
    assert data["x"].dims == ("cell",)
    assert data["bed"].dims == ("cell",)
    assert dict(data.sizes) == {"run": 1, "time": 2, "sample": 11, "cell": 200}
    np.testing.assert_array_equal(data["x"], results.cases[0].x)
    assert data.attrs["cell_steps"] == int(results.steps[0]) * 200
    assert data.attrs["precision"] == "float64"
    assert data.attrs["kernel_seconds"] <= data.attrs["wall_seconds"]
    assert Case.from_dict(__import__("tomllib").loads(data.attrs["case_toml"])) == results.cases[0]


def test_what_a_diverged_run_had_is_kept_and_the_rest_is_nan(batch: tuple[Path, Results]) -> None:
    data = wg.open_dataset(batch[0])
    assert list(data["status"]) == [Status.OK, Status.OK, Status.DIVERGED]
    front = data["front"].sel(run=2)
    assert np.isfinite(front[0])
    assert np.isnan(front[-1])
    assert np.isnan(data["h"].sel(run=2)).all()
    assert 0.0 < data["end_time"].sel(run=2) < 0.1
    assert np.isfinite(data["h"].sel(run=0)).all()


@pytest.mark.parametrize("changes", [{"time.snapshots": []}, {"time.series": []}])
def test_no_snapshots_or_no_series(tmp_path: Path, changes: dict[str, Any]) -> None:
    results = written(tmp_path / "part.h5", [small(**{**SERIES, **changes})])
    assert results.end_time[0] == 0.2
    data = wg.open_dataset(tmp_path / "part.h5")
    xr.testing.assert_identical(data.load(), results.to_dataset())
    assert 0 in data.sizes.values()


@pytest.mark.parametrize(
    ("v_flow", "expected"),
    [
        ([0.0, 1.0, 0.5, 1e-4, 1e-5], 3.0),
        ([0.0, 1.0, 1e-4, 0.5, 1e-5], 4.0),  # it moved again
        ([0.0, 1.0, 0.5, 0.5, 0.5], np.nan),
        ([0.0, 0.0, 0.0, 0.0, 0.0], np.nan),  # it never moved
        ([0.0, 1.0, 1e-4, np.nan, np.nan], np.nan),  # it diverged
    ],
)
def test_stop_time(v_flow: list[float], expected: float) -> None:
    found = stop_time(np.arange(5.0), np.array(v_flow), 1e-3)
    np.testing.assert_equal(found, expected)


def test_a_failure_leaves_the_old_file_and_no_other(tmp_path: Path) -> None:
    path = tmp_path / "old.h5"
    path.write_text("old")
    with pytest.raises(RuntimeError), storage.replacing(path) as part:
        part.write_text("half")
        raise RuntimeError
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda path: None, "there is no such file"),
        (lambda path: path.write_text("text"), "not an HDF5 file"),
        (lambda path: h5py.File(path, "w").close(), "not a warpgran result"),
        (lambda path: h5py.File(path, "w").attrs.update(schema_version=99), "schema is version 99"),
    ],
)
def test_other_files_are_refused(tmp_path: Path, make: Any, words: str) -> None:
    path = tmp_path / "other.h5"
    make(path)
    with pytest.raises(storage.StorageError, match=words):
        wg.open_dataset(path)


def test_cases_of_a_batch_share_their_output_times() -> None:
    with pytest.raises(ValueError, match="share"):
        wg.simulate([small(), small(**{"time.end": 0.3, "time.snapshots": [0.3]})])
