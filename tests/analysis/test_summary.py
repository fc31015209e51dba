"""The table with a row a run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from helpers.collapses import by_hand, collapse, two_runs

from warpgran.analysis.runs import swept
from warpgran.analysis.summary import summary, write_csv
from warpgran.files import StorageError

nan = np.nan


def test_summary_has_a_row_a_run() -> None:
    expected: dict[str, list[Any]] = {
        "run": [4, 5, 6],
        "slope.angle": [0.0, 10.0, 22.0],
        "rheology.phi_eq": ["f0", "f1", "f2"],
        "status": ["ok", "diverged", "interrupted"],
        "end_time": [0.3, 0.14, 0.0],
        "steps": [900, 70, 0],
        "run_out": [0.4, 0.2, nan],
        "front": [0.4, 0.3, nan],
        "h_max": [0.09, 0.2, nan],
        "dilation_max": [0.05, 0.0, nan],
        "volume_change": [-0.01, -0.1, nan],
        "stop_time": [0.2, nan, nan],
        "left_grid": [False, True, False],
        "moving": [False, False, False],
    }
    frame = summary(by_hand())
    assert list(frame.columns) == list(expected)
    for name, values in expected.items():
        if isinstance(values[0], str):
            assert frame[name].tolist() == values
        else:
            np.testing.assert_allclose(frame[name], values, atol=1e-15)


def test_summary_of_a_selection_keeps_the_numbers_of_its_runs() -> None:
    assert summary(by_hand().isel(run=[2, 0]))["run"].tolist() == [6, 4]
    with pytest.raises(ValueError, match=r"data\.isel\(run=\[0\]\)"):
        summary(by_hand().isel(run=0))


def test_summary_without_samples_is_unknown() -> None:
    frame = summary(collapse(samples=0, runs=2))
    assert frame[["run_out", "front", "h_max", "dilation_max", "volume_change"]].isna().all(axis=None)
    assert frame["status"].tolist() == ["ok", "ok"]


def test_swept_keys_are_the_dotted_coordinates_of_the_runs() -> None:
    data = two_runs().assign_coords({"scheme.cfl": 0.4, "label": ("run", [1, 2])})
    assert swept(data) == ["slope.angle", "column.length"]


def test_csv_is_what_pandas_reads_back(tmp_path: Path) -> None:
    frame = summary(by_hand())
    path = write_csv(frame, tmp_path / "summary.csv")
    assert [path] == list(tmp_path.iterdir())
    assert path.read_text().splitlines()[0].startswith("run,slope.angle,rheology.phi_eq,status,end_time,steps,run_out,")
    pd.testing.assert_frame_equal(pd.read_csv(path), frame, check_dtype=False)


def test_csv_that_fails_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "summary.csv"
    path.write_text("run,status,end_time,old")

    def half(frame: pd.DataFrame, part: Path, **options: Any) -> None:
        part.write_text("half")
        raise OSError("disk full")

    monkeypatch.setattr(pd.DataFrame, "to_csv", half)
    with pytest.raises(OSError, match="disk full"):
        write_csv(summary(by_hand()), path)
    assert path.read_text() == "run,status,end_time,old"
    assert [path] == list(tmp_path.iterdir())
    with pytest.raises(StorageError, match="absent"):
        write_csv(summary(by_hand()), tmp_path / "absent" / "summary.csv")
