"""The summary as the terminal shows it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
import pytest
from helpers.collapses import batch, by_hand
from rich.console import Console

from warpgran.analysis.summary import summary
from warpgran.cli.table import rich_table


def printed(frame: pd.DataFrame, **options: Any) -> list[str]:
    """The lines of the printed table, without what fills them up."""
    console = Console(width=options.get("width", 100))
    with console.capture() as capture:
        console.print(rich_table(frame, **options))
    return [line.rstrip() for line in capture.get().splitlines()]


def test_table_says_lengths_in_cm_and_changes_in_percent() -> None:
    lines = printed(summary(by_hand()))
    assert lines[0].split() == "run slope. rheology. status end steps run-out front max h dilation volume stop".split()
    assert lines[1].split() == "angle phi_eq (s) (cm) (cm) (cm) (%) (%) (s)".split()
    assert lines[2].split() == "4 0 f0 ok 0.3 900 40.00 40.00 9.00 +5.00 -1.00 0.2".split()
    assert lines[3].split() == "5 10 f1 diverged 0.14 70 >20.00 >30.00 20.00 +0.00 -10.00 -".split()
    assert lines[4].split() == "6 22 f2 interrupted 0 0 - - - - - -".split()
    assert lines[5:] == ["1 ok, 1 diverged, 1 interrupted", "> a lower bound: solid has left the grid"]


def test_table_marks_what_holds_with_a_reserve() -> None:
    frame = summary(batch(slope__angle=[0.0, 1.0, 2.0, 3.0]))
    frame["left_grid"] = [False, True, False, True]
    frame["moving"] = [False, False, True, True]
    lines = [line.split() for line in printed(frame)]
    assert [line[5][0] + line[6][0] for line in lines[2:6]] == ["00", ">>", "~~", ">>"]
    assert [line[-1] for line in lines[2:6]] == ["0.6", "0.6", "moving", "moving"]
    assert printed(frame)[6:] == ["> a lower bound: solid has left the grid", "~ not final: the flow had not stopped"]


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


def test_rounding_below_zero_is_no_negative_zero() -> None:
    frame = summary(batch(slope__angle=np.arange(2.0)))
    frame["dilation_max"] = -7.8e-16
    assert printed(frame)[2].split()[-3] == "+0.00"


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


def test_keys_that_follow_others_make_room_first() -> None:
    keys: dict[str, Any] = {"slope__angle": [0.0, 10.0], "rheology__K": [0.0, 4.09], "column__phi": [0.55, 0.62]}
    frame = summary(batch(**keys, time__rest_speed=[1.17e-3, 1.16e-3]))
    wide, narrow = printed(frame, width=200), printed(frame, width=100)
    assert "rest_speed" in " ".join(wide)
    assert narrow[-1].startswith("without time.rest_speed")
    assert "run-out" in " ".join(narrow)


@pytest.mark.parametrize(
    ("factor", "units", "cells"),
    [
        (1.0, ["(cm)", "(cm)", "(cm)"], ["48.00", "40.00", "5.25"]),
        (0.01, ["(mm)", "(mm)", "(mm)"], ["4.80", "4.00", "0.53"]),
        (100.0, ["(m)", "(m)", "(m)"], ["48.000", "40.000", "5.250"]),
        (2e4, ["(km)", "(km)", "(m)"], ["9.600", "8.000", "1050.000"]),
    ],
)
def test_a_length_is_printed_in_the_unit_of_its_column(factor: float, units: list[str], cells: list[str]) -> None:
    frame = summary(batch(slope__angle=[0.0, 0.0, 0.0]))
    frame["run_out"], frame["front"], frame["h_max"] = 0.48 * factor, 0.4 * factor, 0.0525 * factor
    heads, first = (line.split() for line in printed(frame)[1:3])
    assert [unit for unit in heads if unit in ("(km)", "(m)", "(cm)", "(mm)")] == units
    assert first[5:8] == cells


def test_runs_of_very_different_size_share_the_unit_of_their_column() -> None:
    frame = summary(batch(slope__angle=[0.0, 0.0, 0.0]))
    frame["h_max"] = [0.004, 2.0, 30.0]
    lines = [line.split() for line in printed(frame)]
    assert [line[7] for line in lines[2:5]] == ["0.004", "2.000", "30.000"]
