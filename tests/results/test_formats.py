"""What others see of a result file: the rules of the CF conventions, netCDF4, and plain xarray and h5py."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import xarray as xr
from helpers.cases import small

import warpgran as wg
from warpgran.case.study import Study
from warpgran.run.options import Options
from warpgran.run.to_file import run_to_file
from warpgran.schema import FIELDS, PER_RUN, SERIES

SAMPLED: dict[str, Any] = {"title": "Collapses", "time.series": {"every": 0.02}}
EXCEPTIONS = {
    "§3.1 Units": "time must be in a valid units format <unit> since <epoch> not s",
    "§4.4 Time Coordinate": "does not have correct time units",
    "§4.4.1 Calendar": 'should have a string valued attribute "calendar"',
    "§2.3 Naming Conventions": "should begin with a letter and be composed of letters, digits, and underscores",
    "§2.4 Dimensions": "run (U), time (T), ",
}
"""What the checker finds, by rule, and a part of each message.

The time of a collapse counts from its start, not from a date of a calendar. Swept keys have the names that they have in
the run file, with a dot. The order of the dimensions is the recommended one, but the checker does not know x and cell:
with the attribute axis it would take them for longitudes.
"""


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """A batch on one grid, and one whose grids differ."""
    folder = tmp_path_factory.mktemp("formats")
    sweeps: dict[str, dict[str, Any]] = {
        "one": {"slope.angle": [10.0, 22.0], "rheology.phi_eq": ["f0", "f2"], "scheme.window": [True, False]},
        "differ": {"grid.cells": [100, 200], "slope.angle": [10.0, 22.0]},
    }
    for name, over in sweeps.items():
        run_to_file(small(**SAMPLED).sweep(over, mode="zip" if name == "differ" else "product"),
                    folder / f"{name}.nc", Options())  # fmt: skip
    return {name: folder / f"{name}.nc" for name in sweeps}


@pytest.mark.slow
def test_the_file_follows_the_cf_conventions(files: dict[str, Path], tmp_path: Path) -> None:
    checker = shutil.which("compliance-checker", path=Path(sys.executable).parent)
    assert checker, "compliance-checker is in the extra `test`"
    report = tmp_path / "report.json"
    command = [checker, "-t", "cf:1.11", "-f", "json_new", "-o", str(report), *map(str, files.values())]
    subprocess.run(command, check=False, capture_output=True)
    found = json.loads(report.read_text())
    assert found.keys() == {str(path) for path in files.values()}
    for result in found.values():
        assert result["cf:1.11"]["possible_points"] > 100
        failed = {rule["name"]: rule["msgs"] for rule in result["cf:1.11"]["all_priorities"] if rule["msgs"]}
        assert failed.keys() <= EXCEPTIONS.keys(), failed
        for name, messages in failed.items():
            assert all(EXCEPTIONS[name] in message for message in messages), messages
        assert all("." in message.split()[1] for message in failed["§2.3 Naming Conventions"])


@pytest.mark.parametrize("engine", ["h5netcdf", "netcdf4"])
@pytest.mark.parametrize("name", ["one", "differ"])
def test_plain_xarray_sees_everything(files: dict[str, Path], name: str, engine: Any) -> None:
    if engine == "netcdf4":
        pytest.importorskip("netCDF4")
    ours = wg.open_dataset(files[name])
    with xr.open_dataset(files[name], engine=engine) as plain:
        assert set(plain.variables) == set(ours.variables) - {"case_toml"}
        assert set(plain.coords) == set(ours.coords) - {"case_toml"}
        assert {*FIELDS, *SERIES, *PER_RUN, "bed"} <= set(plain.data_vars)
        for variable in plain.variables:
            assert plain[variable].dims == ours[variable].dims
            np.testing.assert_array_equal(plain[variable].values, ours[variable].values)
        assert plain.attrs.keys() == ours.attrs.keys()
        assert plain.attrs["Conventions"] == "CF-1.11"


def test_coordinates_select_as_they_stand(files: dict[str, Path]) -> None:
    data = wg.open_dataset(files["one"])
    here = data["h"].sel(x=0.3, time=0.1, method="nearest").isel(run=0)
    assert abs(float(here["x"]) - 0.3) <= 0.5 * 0.8 / 200 + 1e-12
    assert float(here["time"]) == 0.1
    (line, *_) = data["front"].isel(run=0).plot.line(x="series_time")
    np.testing.assert_array_equal(line.get_xdata(), data["series_time"])
    np.testing.assert_array_equal(line.get_ydata(), data["front"][0])
    steep = data["run_out"].where((data["slope.angle"] == 22.0) & (data["rheology.phi_eq"] == "f2"), drop=True)
    assert steep.size == 2


def test_dimensions_are_scales_and_nothing_is_in_a_group(files: dict[str, Path]) -> None:
    for path, along in ((files["one"], "x"), (files["differ"], "cell")):
        with h5py.File(path) as file:
            assert not any(h5py.check_enum_dtype(item.dtype) for item in file.values())  # R leaves those out
            assert all(isinstance(item, h5py.Dataset) for item in file.values())
            assert {name for name in file if file[name].is_scale} == {"run", "time", "series_time", along}
            assert [axis[0].name for axis in file["h"].dims] == ["/run", "/time", f"/{along}"]


def test_of_a_run_without_series_its_end_alone_is_known(tmp_path: Path) -> None:
    run_to_file(Study.of([small()]), tmp_path / "none.h5", Options())
    with xr.open_dataset(tmp_path / "none.h5", engine="h5netcdf") as data:
        assert data.sizes["series_time"] == 0
        for name in ("run_out", "dilation_max", "stop_time"):
            assert np.isnan(data[name].values).all()
        assert data["h_max_final"].values == data["h"].values[:, -1].max()
        assert data["end_time"].values == 0.2
