"""The model as a function: what is predicted of runs, and points that cannot be run."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest

from warpgran.calibration.experiments import Experiments, read_experiments
from warpgran.calibration.forward import Forward
from warpgran.case.calibration_section import calibration_of
from warpgran.case.case import Case
from warpgran.case.problems import CaseError
from warpgran.files import StorageError
from warpgran.run.options import Options
from warpgran.run.simulate import simulate

NAMES = ("rheology.mu1", "rheology.K")
THETA = np.array([[0.4, 2.0], [0.9, 2.0], [0.5, 6.0]])  # mu1 > mu2 in the second


@pytest.fixture
def experiments(tmp_path: Path) -> Experiments:
    """Two slopes, the second of a loose column, with measurements of all kinds."""
    for name in ("dense", "loose"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "front.csv").write_text("angle,t,x\n5,0.1,0.05\n5,0.2,0.1\n")
    (tmp_path / "dense" / "profiles.csv").write_text(
        "angle,t,x,h\n5,0.1,-0.11,0.1\n5,0.2,0.013,0.1\n5,0.1,0.2,0.0\n5,0.1,-0.2,0.1\n"
    )
    (tmp_path / "dense" / "volume.csv").write_text("angle,t,change\n5,0.15,0.01\n")
    base = Case.from_dict({"grid": {"left": -0.2, "right": 0.4, "cells": 40}, "time": {"end": 0.3}})
    over = {name: {"low": 0.1, "high": 0.7} for name in NAMES}
    several = [{"data": "dense"}, {"data": "loose", "set": {"column.phi": 0.55}}]
    return read_experiments(calibration_of(base, {"over": over, "experiments": several}), tmp_path)


def expected(experiments: Experiments, point: np.ndarray) -> list[float]:
    """The predictions of one point, by hand."""
    found: list[float] = []
    for experiment in experiments.each:
        case = experiments.base.with_(**experiment.changes, **dict(zip(NAMES, point.tolist(), strict=True)))
        run = simulate(case).isel(run=0)
        times, samples = run["time"].values.tolist(), run["series_time"].values.tolist()
        for o in experiment.observed:
            for t, x in zip(o.t.tolist(), o.x.tolist(), strict=True):
                if o.kind == "profiles":
                    found.append(float(np.interp(x, run["x"].values, run["h"].values[times.index(t)])))
                else:
                    name = "front" if o.kind == "front" else "volume_change"
                    found.append(float(run[name].values[samples.index(t)]))
    return found


def test_predictions_are_those_of_single_runs(experiments: Experiments) -> None:
    forward = Forward(experiments, NAMES, Options())
    found = forward(THETA)
    assert found.shape == (3, experiments.size)
    assert np.isnan(found[1]).all()
    for i in (0, 2):
        assert found[i] == pytest.approx(expected(experiments, THETA[i]), rel=1e-12)
    assert (forward.tally.runs, forward.tally.refused) == (4, 2)


def test_batches_larger_than_the_memory_are_cut(experiments: Experiments, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = Forward(experiments, NAMES, Options())(THETA)
    monkeypatch.setattr("warpgran.calibration.forward.MOST_BYTES", 1)
    assert np.array_equal(Forward(experiments, NAMES, Options())(THETA), whole, equal_nan=True)


def test_a_failed_run_has_no_prediction_and_is_counted(experiments: Experiments) -> None:
    stopped = Experiments(experiments.base.with_(**{"time.step_limit": 3}), experiments.each)
    forward = Forward(stopped, NAMES, Options())
    assert np.isnan(forward(THETA[:1])).all()
    assert dict(forward.tally.ended) == {"step_limit": 2}


def test_kept_runs_are_not_computed_again(experiments: Experiments, tmp_path: Path) -> None:
    first = Forward(experiments, NAMES, Options())
    found, data = first.kept(THETA, tmp_path / "runs.h5")
    again = Forward(experiments, NAMES, Options())
    kept, _ = again.kept(THETA, tmp_path / "runs.h5")
    assert np.array_equal(found, kept, equal_nan=True)
    assert np.array_equal(found, first(THETA), equal_nan=True)
    assert data.sizes["run"] == 4 and again.tally.runs == 0
    with pytest.raises(CaseError, match="mu2"):
        again.kept(THETA[1:2], tmp_path / "none.h5")


def test_kept_runs_that_are_damaged_are_told(experiments: Experiments, tmp_path: Path) -> None:
    path = tmp_path / "runs.h5"
    Forward(experiments, NAMES, Options()).kept(THETA, path)
    with h5py.File(path) as file:
        chunk = file["h"].id.get_chunk_info(0)
    data = bytearray(path.read_bytes())
    data[chunk.byte_offset : chunk.byte_offset + chunk.size] = bytes(chunk.size)
    path.write_bytes(data)
    with pytest.raises(StorageError, match=r"runs\.h5 is damaged, or no result; remove it first"):
        Forward(experiments, NAMES, Options()).kept(THETA, path)
