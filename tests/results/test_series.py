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
    film = small(**{"scheme.h_front": 1.0, "time.series": [0.0, 0.2]})  # nothing is that thick
    assert np.isnan(wg.simulate(film)["volume_change"]).all()
