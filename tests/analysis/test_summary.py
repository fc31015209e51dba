"""The table with a row a run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from helpers.collapses import batch, collapse, two_runs
from rich.console import Console

from warpgran.analysis.summary import summary, swept, write_csv
from warpgran.cli.table import rich_table
from warpgran.files import StorageError

nan = np.nan


def by_hand() -> xr.Dataset:
    """Three runs of four samples: one to the end, one that diverged, one that has nothing."""
    series = {
        "front": [[0.0, 0.2, 0.5, 0.4], [0.1, 0.3, nan, nan], [nan] * 4],
        "h_max": [[0.14, 0.12, 0.1, 0.09], [0.14, 0.2, np.inf, nan], [nan] * 4],
        "volume_change": [[0.0, 0.05, 0.04, -0.01], [0.0, -0.1, np.inf, nan], [nan] * 4],
    }
    variables: dict[str, Any] = {name: (("run", "sample"), np.array(values)) for name, values in series.items()}
    flags = {"flag_values": np.array([0, 1, 3]), "flag_meanings": "ok diverged interrupted"}
    variables |= {
        "status": ("run", np.array([0, 1, 3]), flags),
        "steps": ("run", np.array([900, 70, 0])),
        "end_time": ("run", np.array([0.3, 0.14, 0.0])),
        "stop_time": ("run", np.array([0.2, nan, nan])),
    }
    coordinates = {"slope.angle": ("run", [0.0, 10.0, 22.0]), "rheology.phi_eq": ("run", np.array(["f0", "f1", "f2"]))}
    return xr.Dataset(variables, {"run": [4, 5, 6], **coordinates})


def printed(frame: pd.DataFrame, **options: Any) -> list[str]:
    """The lines of the printed table, without what fills them up."""
    console = Console(width=options.get("width", 100))
    with console.capture() as capture:
        console.print(rich_table(frame, **options))
    return [line.rstrip() for line in capture.get().splitlines()]


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
    path.write_text("old")

    def half(frame: pd.DataFrame, part: Path, **options: Any) -> None:
        part.write_text("half")
        raise OSError("disk full")

    monkeypatch.setattr(pd.DataFrame, "to_csv", half)
    with pytest.raises(OSError, match="disk full"):
        write_csv(summary(by_hand()), path)
    assert path.read_text() == "old"
    assert [path] == list(tmp_path.iterdir())
    with pytest.raises(StorageError, match="absent"):
        write_csv(summary(by_hand()), tmp_path / "absent" / "summary.csv")


def test_table_says_lengths_in_cm_and_changes_in_percent() -> None:
    lines = printed(summary(by_hand()))
    assert lines[0].split() == "run slope. rheology. status end steps run-out front max h dilation volume stop".split()
    assert lines[1].split() == "angle phi_eq (s) (cm) (cm) (cm) (%) (%) (s)".split()
    assert lines[2].split() == "4 0 f0 ok 0.3 900 40.00 40.00 9.00 +5.00 -1.00 0.2".split()
    assert lines[3].split() == "5 10 f1 diverged 0.14 70 20.00 30.00 20.00 +0.00 -10.00 -".split()
    assert lines[4].split() == "6 22 f2 interrupted 0 0 - - - - - -".split()
    assert lines[5] == "1 ok, 1 diverged, 1 interrupted"


def test_table_says_long_lengths_in_m_and_stands_a_run_that_blew_up() -> None:
    frame = summary(batch(slope__angle=[0.0, 1.0, 2.0]))
    frame["front"] = [1.5, 2.25, 1e30]
    frame["h_max"] = [0.1, 0.2, 1e30]
    lines = [line.split() for line in printed(frame)]
    front, h_max = lines[0].index("front"), lines[0].index("max")
    assert [line[front] for line in lines[2:5]] == ["1.500", "2.250", "1e+30"]
    assert [line[h_max] for line in lines[2:5]] == ["10.00", "20.00", "1e+32"]


@pytest.mark.parametrize(("limit", "first", "last"), [(5, 3, 2), (2, 1, 1), (1, 1, 0)])
def test_table_leaves_out_the_runs_in_the_middle(limit: int, first: int, last: int) -> None:
    lines = printed(summary(batch(slope__angle=np.arange(50.0))), limit=limit)
    numbers = [line.split()[0] for line in lines[2:-1]]
    assert numbers == [*map(str, range(first)), *["..."] * bool(last), *map(str, range(50 - last, 50))]
    assert lines[-1] == f"{50 - limit} of 50 runs are left out"


@pytest.mark.parametrize("width", [80, 100])
def test_table_fits_and_names_what_it_leaves_out(width: int) -> None:
    keys: dict[str, Any] = {f"rheology__key_{n}": np.linspace(0.1234, 9.0, 3) for n in range(8)}
    lines = printed(summary(batch(**keys)), width=width)
    assert max(map(len, lines)) <= width
    assert "…" not in " ".join(lines)
    note = " ".join(" ".join(lines[5:]).split())
    assert note.startswith("without end_time, steps, run_out, rheology.key_7")
    assert note.endswith(", for want of room")
    shown = lines[0].split().count("rheology.")
    assert 0 < shown == 8 - note.count("rheology.")
