"""What is allowed but unlikely, and that it is said once, with place and value."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest
from helpers.places import ROOT

import warpgran as wg
from warpgran.case.case import Case
from warpgran.case.read_study import read_study
from warpgran.case.sampled_runs import sampled_runs
from warpgran.case.study import Study
from warpgran.case.unlikely import unlikely

WALLS = {"scheme.left": "wall", "scheme.right": "wall"}
PLANE = {"slope.bed": {"x": [-0.2, 1.6], "b": [0.0, -1.8 * math.tan(math.radians(30))]}}


def told(**changes: Any) -> list[str]:
    return unlikely(Study.of([Case().with_(**changes)]))


@pytest.mark.parametrize("path", sorted((ROOT / "runs").rglob("*.toml")), ids=lambda path: path.stem)
def test_the_run_files_here_are_likely(path: Path) -> None:
    assert unlikely(read_study(path)) == []


@pytest.mark.parametrize(
    ("likely", "not_likely", "words"),
    [
        (
            {"slope.bed": {"x": [-0.2, 1.6], "b": [0.0, 0.31]}},
            PLANE,
            "slope.bed: is 30 degrees steep against the plane at x = ",
        ),
        (
            {"slope.bed": {"x": [0.0, 0.5, 2.5], "b": [0.0, 0.0, 0.18]}},
            {"slope.bed": {"x": [0.0, 0.5, 2.5], "b": [0.0, 0.0, 0.22]}},
            "slope.bed: is bent at x = 0.5005 m: its slope changes by 0.11 over the height of the column",
        ),
        (
            {"rheology.grain_diameter": 0.0139},
            {"rheology.grain_diameter": 0.7},
            "rheology.grain_diameter: 0.7 is more than a tenth of the column's height, 0.14",
        ),
        (
            {"grid.cells": 180},
            {"grid.cells": 90},
            "grid.cells: 90 put 10 cells in the column's length and 7 in its height, "
            "and run-outs are off by up to a cell; likely: 20 and 5 or more, with 180",
        ),
        (  # a landslide: on its length there are cells enough
            {"column.height": 0.008, "grid.cells": 1125},
            {"column.height": 0.008, "grid.cells": 900},
            "grid.cells: 900 put 100 cells in the column's length and 4 in its height, and run-outs are off by up to a",
        ),
        (
            {"slope.angle": 1.0},
            {"slope.angle": -0.38},
            "slope.angle: -0.38 is less than a degree; likely: degrees, and -0.38 radians are -21.8",
        ),
        (
            {"rheology.mu1": 0.9, "rheology.mu2": 2.0},
            {"rheology.mu1": 25.6, "rheology.mu2": 36.0},
            "rheology.mu1: 25.6 is the friction of no grains; likely: a coefficient below 1, "
            "and the tangent of 25.6 degrees is 0.479",
        ),
        (
            {"column.height": 0.6},
            {"column.height": 0.61},
            "column.height: 0.61 is tall for a length of 0.2 m: the model is shallow",
        ),
        (
            {"column.start": 0.2, "column.height": 0.3},
            {"column.start": 0.2, "column.height": 0.31},
            "column.height: 0.31 is tall for a length of 0.2 m, half of it to each side: the model is shallow",
        ),
        (
            {"time.step_limit": 5000},
            {"time.step_limit": 4000},
            "time.step_limit: 4000 is reached before time.end; likely: more than 4.69e+03, what its waves take",
        ),
    ],
)
def test_what_is_unlikely_is_told(likely: dict[str, Any], not_likely: dict[str, Any], words: str) -> None:
    assert told(**likely) == []
    (line,) = told(**not_likely)
    assert line.startswith(words)


def test_a_mass_between_walls_has_no_length_to_be_tall_for() -> None:
    filled = {"grid.left": 0.0, "grid.right": 0.2, "grid.cells": 200, "column.height": 1.0}
    assert told(**filled, **WALLS) == []
    assert told(**filled, **dict.fromkeys(WALLS, "periodic")) == []
    assert len(told(**filled)) == 1


def test_a_batch_is_told_once() -> None:
    study = Case().sweep({"rheology.grain_diameter": [7e-4, 0.02, 0.03], "column.phi": [0.55, 0.62]})
    (line,) = unlikely(study)
    assert line.endswith("(4 of 6 runs, the first is run 2: rheology.grain_diameter = 0.02, column.phi = 0.55)")
    (line,) = unlikely(Case().sweep({"slope.angle": [0.1, 0.2]}))
    assert line.endswith("(all 2 runs)")
    assert unlikely(Case().sweep({"slope.angle": [0.1, 0.2, 3.0]})) == []
    assert unlikely(Case().sweep({"slope.angle": [0.0, 0.2, 3.0]})) == []
    (line,) = unlikely(Case().sweep({"slope.angle": [0.0, 0.17, 0.38]}))
    assert line.startswith("slope.angle: 0.17 is less than a degree")


def test_of_a_large_study_the_ends_and_some_runs_between_are_examined() -> None:
    columns: dict[str, list[Any]] = {
        "slope.angle": [5.0] * 70 + [40.0] + [6.0] * 900,
        "rheology.phi_eq": ["f1"] * 970 + ["f2"],
    }
    runs = sampled_runs(columns, 971, 10)
    assert {0, 70, 970} <= set(runs)
    assert len(runs) <= 14
    assert sampled_runs(columns, 971, 971) == list(range(971))


def test_a_steep_plane_given_as_a_bed_runs_a_third_too_far() -> None:
    """A sliding block is accelerated by g (tan theta - mu) in place of cos^2 theta of that: 4/3 at 30 degrees."""
    theta, t = math.radians(30.0), 1.2
    block: dict[str, Any] = {
        "rheology.mu2": 0.48, "rheology.K": 0.0, "column.height": 0.02, "column.length": 1.0, "column.start": 0.5,
        "grid.left": 0.0, "grid.right": 5.0, "grid.cells": 500, "time.end": t, "time.snapshots": [0.0, t],
        "scheme.left": "open",
    }  # fmt: skip
    by_angle = Case().with_(**block, **{"slope.angle": 30.0})
    by_bed = Case().with_(**block, **{"slope.bed": {"x": [0.0, 5.0], "b": [0.0, -5.0 * math.tan(theta)]}})

    def way(case: Case) -> float:
        data = wg.simulate(case).isel(run=0)
        solid = data["h"] * data["phi"]
        centre = (solid * data["x"]).sum("x") / solid.sum("x")
        return float(centre[1] - centre[0]) * math.cos(math.radians(case.slope.angle))

    assert way(by_bed) / way(by_angle) == pytest.approx(4 / 3, abs=0.01)
    assert unlikely(Study.of([by_angle])) == [line for line in unlikely(Study.of([by_bed])) if "slope.bed" not in line]


def test_simulate_warns(recwarn: pytest.WarningsRecorder) -> None:
    case = Case().with_(**{"grid.right": 0.1, "grid.cells": 20, "time.end": 0.3, "time.snapshots": []})
    with pytest.warns(wg.CaveatWarning) as caught:
        wg.simulate(case)
    lines = [str(warning.message) for warning in caught if warning.category is wg.CaveatWarning]
    assert [line.split()[0] for line in lines] == ["grid.cells:", "run", "run"]
    assert "lost solid through an end of the grid" in lines[1]
    assert "had not stopped" in lines[2]
