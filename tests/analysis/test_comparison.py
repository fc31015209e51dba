"""Two results against each other."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr
from helpers.collapses import CASE, collapse, two_runs, with_values

import warpgran as wg
from warpgran.analysis.comparison import Compared, compare
from warpgran.analysis.differences import VALUES, common_times
from warpgran.schema import FIELDS, SERIES


def row(compared: Compared, quantity: str, run: int = 0) -> Any:
    rows = compared.differences
    [found] = rows[(rows["quantity"] == quantity) & (rows["run_a"] == run)].itertuples(index=False)
    return found


def at_angles(*angles: float) -> xr.Dataset:
    """A run an angle, whose front is as many metres farther as the angle has degrees."""
    data = collapse(runs=len(angles)).assign_coords({"slope.angle": ("run", list(angles))})
    way = np.outer(angles, np.linspace(0.0, 1.0, data.sizes["series_time"]))
    data["front"] = data["front"] + xr.DataArray(way, dims=("run", "series_time"))
    return with_values(data)


def test_a_result_is_identical_to_itself() -> None:
    compared = compare(two_runs(), two_runs())
    assert compared.identical
    assert compared.parameters.empty
    assert compared.facts.empty
    assert compared.runs["identical"].all()
    assert set(compared.differences["quantity"]) == {*VALUES, *SERIES, *FIELDS}
    assert compared.differences["identical"].all()
    assert (compared.differences["difference"].fillna(0.0) == 0.0).all()
    assert np.isnan(row(compared, "stop_time", run=1).difference)  # as it is in both


@pytest.mark.parametrize("name", ["h", "v", "phi", "front", "run_out", "bed"])
def test_one_bit_makes_results_differ(name: str) -> None:
    a, b = collapse(), collapse()
    values = b[name].values.copy()
    values.flat[-1] = np.nextafter(values.flat[-1], 1.0)
    b[name] = b[name].dims, values
    compared = compare(a, b)
    assert not compared.identical
    assert compared.differences.query("not identical")["quantity"].tolist() == ([] if name == "bed" else [name])


def test_minus_zero_is_another_zero() -> None:
    a, b = collapse(), collapse()
    b["h"] = b["h"].dims, np.where(b["h"].values == 0.0, -0.0, b["h"].values)
    compared = compare(a, b)
    assert not compared.identical
    assert row(compared, "h").difference == 0.0


def test_a_key_with_the_same_values_in_other_runs_differs() -> None:
    a, b = (at_angles(0.0, 10.0).assign_coords({"column.phi": ("run", phi)}) for phi in ([0.55, 0.62], [0.62, 0.55]))
    compared = compare(a, b)
    assert compared.parameters.loc["column.phi"].tolist() == [
        "2 values, 0.55 to 0.62", "2 values, 0.55 to 0.62, in other runs"
    ]  # fmt: skip
    assert list(compared.parameters.index) == ["column.phi"]


def test_the_largest_difference_is_where_and_when_it_is() -> None:
    a, b = collapse(), collapse()
    h, front = b["h"].values.copy(), b["front"].values.copy()
    h[0, 2, 30] -= 0.25
    h[0, 1, 50] += 0.125
    front[0, 40] += 0.5
    b["h"], b["front"] = (b["h"].dims, h), (b["front"].dims, front)
    compared = compare(a, b)
    found = row(compared, "h")
    assert (found.time, found.x) == (float(a["time"][2]), float(a["x"][30]))
    assert (found.a, found.b) == (float(a["h"][0, 2, 30]), float(b["h"][0, 2, 30]))
    assert found.difference == pytest.approx(-0.25)
    found = row(compared, "front")
    assert (found.time, found.difference) == (float(a["series_time"][40]), pytest.approx(0.5))
    assert np.isnan(found.x)


def test_v_and_phi_are_compared_where_both_flow_and_h_everywhere() -> None:
    a, b = collapse(), collapse()
    for name in ("h", "v", "phi"):
        values = b[name].values.copy()
        values[0, 0, -1] += 1e-4  # beyond the front, thinner than h_front = 1.4 mm
        b[name] = b[name].dims, values
    compared = compare(a, b)
    assert row(compared, "h").difference == pytest.approx(1e-4)
    assert row(compared, "v").difference == row(compared, "phi").difference == 0.0
    assert not compared.identical


def test_parameters_and_facts_that_differ_are_named() -> None:
    a, b = collapse(), collapse()
    a.attrs |= {"precision": "float64", "engine": "warp", "device": "cpu"}
    text = CASE.replace("angle = 22.0", "angle = 16.0").replace("h_min = 3.5e-3\n", "")
    b.attrs = {"case_toml": text, "precision": "float32", "engine": "warp", "device": "cpu"}
    compared = compare(a, b)
    assert compared.identical  # parameters are no results
    assert compared.parameters.to_dict("index") == {
        "slope.angle": {"a": 22.0, "b": 16.0},
        "scheme.h_min": {"a": 3.5e-3, "b": None},
    }
    assert compared.facts.to_dict("index") == {"precision": {"a": "float64", "b": "float32"}}


def test_swept_values_match_the_runs_whatever_their_numbers() -> None:
    a, b = at_angles(0.0, 10.0, 22.0), at_angles(22.0, 10.0, 5.0)
    compared = compare(a, b)
    assert compared.runs[["run_a", "run_b", "slope.angle"]].to_numpy().tolist() == [[1, 1, 10.0], [2, 0, 22.0]]
    assert compared.runs["identical"].all()
    assert not compared.identical  # for one run of either stands alone
    assert compared.notes == (
        "2 pairs of runs, matched by slope.angle",
        "1 runs of a have no counterpart",
        "1 runs of b have no counterpart",
    )
    assert compared.parameters.loc["slope.angle"].tolist() == ["3 values, 0 to 22", "3 values, 5 to 22"]
    assert compare(a, a.isel(run=[2, 0, 1])).identical


def test_a_run_is_matched_with_that_of_a_sweep_at_its_angle() -> None:
    one, sweep = collapse(), at_angles(0.0, 22.0)
    assert compare(one, sweep).runs[["run_a", "run_b"]].to_numpy().tolist() == [[0, 1]]


def test_runs_without_common_values_are_matched_by_number() -> None:
    compared = compare(at_angles(0.0, 10.0, 22.0), at_angles(1.0, 13.0, 22.5))
    assert compared.notes == ("3 pairs of runs, matched by number",)
    over = compared.over_runs().loc["run_out"]
    assert over["runs"] == (1, 0, 2)
    assert [over[name] for name in ("median", "largest", "difference")] == pytest.approx([1.0, 3.0, 3.0])
    assert over["b"] - over["a"] == pytest.approx(3.0)
    assert compared.over_runs().loc["mass", "runs"] == ()


def test_without_any_pair_there_is_nothing_to_compare() -> None:
    a = at_angles(0.0, 10.0)
    with pytest.raises(wg.ResultError, match="no run of one result has a counterpart"):
        compare(a, at_angles(1.0, 11.0).assign_coords(run=[7, 8]))
    with pytest.raises(wg.ResultError, match=r"data\.isel\(run=\[0\]\)"):
        compare(a, a.isel(run=0))


def on_grid(cells: int, slope: float, right: float = 1.0) -> xr.Dataset:
    """A thickness that is linear in x, at all times."""
    data = collapse(cells=cells)
    x = -0.2 + (right + 0.2) * (np.arange(cells) + 0.5) / cells
    h = np.broadcast_to(slope * (x + 0.2), data["h"].shape)
    return data.assign_coords(x=x).assign(h=(data["h"].dims, h.copy()))


@pytest.mark.parametrize(("cells", "right"), [((60, 240), 1.0), ((240, 60), 1.0), ((240, 120), 0.4)])
def test_other_grids_are_compared_on_the_coarser(cells: tuple[int, int], right: float) -> None:
    """Linear interpolation is exact for what is linear in x, so that the difference is that of the slopes."""
    a, b = on_grid(cells[0], 0.5), on_grid(cells[1], 0.75, right)
    compared = compare(a, b)
    assert not compared.identical
    assert compared.notes == ("the grids differ: h, v and phi are interpolated linearly onto the coarser",)
    found, coarse = row(compared, "h"), (a if cells[0] < cells[1] else b)["x"].values
    inside = coarse[(coarse <= a["x"].values[-1] + 1e-9) & (coarse <= b["x"].values[-1] + 1e-9)]
    if right == 0.4:  # cells of 5 mm in both: those of b
        assert inside.size == 120
    assert found.x == inside[-1]
    assert found.difference == pytest.approx(0.25 * (found.x + 0.2), abs=1e-12)


def test_batches_of_different_grids_are_compared_cell_by_cell_of_each_run() -> None:
    case = wg.Case().with_(**{"grid.cells": 60, "grid.right": 0.4, "time.end": 0.02, "scheme.h_min": 0.01})
    sweep = case.sweep({"grid.cells": [60, 80], "slope.angle": [10.0, 20.0]})
    with pytest.warns(wg.CaveatWarning):
        a, b = wg.simulate(sweep), wg.simulate(case.sweep({"grid.cells": [80, 60], "slope.angle": [10.0, 20.0]}))
    assert "cell" in a.dims
    assert compare(a, b).identical
    assert compare(a, b).runs["run_b"].tolist() == [2, 3, 0, 1]


def test_times_that_both_have_are_compared_but_for_rounding() -> None:
    a = np.array([0.0, 0.1, 0.2, 0.3, 0.9])
    b = np.array([0.0, 0.15, 0.1 + 0.2, 0.4, 0.45, 0.9])
    of_a, of_b = common_times(a, b)
    assert of_a.tolist() == [0, 3, 4]
    assert of_b.tolist() == [0, 2, 5]
    assert [at.size for at in common_times(a, b[:0])] == [at.size for at in common_times(a[:0], b)] == [0, 0]


def test_results_at_other_times_say_how_many_are_compared() -> None:
    a, b = collapse(snapshots=4, samples=91), collapse(snapshots=7, samples=46)
    compared = compare(a, b)
    assert compared.notes == (
        "4 snapshots at times that both have, of 4 in a and 7 in b",
        "46 samples at times that both have, of 91 in a and 46 in b",
    )
    assert not compared.identical
    assert abs(row(compared, "front").difference) < 1e-12


def test_a_run_that_diverged_is_compared_as_far_as_both_got() -> None:
    a, b = two_runs(), two_runs()
    for name in ("h", "front"):
        values = b[name].values.copy()
        values[1, 3:] = np.nan
        b[name] = b[name].dims, values
    b["status"] = "run", np.array([1, 1]), b["status"].attrs
    compared = compare(a, b)
    assert compared.runs["status_b"].tolist() == ["diverged", "diverged"]
    assert compared.runs["identical"].tolist() == [False, False]
    assert row(compared, "h", run=0).identical
    assert not row(compared, "h", run=1).identical
    assert row(compared, "h", run=1).difference == 0.0


def test_results_without_series_or_snapshots_have_nothing_to_be_compared_of_them() -> None:
    compared = compare(collapse(samples=0, snapshots=0), collapse(samples=0, snapshots=0))
    assert compared.identical
    assert np.isnan(row(compared, "front").difference)
    assert np.isnan(row(compared, "h").difference)


def test_profiles_are_read_in_groups_of_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    a, b = at_angles(0.0, 10.0, 22.0), at_angles(22.0, 10.0, 0.0)
    b["h"] = b["h"] * xr.DataArray([1.0, 1.0, 1.5], dims="run")
    whole = compare(a, b).differences
    monkeypatch.setattr("warpgran.analysis.differences.GROUP", 1)
    assert compare(a, b).differences.equals(whole)
    assert (whole.query("quantity == 'h'")["difference"] > 0.0).tolist() == [True, False, False]
