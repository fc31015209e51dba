"""The page that is written: what is in it, how large it is, and over what it is written."""

from __future__ import annotations

import base64
import gzip
import json
import re
import tracemalloc
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from helpers.collapses import batch, collapse, two_runs

import warpgran as wg
from warpgran.analysis.fields import derive
from warpgran.analysis.front import thick
from warpgran.viewer import page, profiles


def unpacked(html: str, name: str) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """The head and the arrays of a piece of the page."""
    found = re.search(rf'id="{name}">([^<]*)<', html)
    assert found, name
    data = gzip.decompress(base64.b64decode(found[1]))
    end = data.index(b"\n")
    head, place = json.loads(data[:end]), end + 1
    arrays = {}
    for key, about in head["arrays"].items():
        size = int(np.prod(about["shape"]))
        codes = np.frombuffer(data, "<u2", size, place).reshape(about["shape"])
        arrays[key] = np.where(codes == 65535, np.nan, about["offset"] + about["step"] * codes)
        place += 2 * size
    return head, arrays


def head_of(html: str) -> dict[str, Any]:
    found = re.search(r'id="head">(.*?)</script>', html, re.DOTALL)
    assert found
    return dict(json.loads(found[1]))


def written(results: xr.Dataset | Mapping[str, xr.Dataset], folder: Path, **options: Any) -> str:
    return page.view(results, folder / "page.html", **options).read_text(encoding="utf-8")


def test_profiles_are_those_of_the_result_to_half_a_step(tmp_path: Path) -> None:
    data = two_runs()
    html = written(data, tmp_path)
    for run in range(2):
        head, arrays = unpacked(html, f"run-{run}")
        one = data.isel(run=[run])
        one = one.assign(derive(one, "psi", "mu", "I")).isel(run=0)
        mass = thick(one)
        reached = np.flatnonzero(np.isfinite(one["h"].values).all(axis=1))
        assert head["time"] == one["time"].values[reached].tolist()
        cells = [np.abs(one["x"].values - x).argmin() for x in np.linspace(head["x"][0], head["x"][1], head["cells"])]
        for name in profiles.PROFILES:
            expected = (one[name] if name == "h" else one[name].where(mass)).values[np.ix_(reached, cells)]
            half = 0.5 * head["arrays"][name]["step"]
            np.testing.assert_allclose(arrays[name], expected, rtol=0, atol=half * 1.001 + 1e-15, err_msg=name)
        np.testing.assert_allclose(arrays["bed"], one["bed"].values[cells], rtol=0, atol=1e-6)
        for name in profiles.SERIES:
            half = 0.5 * head["arrays"][name]["step"]
            np.testing.assert_allclose(arrays[name], one[name].values, rtol=0, atol=half * 1.001 + 1e-15)


def test_parts_of_a_large_run_give_what_the_whole_gives(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    data = collapse(cells=400, snapshots=9)
    whole = written(data, tmp_path)
    monkeypatch.setattr(profiles, "AT_ONCE", 1000)
    assert re.sub(r'id="head".*', "", written(data, tmp_path)) == re.sub(r'id="head".*', "", whole)


def test_blocks_of_runs_give_what_each_alone_gives(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    data = two_runs()
    together = written(data, tmp_path)
    monkeypatch.setattr(profiles, "MOST_RUNS", 1)
    assert written(data, tmp_path) == together


def cells_of(head: dict[str, Any], arrays: dict[str, np.ndarray], x: np.ndarray) -> np.ndarray:
    """The cells of the grid that a run on the page has, as the page finds them."""
    places = np.r_[0, np.cumsum(np.rint(arrays["gap"]))]
    at = head["x"][0] + (head["x"][1] - head["x"][0]) * places / places[-1]
    cells = np.abs(x[:, None] - at).argmin(axis=0)
    np.testing.assert_allclose(x[cells], at, rtol=0, atol=1e-9)
    return np.asarray(cells)


def test_cells_are_thinned_to_the_size_and_the_page_knows_it(tmp_path: Path) -> None:
    data = collapse(cells=20_000, snapshots=30)
    large, small = (written(data, tmp_path, max_size=size) for size in (20e6, 250_000))
    head, arrays = unpacked(small, "run-0")
    assert len(small) <= 250_000 < len(large)
    assert head["stride"] > unpacked(large, "run-0")[0]["stride"] > 1
    cells = cells_of(head, arrays, data["x"].values)
    assert cells.size == head["cells"] < 2 * 20_000 / head["stride"]
    assert np.diff(cells).max() == head["stride"]
    step = head["arrays"]["h"]["step"]
    np.testing.assert_allclose(arrays["h"], data["h"].values[0][:, cells], rtol=0, atol=0.51 * step)


def test_of_a_thinned_run_fronts_and_peaks_stay(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    data = collapse(cells=20_000, snapshots=7)
    for instant in range(7):  # a spike, and a front, each of one cell
        data["h"][0, instant, 1000 + 13 * instant] = 0.3
        data["v"][0, instant, 1500 + 17 * instant] = -40.0
        data["h"][0, instant, 19_001 + 11 * instant] = 0.02
        data["phi"][0, instant, 19_001 + 11 * instant] = 0.5
    whole = written(data, tmp_path)
    head, arrays = unpacked(whole, "run-0")
    cells = cells_of(head, arrays, data["x"].values)
    assert head["stride"] > 5
    for instant in range(7):
        mass = np.flatnonzero(thick(data).values[0, instant])
        expected = (mass[0], mass[-1] - 1 + 1, mass[-1] + 1, 1000 + 13 * instant, 1500 + 17 * instant)
        assert set(expected) <= set(cells.tolist())
        assert arrays["h"][instant].max() == pytest.approx(0.3, rel=1e-4)
        assert np.nanmin(arrays["v"][instant]) == pytest.approx(-40.0, rel=1e-4)
    monkeypatch.setattr(profiles, "AT_ONCE", 1000)
    assert re.sub(r'id="head".*', "", written(data, tmp_path)) == re.sub(r'id="head".*', "", whole)


def test_of_many_samples_the_largest_and_the_least_stay(tmp_path: Path) -> None:
    data = collapse(samples=5000)
    data["h_max"][0, 1234] = 0.7
    data["volume_change"][0, 4321] = -0.5
    head, arrays = unpacked(written(data, tmp_path), "run-0")
    assert 1000 < len(head["series_time"]) < 1020
    assert arrays["h_max"].max() == pytest.approx(0.7)
    assert arrays["volume_change"].min() == pytest.approx(-0.5)
    place = int(arrays["h_max"].argmax())
    assert head["series_time"][place] == data["series_time"].values[1234]
    assert head["thinned"]["samples"] == f"{len(head['series_time'])} of 5000"


@pytest.mark.parametrize("empty", ["time", "series_time"])
def test_files_without_snapshots_or_series_have_a_page(tmp_path: Path, empty: str) -> None:
    data = batch(column__phi=[0.55, 0.58, 0.6]).isel({empty: slice(0)})
    data["status"] = "run", np.zeros(3, dtype=int), {"flag_values": np.array([0]), "flag_meanings": "ok"}
    data.to_netcdf(tmp_path / "a.h5", engine="h5netcdf")
    with xr.open_dataset(tmp_path / "a.h5", engine="h5netcdf") as opened:
        html = written(opened, tmp_path)
    assert [len(unpacked(html, f"run-{run}")[0][empty]) for run in range(3)] == [0, 0, 0]


def test_runs_are_left_out_evenly_where_not_all_fit(tmp_path: Path) -> None:
    data = batch(column__phi=np.linspace(0.55, 0.62, 200))
    html = written(data, tmp_path, max_size=200_000)
    rows = sorted(int(row) for row in re.findall(r'id="run-(\d+)"', html))
    assert len(html) <= 200_000 and 10 < len(rows) < 200
    assert np.diff([*rows, 199]).max() <= 4 * 200 / len(rows)
    head = head_of(html)
    assert (head["shown"], head["rows"], head["runs"]) == (len(rows), 200, 200)
    assert unpacked(html, "table-data")[0]["run"] == list(range(200))


def test_a_page_too_small_for_a_run_is_refused_and_nothing_is_written(tmp_path: Path) -> None:
    with pytest.raises(wg.OptionError, match=r"max-size: 0\.03 MB is too small"):
        page.view(collapse(), tmp_path / "page.html", max_size=30_000)
    assert list(tmp_path.iterdir()) == []


def test_chosen_runs_alone_are_in_the_page(tmp_path: Path) -> None:
    data = batch(column__phi=[0.55, 0.58, 0.6, 0.62])
    html = written(data, tmp_path, runs=[1, 3])
    assert unpacked(html, "table-data")[0]["run"] == [1, 3]
    with pytest.raises(wg.OptionError, match="runs: 7, 9 are in no result"):
        page.view(data, tmp_path / "page.html", runs=[7, 9])


def test_the_table_has_keys_outcomes_failures_and_reserves(tmp_path: Path) -> None:
    data = batch(diverged=(1,), column__phi=[0.55, 0.58, 0.6], rheology__phi_eq=["f0", "f1", "f0"])
    data["outflow_final"][2] = 0.2
    data["failure"] = "run", ["", "diverged at t = 0.4 s", ""]
    table = unpacked(written(data, tmp_path), "table-data")[0]
    columns = {column["name"]: column for column in table["columns"]}
    assert columns["column.phi"]["values"] == [0.55, 0.58, 0.6]
    assert columns["rheology.phi_eq"]["words"] == ["f0", "f1", "f0"]
    np.testing.assert_allclose(columns["run_out"]["values"], data["run_out"].values, rtol=1e-5)
    assert table["status"] == ["ok", "diverged", "ok"]
    assert table["failure"] == {"1": "diverged at t = 0.4 s"}
    assert (table["left_grid"], table["moving"]) == ([2], [])


def test_files_that_differ_in_a_key_have_a_column_of_it(tmp_path: Path) -> None:
    a, b = collapse(), collapse()
    b.attrs["case_toml"] = b.attrs["case_toml"].replace("angle = 22.0", "angle = 10.0")
    table = unpacked(written({"a.h5": a, "b.h5": b}, tmp_path), "table-data")[0]
    (column,) = (column for column in table["columns"] if column["kind"] == "key")
    assert (column["name"], column["values"]) == ("slope.angle", [22.0, 10.0])
    assert table["file"] == [0, 1]


def test_how_results_are_written_out_is_no_parameter(tmp_path: Path) -> None:
    a, b = collapse(), collapse()
    b.attrs["case_toml"] = b.attrs["case_toml"].replace("end = 0.9", "snapshots = { every = 0.1 }\nend = 0.9")
    b.attrs["case_toml"] = b.attrs["case_toml"].replace("gravity = 9.81", 'gravity = 9.81\nbed = "bed.csv"')
    table = unpacked(written({"a.h5": a, "b.h5": b}, tmp_path), "table-data")[0]
    (column,) = (column for column in table["columns"] if column["kind"] == "key")
    assert (column["name"], column["words"]) == ("slope.bed", ["none", "bed.csv"])


def test_rounding_is_no_outcome(tmp_path: Path) -> None:
    data = batch(column__phi=[0.55, 0.6])
    data["dilation_max"][0] = 7e-15
    columns = unpacked(written(data, tmp_path), "table-data")[0]["columns"]
    (values,) = (column["values"] for column in columns if column["name"] == "dilation_max")
    assert values[0] == 0.0 < values[1]


@pytest.mark.slow
def test_a_large_run_is_read_piece_by_piece(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(profiles, "AT_ONCE", 200_000)
    data = collapse(cells=200_000, snapshots=24, samples=5)
    data["failure"] = "run", [""]
    data["status"] = "run", np.array([0]), {"flag_values": np.array([0]), "flag_meanings": "ok"}
    data.to_netcdf(tmp_path / "large.h5", engine="h5netcdf")
    whole = data["h"].nbytes
    del data
    with xr.open_dataset(tmp_path / "large.h5", engine="h5netcdf") as data:
        tracemalloc.start()
        try:
            written(data, tmp_path)
            peak = tracemalloc.get_traced_memory()[1]
        finally:
            tracemalloc.stop()
    assert peak < whole


def test_the_page_forbids_itself_to_load_anything(tmp_path: Path) -> None:
    html = written(collapse(), tmp_path)
    assert "default-src 'none'; script-src 'sha256-" in html
    assert not re.search(r"""(src|href)=|url\(|@import|https?://""", html)


def test_text_of_a_result_is_no_markup(tmp_path: Path) -> None:
    data = collapse()
    data.attrs["case_toml"] = data.attrs["case_toml"].replace("Dense column", "</title><script>bad()</script>")
    html = written({"</script><script>bad()": data}, tmp_path)
    assert "<script>bad" not in html and "bad()" in html


def test_only_a_page_of_warpgran_is_replaced(tmp_path: Path) -> None:
    written(collapse(), tmp_path)
    written(collapse(), tmp_path)
    (tmp_path / "page.html").write_text("a letter")
    with pytest.raises(wg.StorageError, match="was not written by warpgran"):
        page.view(collapse(), tmp_path / "page.html")
    assert (tmp_path / "page.html").read_text() == "a letter"
    with pytest.raises(wg.OptionError, match=r"must end in \.html"):
        page.view(collapse(), tmp_path / "page.txt")


def test_order_of_runs_is_spread_wherever_it_ends() -> None:
    for size in (1, 2, 3, 10, 97):
        order = page._halving(size)
        assert sorted(order) == list(range(size))
        for end in range(2, size):
            assert np.diff(sorted([*order[:end], size - 1])).max(initial=0) <= 4 * size / end
