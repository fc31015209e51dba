"""Result files: what xarray reads is what was computed, and nothing half-written is left."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import xarray as xr
from helpers.cases import DIVERGING, ON_ONE_GRID, small

import warpgran as wg
from warpgran.case.case import Case
from warpgran.case.study import Study
from warpgran.files import StorageError, replacing
from warpgran.run.options import Options
from warpgran.run.to_file import run_to_file
from warpgran.schema import Status

SERIES = {"time.series": {"every": 0.02}}
SWEPT = ("slope.angle", "time.rest_speed", "grid.cells", "scheme.order", "scheme.h_min", "rheology.K")


def written(path: Path, cases: list[Case]) -> xr.Dataset:
    run_to_file(Study.of(cases), path, Options())
    return wg.open_dataset(path)


@pytest.fixture(scope="module")
def cases() -> list[Case]:
    return [
        small(**SERIES),
        small(**{"slope.angle": 10.0, "grid.cells": 150, **SERIES}),
        small(**DIVERGING, **SERIES),
    ]


@pytest.fixture(scope="module")
def batch(tmp_path_factory: pytest.TempPathFactory, cases: list[Case]) -> Path:
    path = tmp_path_factory.mktemp("batch") / "batch.h5"
    written(path, cases)
    return path


def test_xarray_opens_it_by_name(batch: Path) -> None:
    with xr.open_dataset(batch, engine="h5netcdf") as data:
        assert data["h"].dims == ("run", "time", "cell")
        assert data["h"].attrs == {"units": "m", "long_name": "thickness normal to the slope"}
        assert float(data["h"].sel(run=0, time=0.2).max()) == wg.simulate(small(**SERIES))["h_max"][0, -1]
        assert data["x"].dims == ("run", "cell")  # the grids differ
        assert data["status"].attrs["flag_meanings"] == "ok diverged step_limit interrupted at_rest pending"
        assert {name: data[name].attrs["units"] for name in ("v", "phi", "time", "series_time", "stop_time")} == {
            "v": "m s-1", "phi": "1", "time": "s", "series_time": "s", "stop_time": "s",
        }  # fmt: skip
        assert data["front"].dims == ("run", "series_time")
        assert data["energy"].attrs["units"] == "m4 s-2"
        assert set(data.coords) == {"run", "time", "series_time", "cell", "x", *SWEPT}
    with h5py.File(batch) as file:
        assert file["status"].dtype == np.int8
        assert file["status"].attrs["flag_values"].tolist() == [int(status) for status in Status]
        assert list(file["slope.angle"]) == [22.0, 10.0, 22.0]


def test_every_variable_has_units_and_a_name(batch: Path) -> None:
    data = wg.open_dataset(batch)
    for name in data.variables.keys() - {"case_toml"}:
        assert data[name].attrs["units"], name
        assert data[name].attrs["long_name"], name


def assert_same(a: xr.Dataset, b: xr.Dataset) -> None:
    """Equal but for when and how fast they were computed."""
    changing = ("date", "history", "wall_seconds", "kernel_seconds", "run_file")
    a, b = (data.load().assign_attrs(dict.fromkeys(changing)) for data in (a, b))
    xr.testing.assert_identical(a, b)


def test_the_file_holds_what_simulate_returns(batch: Path, cases: list[Case]) -> None:
    assert_same(wg.open_dataset(batch), wg.simulate(cases))


def test_one_run_on_one_grid(tmp_path: Path) -> None:
    case = small(**ON_ONE_GRID, **SERIES)
    data = written(tmp_path / "one.h5", [case])
    assert data["x"].dims == ("x",)
    assert data["bed"].dims == ("x",)
    assert dict(data.sizes) == {"run": 1, "time": 2, "series_time": 11, "x": 200}
    np.testing.assert_array_equal(data["x"], case.x)
    assert data.attrs["cell_steps"] == int(data["steps"][0]) * 200
    assert data.attrs["precision"] == "float64"
    assert data.attrs["kernel_seconds"] <= data.attrs["wall_seconds"]
    assert Case.from_dict(tomllib.loads(data.attrs["case_toml"])) == case
    assert [path.name for path in tmp_path.iterdir()] == ["one.h5"]


def test_what_a_diverged_run_had_is_kept_and_the_rest_is_nan(batch: Path) -> None:
    data = wg.open_dataset(batch)
    assert list(data["status"]) == [Status.OK, Status.OK, Status.DIVERGED]
    front = data["front"].sel(run=2)
    assert np.isfinite(front[0])
    assert np.isnan(front[-1])
    assert np.isnan(data["h"].sel(run=2)).all()
    assert 0.0 < data["end_time"].sel(run=2) < 0.1
    assert "phi outside (0, 1]" in str(data["failure"].sel(run=2).item())
    assert np.isfinite(data["h"].sel(run=0)).all()


def test_one_run_is_read_without_the_others(tmp_path: Path) -> None:
    written(tmp_path / "two.h5", [small(**SERIES), small(**SERIES)])
    with h5py.File(tmp_path / "two.h5") as file:
        assert file["h"].chunks[0] == 1
        assert file["h"].compression == "gzip"


@pytest.mark.parametrize("changes", [{"time.snapshots": []}, {"time.series": []}])
def test_no_snapshots_or_no_series(tmp_path: Path, changes: dict[str, Any]) -> None:
    case = small(**{**SERIES, **changes})
    data = written(tmp_path / "some.h5", [case])
    assert data["end_time"][0] == 0.2
    assert_same(data, wg.simulate(case))
    assert 0 in data.sizes.values()


def test_a_failure_leaves_the_old_file_and_no_other(tmp_path: Path) -> None:
    path = tmp_path / "old.h5"
    path.write_text("old")
    with pytest.raises(RuntimeError), replacing(path) as part:
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
    with pytest.raises(StorageError, match=words):
        wg.open_dataset(path)


def test_cases_of_a_batch_share_their_output_times() -> None:
    with pytest.raises(ValueError, match="share"):
        wg.simulate([small(), small(**{"time.end": 0.3, "time.snapshots": [0.3]})])
