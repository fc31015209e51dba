"""Folders of measurements: what is read of the three files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from warpgran.case.measurements import read_measurements
from warpgran.case.tables import TableError


def test_files_are_read_with_their_places_deposits_and_sigma(tmp_path: Path) -> None:
    (tmp_path / "profiles.csv").write_text(
        "sigma,x,h,t,angle\n# by hand\n0.001,0.1,0.05,0.3,22\n0.002,0.4,0.02,inf,22\n"
    )
    (tmp_path / "front.csv").write_text("angle,t,x\n22,0.1,0.05\n")
    tables = read_measurements(tmp_path)
    profiles = tables["profiles"]
    assert profiles.columns["t"].tolist() == [0.3, np.inf]
    assert profiles.columns["sigma"].tolist() == [0.001, 0.002]
    assert profiles.places == (f"{tmp_path}/profiles.csv:3", f"{tmp_path}/profiles.csv:4")
    assert tables.keys() == {"profiles", "front"}
    assert tables["front"].columns.keys() == {"angle", "t", "x"}


def test_noise_may_make_a_thickness_negative_where_its_size_is_given(tmp_path: Path) -> None:
    (tmp_path / "profiles.csv").write_text("angle,t,x,h,sigma\n22,0.3,0.1,-0.003,0.001\n")
    assert read_measurements(tmp_path)["profiles"].columns["h"].tolist() == [-0.003]
    (tmp_path / "profiles.csv").write_text("angle,t,x,h,sigma\n22,0.3,0.1,-0.006,0.001\n")
    with pytest.raises(TableError, match=r"h = -0\.006 is out of range; allowed: >= -0\.005"):
        read_measurements(tmp_path)
