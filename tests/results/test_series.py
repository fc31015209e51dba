"""Series: each has a source, and the values that follow from those of the engines."""

from __future__ import annotations

import numpy as np
import pytest
from helpers.cases import small

import warpgran as wg
from warpgran.case.study import Study
from warpgran.results.layout import Layout
from warpgran.schema import SERIES, Variable


def test_a_series_without_a_source_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(SERIES, "h_mean", Variable(("run", "series_time"), "m", "mean thickness"))
    with pytest.raises(NotImplementedError, match="no engine samples the series h_mean"):
        Layout(Study.of([small()]))


def test_front_speed_and_volume_change_follow_from_what_is_sampled() -> None:
    case = small(**{"time.series": {"every": 0.05}})
    one = wg.simulate(case).isel(run=0)
    np.testing.assert_array_equal(one["front_speed"], np.gradient(one["front"], one["series_time"]))
    assert float(one["volume_change"][0]) == pytest.approx(0.0, abs=1e-12)
    assert np.isnan(wg.simulate(small(**{"time.series": [0.2]}))["front_speed"]).all()
    # whose end lies within a cell, and a profile of h and phi, on finer cells at first
    profile = {"x": [-0.2, 0.0, 0.07], "h": [0.1, 0.14, 0.0], "phi": [0.55, 0.62, 0.58]}
    for column in ({"column.length": 0.1234}, {"column": {"profile": profile}}):
        for order in (1, 2):
            case = small(**column, **{"scheme.order": order, "time.series": [0.0, 0.1]})
            change = wg.simulate(case)["volume_change"]
            assert float(change[0, 0]) == pytest.approx(0.0, abs=1e-12)
    film = small(**{"scheme.h_front": 1.0, "time.series": [0.0, 0.2]})  # nothing is that thick
    assert np.isnan(wg.simulate(film)["volume_change"]).all()
