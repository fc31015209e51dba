"""A case on several grids: what is compared, what is refused, and that the command says it."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from helpers.cases import small
from typer.testing import CliRunner

import warpgran as wg
from warpgran.analysis.refinement import Refined
from warpgran.cli.app import app
from warpgran.studies.converge import Convergence, converge

CHANGES: dict[str, Any] = {"grid.cells": 100, "time.end": 0.3, "time.snapshots": [0.0, 0.1, 0.3]}


@pytest.fixture(scope="module")
def found() -> Convergence:
    return converge(small(**CHANGES))


def test_each_grid_is_the_run_that_it_would_be_alone(found: Convergence) -> None:
    assert found.cells == (50, 100, 200)
    alone = wg.simulate(small(**CHANGES, **{"time.series": [0.0, 0.1, 0.3]})).isel(run=0)
    front = alone["front"].values
    by_name = {quantity.name: quantity.values[1] for quantity in found.quantities}
    assert by_name["run-out"] == by_name["front at 0.3 s"] == front[2] - front[0]
    assert by_name["front at 0.1 s"] == front[1] - front[0]
    assert by_name["final height"] == alone["h_max"].values[-1]
    assert by_name["dilation"] == alone["volume_change"].values.max()
    assert "front at 0 s" not in by_name  # it has gone no way yet
    assert "stop time" not in by_name  # it still moves


def test_the_table_has_a_row_a_quantity() -> None:
    cells = (50, 100, 200)
    known = Refined("height", cells, tuple(2.0 + 10.0 / n for n in cells))
    lost = Refined("front", cells, (1.0, 1.1, 1.2))
    found = Convergence(small(**CHANGES), (known, lost))
    table = found.table()
    assert list(table.columns) == [50, 100, 200, "order", "limit", "error", "cells_1_percent"]
    assert table.loc["height", 100] == 2.1
    assert table.loc["height", ["order", "limit", "error"]].tolist() == pytest.approx([1.0, 2.0, 0.05])
    assert table.loc["height", "cells_1_percent"] == 500.0
    assert table.loc["front", ["order", "limit", "error", "cells_1_percent"]].isna().all()
    assert "1 % of what shows a limit from 500 cells" in found.verdict()
    assert "extrapolated" in found.verdict()
    assert "no limit in sight on these grids: front" in found.verdict()


def test_the_figure_has_a_line_a_quantity(found: Convergence, tmp_path: Path) -> None:
    figure = found.plot(tmp_path / "errors.png")
    lines = [line for line in figure.axes[0].lines if not str(line.get_label()).startswith("_")]
    names = [str(line.get_label()).splitlines()[0].strip() for line in lines]
    assert names == [quantity.name for quantity in found.quantities]
    assert all(line.get_xdata() == pytest.approx(found.cells) for line in lines)
    assert (tmp_path / "errors.png").stat().st_size > 10_000
    with pytest.raises(wg.OptionError, match="must end in"):
        found.plot(tmp_path / "errors.doc")


def test_a_stop_time_is_compared_where_every_run_stops() -> None:
    times = {"time.end": 1.0, "time.snapshots": [1.0], "time.series": {"every": 0.01}}
    case = small(**{**CHANGES, **times, "slope.angle": 0.0})
    assert "stop time" in [quantity.name for quantity in converge(case).quantities]


def test_a_limit_that_is_none_of_the_collapse_is_told_with_its_reserve(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    told = "3 of 3 runs left the grid (0, 1, 2; up to "
    with pytest.warns(wg.CaveatWarning, match=re.escape(told)):
        found = converge(small(**CHANGES, **{"grid.right": 0.1}))
    assert told in found.reserves[0]
    done = run(tmp_path, monkeypatch, text=RUN_FILE.replace("right = 0.6", "right = 0.1"))
    assert done.exit_code == 0 and f"warpgran: {told}" in done.stderr
    assert "CaveatWarning" not in done.output


def test_what_cannot_be_refined_is_refused() -> None:
    with pytest.raises(wg.CaseError, match=r"grid.cells: 101 is odd"):
        converge(small(**{"grid.cells": 101}))
    for levels in (2, 7):
        with pytest.raises(wg.OptionError, match="levels"):
            converge(small(), levels=levels)
    with pytest.raises(wg.ResultError, match="100 cells: step_limit"):
        converge(small(**CHANGES, **{"time.step_limit": 20}))


RUN_FILE = """
[slope]
angle = 22.0
[grid]
right = 0.6
cells = 100
[time]
end = 0.2
snapshots = [0.2]
"""


def run(folder: Path, monkeypatch: pytest.MonkeyPatch, *arguments: str, text: str = RUN_FILE) -> Any:
    monkeypatch.chdir(folder)
    (folder / "case.toml").write_text(text)
    return CliRunner().invoke(app, ["converge", "case.toml", *arguments])


def test_the_command_prints_draws_and_writes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    done = run(tmp_path, monkeypatch, "--levels", "4", "--csv", "table.csv")
    assert done.exit_code == 0, done.output
    assert "run-out (m)" in done.output
    assert "1 % of" in done.output or "no limit" in done.output
    assert "wrote case_convergence.png and table.csv" in done.output
    assert (tmp_path / "case_convergence.png").stat().st_size > 10_000
    table = pd.read_csv(tmp_path / "table.csv", index_col="quantity")
    assert list(table.columns[:4]) == ["50", "100", "200", "400"]
    assert np.isfinite(table.loc["final height", "400"])


def test_the_command_refuses_a_sweep(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    done = run(tmp_path, monkeypatch, text=RUN_FILE + '[sweep.over]\n"column.phi" = [0.55, 0.62]\n')
    assert done.exit_code == 2
    assert "is a sweep of 2 runs" in done.output
