"""The values that a sweep asks for: each mode by hand, and tables of runs."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from helpers.sweeps import ANGLE_AND_PHI, FREE, messages, table, write

from warpgran.case.case import Case, CaseError
from warpgran.case.read_study import read_study

# The modes


def test_product_by_hand() -> None:
    study = Case().sweep(ANGLE_AND_PHI)
    assert study.keys == ("slope.angle", "column.phi")
    assert table(study) == [(0, 0.55), (0, 0.62), (10, 0.55), (10, 0.62), (22, 0.55), (22, 0.62)]
    three = Case().sweep({"scheme.cfl": [0.4, 0.3], "rheology.phi_eq": ["f0", "f1"], "grid.cells": [90, 180, 360]})
    assert three.values("scheme.cfl") == [0.4] * 6 + [0.3] * 6
    assert three.values("rheology.phi_eq") == ["f0", "f0", "f0", "f1", "f1", "f1"] * 2
    assert three.values("grid.cells") == [90, 180, 360] * 4


def test_zip_by_hand() -> None:
    study = Case().sweep({"slope.angle": [0, 10], "grid.right": [0.6, 0.8], "grid.cells": [800, 1000]}, mode="zip")
    assert table(study) == [(0.0, 0.6, 800), (10.0, 0.8, 1000)]
    assert [case.dx for case in study] == pytest.approx([1e-3, 1e-3])


def test_latin_has_one_value_in_each_part_of_a_range() -> None:
    study = Case().sweep(
        {
            "rheology.K": {"low": -0.0, "high": 8.0},
            "rheology.grain_diameter": {"low": 1e-4, "high": 1e-2, "log": True},
        },
        mode="latin",
        samples=16,
    )
    K = np.array(study.values("rheology.K"))
    assert sorted(np.floor(K * 2).tolist()) == list(range(16))
    parts = np.floor(np.log10(np.array(study.values("rheology.grain_diameter")) / 1e-4) * 8)
    assert sorted(parts.tolist()) == list(range(16))


def test_sobol_is_balanced() -> None:
    over = {"slope.angle": {"low": 0, "high": 16}, "column.phi": {"low": 0.5, "high": 0.6}}
    study = Case().sweep(over, mode="sobol", samples=16)
    boxes = {(int(angle // 4), int((phi - 0.5) // 0.025)) for angle, phi in table(study)}
    assert len(boxes) == 16  # one point in each of 4 by 4 boxes


def test_a_range_gives_whole_numbers_for_a_key_of_those() -> None:
    cells = Case().sweep({"grid.cells": {"low": 99.6, "high": 102.4}}, mode="latin", samples=100).values("grid.cells")
    assert {type(value) for value in cells} == {int}
    assert set(cells) == {100, 101, 102}


@pytest.mark.parametrize("mode", ["latin", "sobol"])
def test_the_seed_decides(mode: str) -> None:
    first, again, other = (Case().sweep(FREE, mode=mode, samples=32, seed=seed) for seed in (1, 1, 2))
    assert table(first) == table(again)
    assert table(first) != table(other)
    assert table(Case().sweep(FREE, mode=mode, samples=32)) == table(first)  # 1 is the default
    for K, cells in table(first):
        assert 0.0 <= K <= 8.0
        assert 100 <= cells <= 400


def test_samples_of_a_range_as_wide_as_numbers_allow() -> None:
    over = {"rheology.K": {"low": 0.0, "high": 1e30}}
    values = Case().sweep(over, mode="latin", samples=8).values("rheology.K")
    assert all(math.isfinite(value) for value in values)


# A table of runs

SAMPLES = """\ufeff# drawn elsewhere
slope.angle, "column.phi",grid.cells,rheology.phi_eq,scheme.window

0,0.55,4e2,f1,true
 -22.5 ,0.62, 500 ,f2,False
"""


def test_runs_from_a_table(tmp_path: Path) -> None:
    study = read_study(write(tmp_path, "[sweep]\nfrom = 'samples.csv'\n", SAMPLES.replace('"', "")))
    assert study.keys == ("slope.angle", "column.phi", "grid.cells", "rheology.phi_eq", "scheme.window")
    assert table(study) == [(0.0, 0.55, 400, "f1", True), (-22.5, 0.62, 500, "f2", False)]


@pytest.mark.parametrize(
    ("samples", "wanted"),
    [
        (None, {"sweep.from": r"samples\.csv: cannot be read: No such file"}),
        ("slope.angle\n", {"sweep.from": "has no runs"}),
        ("slope.angel\n3\n", {"sweep.from": r"samples\.csv:1: slope\.angel: unknown key; did you mean slope\.angle\?"}),
        ("time.end\n3\n", {"sweep.from": r"csv:1: time\.end: cannot be swept: all runs .* share"}),
        ("slope.angle,slope.angle\n3,3\n", {"sweep.from": r"csv:1: slope\.angle: is given twice"}),
        ("slope.angle,column.phi\n3,0.5\n\n3\n", {"sweep.from": r"csv:4: has 1 values; allowed: 2"}),
        ("slope.angle\nsteep\n", {"slope.angle": r'"steep" is not a number; .*\(run 0: slope\.angle = "steep"\)'}),
        ("slope.angle\n1_0\n", {"slope.angle": '"1_0" is not a number'}),
        ("slope.angle\nnan\n", {"slope.angle": "nan is not a finite number"}),
        ("grid.cells\n400.5\n", {"grid.cells": "400.5 is not a whole number"}),
        ("scheme.window\nyes\n", {"scheme.window": '"yes" is not true or false'}),
        ("slope.angle\n3\n100\n", {"slope.angle": r"100\.0 is out of range.*\(run 1: slope\.angle = 100\)"}),
    ],
)
def test_tables_that_are_refused(tmp_path: Path, samples: str | None, wanted: dict[str, str]) -> None:
    with pytest.raises(CaseError) as caught:
        read_study(write(tmp_path, "[sweep]\nfrom = 'samples.csv'\n", samples))
    found = messages(caught.value)
    assert found.keys() == wanted.keys()
    for key, words in wanted.items():
        assert re.search(words, found[key])


def test_a_bad_table_is_told_in_a_few_lines(tmp_path: Path) -> None:
    with pytest.raises(CaseError) as caught:
        read_study(write(tmp_path, "[sweep]\nfrom = 'samples.csv'\n", "slope.angle\n" + "1,2\n" * 50))
    assert len(caught.value.problems) == 6
    assert str(caught.value).endswith("and 45 more of this table")
