"""What is refused in a `[sweep]` section."""

import math
import re
from pathlib import Path
from typing import Any

import pytest
from helpers.sweeps import ANGLE_AND_PHI, FREE, messages, refused, write

from warpgran.case.case import CaseError
from warpgran.case.read_study import read_study


@pytest.mark.parametrize(
    ("over", "options", "key", "words"),
    [
        ({}, {}, "sweep.over", "names no key"),
        ({"slope.angle": []}, {}, "sweep.over.slope.angle", "has no values"),
        ({"slope.angle": 3}, {}, "sweep.over.slope.angle", "3 is not a list; allowed: a list of values, or"),
        ({"slope.angle": "3"}, {}, "sweep.over.slope.angle", '"3" is not a list'),
        ({"slope.angle": [[3]]}, {}, "sweep.over.slope.angle[0]", "[3] is not a number, a word"),
        ({"slope.angle": [1, None]}, {}, "sweep.over.slope.angle[1]", "None is not a number, a word"),
        ({"slope.angel": [3]}, {}, "sweep.over.slope.angel", "unknown key; did you mean slope.angle?"),
        ({"angle": [3]}, {}, "sweep.over.angle", "did you mean slope.angle?"),
        ({"grids": {"left": [3]}}, {}, "sweep.over.grids.left", "did you mean grid.left or scheme.left?"),
        ({"slope": [3]}, {}, "sweep.over.slope", "cannot be swept: it holds no single number or word"),
        ({"title": ["a"]}, {}, "sweep.over.title", "cannot be swept: it is that of the whole file"),
        ({"time.end": [1, 2]}, {}, "sweep.over.time.end", "share their output times"),
        ({"time.snapshots": [[1], [2]]}, {}, "sweep.over.time.snapshots", "share their output times"),
        ({"time.series.every": [0.1]}, {}, "sweep.over.time.series.every", "share their output times"),
        ({"slope.bed": ["a.csv"]}, {}, "sweep.over.slope.bed", "cannot be swept: it holds no single"),
        ({"column.profile": ["a.csv"]}, {}, "sweep.over.column.profile", "cannot be swept: it holds no single"),
        ({"scheme.xi": [[1, 1, 1]]}, {}, "sweep.over.scheme.xi", "cannot be swept: it holds no single"),
        (ANGLE_AND_PHI, {"mode": "random"}, "sweep.mode", '"random" is not known; allowed: "product", "zip", "latin"'),
        (ANGLE_AND_PHI, {"mode": "zip"}, "sweep.over", "one length: slope.angle has 3, column.phi has 2"),
        (ANGLE_AND_PHI, {"samples": 6}, "sweep.samples", "has no part in mode product"),
        (FREE, {"mode": "latin"}, "sweep.samples", "is missing: mode latin needs"),
        (FREE, {"mode": "sobol", "samples": 100}, "sweep.samples", "100 is no power of 2, .*; the next is 128"),
        (FREE, {"mode": "latin", "samples": 0}, "sweep.samples", "0 is out of range; allowed: >= 1"),
        (FREE, {"mode": "latin", "samples": 1_000_001}, "sweep.samples", "out of range"),
        (FREE, {"mode": "latin", "samples": 4.0}, "sweep.samples", "not a whole number"),
        (FREE, {"mode": "latin", "samples": 4, "seed": -1}, "sweep.seed", "-1 is out of range; allowed: >= 0"),
        ({"slope.angle": {"low": 0, "high": 1}}, {}, "sweep.over.slope.angle", "is a range; allowed in mode product"),
        ({"slope.angle": {"low": 0}}, {}, "sweep.over.slope.angle.high", "is missing"),
        ({"slope.angle": {"low": 0, "hihg": 3, "high": 3}}, {}, "sweep.over.slope.angle.hihg", "angle.high?"),
        ({"slope.angle": {"low": 0, "high": "x"}}, {}, "sweep.over.slope.angle.high", '"x" is not a number'),
        ({"slope.angle": {"low": 0, "high": math.inf}}, {}, "sweep.over.slope.angle.high", "not a finite number"),
        (
            {"slope.angle": [0, 1]},
            {"mode": "latin", "samples": 4},
            "sweep.over.slope.angle",
            "is a list; allowed in mode latin: { low = , high = }",
        ),
        (
            {"slope.angle": {"low": 3, "high": 3}},
            {"mode": "latin", "samples": 4},
            "sweep.over.slope.angle.low",
            "3.0 is out of range; allowed: < high",
        ),
        (
            {"slope.angle": {"low": 0, "high": 3, "log": True}},
            {"mode": "latin", "samples": 4},
            "sweep.over.slope.angle.low",
            "0.0 is out of range; allowed with log: > 0",
        ),
        (
            {"rheology.phi_eq": {"low": 0, "high": 3}},
            {"mode": "latin", "samples": 4},
            "sweep.over.rheology.phi_eq",
            "holds no number",
        ),
        (
            {"slope.angle": [0] * 1001, "column.phi": [0.5] * 1000},
            {},
            "sweep.over",
            "asks for 1001000 runs; allowed: 1000000",
        ),
    ],
)
def test_sections_that_are_refused(over: Any, options: dict[str, Any], key: str, words: str) -> None:
    found = refused(over, **options)
    assert found.keys() == {key}
    assert re.search(re.escape(words).replace(r"\.\*", ".*"), found[key])


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("sweep = 3", {"sweep": "3 is not a table of keys"}),
        ("[sweep]", {"sweep.over": "names no key"}),
        ("[sweep]\nover = 3", {"sweep.over": "3 is not a table of keys"}),
        ("[sweep]\nmoed = 'zip'", {"sweep.moed": "unknown key; did you mean sweep.mode?"}),
        ("[sweep]\nfrom = 3", {"sweep.from": "3 is not text; allowed: the path of a CSV file"}),
        (
            "[sweep]\nfrom = 'a.csv'\nmode = 'zip'\nsamples = 3\nover = {'slope.angle' = [1]}",
            dict.fromkeys(("sweep.mode", "sweep.samples", "sweep.over"), "has no part beside sweep.from"),
        ),
        (
            "[sweep.over]\n'slope.angle' = [1]\nslope.angle = [2]",
            {"sweep.over.slope.angle": "is given twice"},
        ),
    ],
)
def test_files_that_are_refused(tmp_path: Path, text: str, wanted: dict[str, str]) -> None:
    with pytest.raises(CaseError) as caught:
        read_study(write(tmp_path, text))
    found = messages(caught.value)
    assert found.keys() == wanted.keys()
    for key, words in wanted.items():
        assert words in found[key]
