"""Measurements as experiments: a slope each, times of all, and what cannot be compared with the runs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from warpgran.calibration.experiments import read_experiments
from warpgran.case.calibration_section import CalibrationStudy, calibration_of
from warpgran.case.case import Case
from warpgran.case.tables import TableError

PRIOR = {"rheology.mu1": {"low": 0.3, "high": 0.6}}


def study(**section: object) -> CalibrationStudy:
    base = Case.from_dict({"grid": {"cells": 90}, "time": {"end": 1.0}})
    return calibration_of(base, {"over": PRIOR, **section})


def test_each_slope_is_an_experiment_and_all_times_are_output_times(tmp_path: Path) -> None:
    (tmp_path / "profiles.csv").write_text("angle,t,x,h\n22,0.3,0.0,0.1\n10,0.2,0.1,0.1\n22,0.3,0.1,0.05\n")
    (tmp_path / "front.csv").write_text("angle,t,x,sigma\n22,0.1,0.02,0.01\n22,0.5,0.4,0.02\n")
    found = read_experiments(study(), tmp_path)
    assert [(e.name, dict(e.changes)) for e in found.each] == [
        ("10°", {"slope.angle": 10.0}),
        ("22°", {"slope.angle": 22.0}),
    ]
    assert found.value.tolist() == [0.1, 0.1, 0.05, 0.02, 0.4]
    assert [o.kind for _, o in found.observed()] == ["profiles", "profiles", "front"]
    front = found.each[1].observed[1]
    assert front.sigma is not None and front.sigma.tolist() == [0.01, 0.02]
    assert found.base.snapshot_times == (0.2, 0.3)
    assert found.base.sample_times == (0.1, 0.5)
    assert found.base.time.end == 0.5  # no longer than the last measurement


def test_a_deposit_is_a_profile_at_the_end(tmp_path: Path) -> None:
    (tmp_path / "profiles.csv").write_text("angle,t,x,h\n0,0.3,0.0,0.1\n0,inf,0.1,0.1\n")
    found = read_experiments(study(), tmp_path)
    assert found.each[0].observed[0].t.tolist() == [0.3, 1.0]
    assert found.base.snapshot_times == (0.3, 1.0)


def test_folders_of_several_experiments_bring_their_own_keys(tmp_path: Path) -> None:
    for name in ("dense", "loose"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "volume.csv").write_text("angle,t,change\n16,0.3,0.01\n")
    section = [{"data": "dense"}, {"data": "loose", "set": {"column.phi": 0.55}}]
    found = read_experiments(study(experiments=section), tmp_path)
    assert [e.name for e in found.each] == ["dense, 16°", "loose, 16°"]
    assert dict(found.each[1].changes) == {"column.phi": 0.55, "slope.angle": 16.0}


def test_everything_wrong_is_said_at_once(tmp_path: Path) -> None:
    (tmp_path / "profiles.csv").write_text("angle,t,x,h\n0,1.5,0.0,0.1\n0,0.1,9.0,0.1\n")
    (tmp_path / "front.csv").write_text("angle,t,x\n0,0.1,-0.5\n")
    with pytest.raises(TableError) as error:
        read_experiments(study(), tmp_path)
    lines = str(error.value).splitlines()
    assert lines[0].endswith("profiles.csv:2: t = 1.5 is out of range; allowed: <= time.end, which is 1.0")
    assert lines[1].endswith("x = 9.0 is not in the grid; allowed: -0.2 to 1.6 m")
    assert "front.csv:2: x = -0.5 is not in the grid" in lines[2]


def test_sigma_is_given_for_all_experiments_of_a_kind_or_for_none(tmp_path: Path) -> None:
    for name, head, row in (("a", "angle,t,x", "0,0.3,0.01"), ("b", "angle,t,x,sigma", "0,0.3,0.01,0.001")):
        (tmp_path / name).mkdir()
        (tmp_path / name / "front.csv").write_text(f"{head}\n{row}\n")
    with pytest.raises(
        TableError, match=r"some files front\.csv have a column sigma; allowed: in all of them, or in none"
    ):
        read_experiments(study(experiments=[{"data": "a"}, {"data": "b"}]), tmp_path)
    with pytest.raises(TableError, match="is not a folder of measurements"):
        read_experiments(study(experiments=[{"data": "a"}, {"data": "c"}]), tmp_path)


def test_places_in_the_long_vector_follow_each_other(tmp_path: Path) -> None:
    (tmp_path / "front.csv").write_text("angle,t,x\n0,0.1,0.02\n0,0.5,0.4\n5,0.5,0.6\n")
    found = read_experiments(study(), tmp_path)
    assert [(number, where) for number, _, where in found.slices()] == [(0, slice(0, 2)), (1, slice(2, 3))]
    assert np.array_equal(found.value, [0.02, 0.4, 0.6]) and found.size == 3
