"""What a run comes to."""

from __future__ import annotations

import numpy as np
import pytest
from helpers.collapses import by_hand

from warpgran.analysis.run_values import final_values, run_values, stop_time

nan = np.nan


def test_values_of_each_run_follow_from_its_series() -> None:
    data = by_hand()
    series = {name: data[name].values for name in ("front", "h_max", "volume_change", "v_flow")}
    found = run_values(data["series_time"].values, series, np.full(3, 1e-3))
    expected = {
        "run_out": [0.4, 0.2, nan],
        "dilation_max": [0.05, 0.0, nan],
        "stop_time": [0.2, nan, nan],
    }
    assert found.keys() == expected.keys()
    for name, values in expected.items():
        np.testing.assert_allclose(found[name], values, atol=1e-15)


def test_final_values_are_those_of_the_end_or_the_last_that_were_reached() -> None:
    series = {name: np.array([[1.0, 2.0], [3.0, np.inf], [nan, nan]]) for name in ("h_max", "v_flow", "outflow")}
    found = final_values(series, {name: np.array([[5.0], [nan], [nan]]) for name in series})
    assert set(found) == {"h_max_final", "v_flow_final", "outflow_final"}
    for values in found.values():
        np.testing.assert_equal(values, [5.0, 3.0, nan])


def test_without_samples_nothing_is_known() -> None:
    series = dict.fromkeys(("front", "h_max", "volume_change", "v_flow"), np.zeros((2, 0)))
    found = run_values(np.zeros(0), series, np.full(2, 1e-3))
    assert all(np.isnan(values).all() and values.shape == (2,) for values in found.values())


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
