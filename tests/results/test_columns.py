"""The runs of a file, read without xarray, are those of its Dataset."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import warpgran as wg
from warpgran.analysis.caveats import messages
from warpgran.analysis.run_columns import RunColumns
from warpgran.analysis.summary import summary_columns
from warpgran.case.study import Study
from warpgran.results.columns import opened_columns
from warpgran.results.layout import Layout
from warpgran.results.part_file import PartFile
from warpgran.results.reading import open_dataset
from warpgran.run.options import Options
from warpgran.run.outcome import Outcome, attributes
from warpgran.run.threads import compute
from warpgran.run.to_file import run_to_file

BASE = {"grid": {"right": 0.3, "cells": 50}, "time": {"end": 0.05, "rest_speed": 1e-3}}
SERIES = {"series": {"every": 0.01}}
SWEEPS: dict[str, dict[str, Any]] = {
    "none": {},
    "numbers": {"slope.angle": [0.0, 22.0], "grid.cells": [50, 60], "time.rest_speed": [1e-3, 1.0]},
    "words": {"scheme.left": ["wall", "periodic"], "scheme.right": ["open", "periodic"]},
}


def written(path: Path, keys: dict[str, Any], times: dict[str, Any] = SERIES) -> Path:
    case = wg.Case.from_dict(BASE | {"time": BASE["time"] | times})
    study = case.sweep(keys, mode="zip") if keys else Study(case, {})
    run_to_file(study, path, Options(engine="numpy"))
    return path


@pytest.mark.parametrize("keys", SWEEPS.values(), ids=SWEEPS)
def test_columns_of_a_file_are_those_of_its_dataset(tmp_path: Path, keys: dict[str, Any]) -> None:
    path = written(tmp_path / "a.h5", keys)
    expected = RunColumns.of(open_dataset(path))
    with opened_columns(path) as read:
        for name in ("run", "status", "time", "series_time", "x", "bed"):
            np.testing.assert_array_equal(getattr(read, name), getattr(expected, name), err_msg=name)
        for name in ("swept", "values", "series", "fields"):
            ours, theirs = getattr(read, name), getattr(expected, name)
            assert set(ours) == set(theirs), name
            for each, values in ours.items():
                np.testing.assert_array_equal(values, np.asarray(theirs[each]), err_msg=each)
        for key in ("time.rest_speed", "scheme.left", "slope.angle"):
            np.testing.assert_array_equal(read.parameter(key), expected.parameter(key), err_msg=key)
        assert read.run.size == (2 if keys else 1)
        assert (read.source, messages(read)) == (expected.source, messages(expected))


def test_numbers_of_runs_that_are_not_computed_yet_are_nan_as_in_the_dataset(tmp_path: Path) -> None:
    case = wg.Case.from_dict(BASE | {"time": BASE["time"] | SERIES})
    layout = Layout(case.sweep({"slope.angle": [0.0, 10.0, 22.0]}))
    with PartFile(
        tmp_path / "a.h5.part", layout, layout.attributes(**attributes(Options(engine="numpy"), Outcome()))
    ) as part:
        compute(part, Options(engine="numpy"), [1])
        expected = RunColumns.of(open_dataset(part.path))
        with opened_columns(part.path) as read:
            assert read.status.tolist() == ["pending", "ok", "pending"]
            for name in ("values", "series", "fields"):
                for each, values in getattr(read, name).items():
                    theirs = np.asarray(getattr(expected, name)[each])
                    np.testing.assert_array_equal(np.asarray(values), theirs, err_msg=each)
                    np.testing.assert_array_equal(values[1:, ...], theirs[1:, ...], err_msg=each)
            assert messages(read) == messages(expected)


def test_columns_of_a_file_without_samples_give_a_table(tmp_path: Path) -> None:
    with opened_columns(written(tmp_path / "a.h5", {}, {"series": []})) as read:
        assert messages(read) == ["run 0 had not stopped at the end (1.8 m/s at t = 0.05 s): its run-out is not final"]
        assert np.isnan(summary_columns(read)["run_out"]).all()
