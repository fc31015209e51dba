"""Sweeps: the runs that each mode makes, what is refused, and the identity of a case."""

import copy
import math
import pickle
import re
import sys
import tracemalloc
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from warpgran.case import Case, CaseError
from warpgran.sweep import KINDS, Study, identity, read_study, sweep

RUNS = Path(__file__).parent.parent / "runs"
ANGLE_AND_PHI = {"slope.angle": [0, 10, 22], "column.phi": [0.55, 0.62]}
FREE = {"rheology.K": {"low": 0.0, "high": 8.0}, "grid.cells": {"low": 100, "high": 400}}


@pytest.fixture
def write(tmp_path: Path) -> Callable[..., Path]:
    def write_file(text: str, samples: str | None = None) -> Path:
        (tmp_path / "a.toml").write_text(text, encoding="utf-8")
        if samples is not None:
            (tmp_path / "samples.csv").write_text(samples, encoding="utf-8")
        return tmp_path / "a.toml"

    return write_file


def refused(over: Any, **options: Any) -> dict[str, str]:
    """Messages by key; each key at most once."""
    with pytest.raises(CaseError) as caught:
        Case().sweep(over, **options)
    return messages(caught.value)


def messages(error: CaseError) -> dict[str, str]:
    found = {problem.key: problem.message for problem in error.problems}
    assert len(found) == len(error.problems)
    return found


def table(study: Study) -> list[tuple[Any, ...]]:
    return list(zip(*(study.values(key) for key in study.keys), strict=True))


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
    over = {"rheology.K": {"low": 0.0, "high": sys.float_info.max}}
    values = Case().sweep(over, mode="latin", samples=8).values("rheology.K")
    assert all(math.isfinite(value) for value in values)


@pytest.mark.parametrize("key", [key for key, kind in KINDS.items() if kind in (float, int)])
def test_every_number_can_be_swept(key: str) -> None:
    value = Case().flat()[key]
    assert [case.flat()[key] for case in Case().sweep({key: [value, value]})] == [value, value]


@pytest.mark.parametrize(
    ("key", "values"),
    [
        ("rheology.phi_eq", ["f0", "f1", "f2"]),
        ("scheme.viscosity", ["bounded", "paper"]),
        ("scheme.left", ["wall", "open"]),
        ("scheme.window", [True, False]),
        ("scheme.lambda", [0.0, 0.5]),
        ("column.start", [0.0, 0.5]),
        ("scheme.h_min", [1e-4, 1e-3]),
        ("time.step_limit", [10, 10**30]),
        ("slope.angle", np.linspace(0.0, 22.0, 3)),
        ("slope.angle", (np.float64(0.0), np.int64(2))),
        ("grid.cells", range(100, 103)),
    ],
)
def test_what_else_can_be_swept(key: str, values: Sequence[Any]) -> None:
    study = Case().sweep({key: values})
    assert study.values(key) == list(values)
    assert [case.flat()[key] for case in study] == list(values)


# A study as a sequence


def test_a_study_is_a_sequence_of_cases() -> None:
    case = Case().with_(title="x")
    study = case.sweep(ANGLE_AND_PHI)
    wanted = [case.with_(**{"slope.angle": angle, "column.phi": phi}) for angle, phi in table(study)]
    assert len(study) == 6
    assert list(study) == wanted
    assert (study[0], study[5], study[-1], study[np.int64(2)]) == (wanted[0], wanted[5], wanted[5], wanted[2])
    assert study[1:3] == wanted[1:3]
    assert study[::-1] == wanted[::-1]
    assert study.base == study[0]
    assert study.given == ()
    assert study.base.title == "x"
    for i in (6, -7):
        with pytest.raises(IndexError):
            study[i]
    with pytest.raises(KeyError):
        study.values("rheology.K")
    assert repr(study) == "<Study of 6 runs over slope.angle, column.phi>"
    assert table(sweep(case, ANGLE_AND_PHI)) == table(study)
    for same in (pickle.loads(pickle.dumps(study)), copy.deepcopy(study)):
        assert list(same) == wanted


def test_values_are_those_in_force() -> None:
    study = Case().sweep({"slope.angle": [0, 10]})
    assert [type(value) for value in study.values("slope.angle")] == [float, float]


def test_keys_that_only_together_make_a_case() -> None:
    study = Case().sweep({"grid.left": [1.0, 2.0], "grid.right": [3.0, 4.0]}, mode="zip")
    assert [case.column_start for case in study] == [1.0, 2.0]
    study = Case().sweep({"rheology.mu1": [0.8], "rheology.mu2": [0.9]})  # each alone is out of range or fits no run
    assert study.base.rheology.mu1 == 0.8


def test_a_study_of_given_cases() -> None:
    base = Case()
    cases = [
        base.with_(**{"slope.angle": 3.0, "rheology.phi_eq": "f1", "scheme.xi": [1, 1, 1]}),
        base.with_(**{"grid.cells": 90, "slope.bed": {"x": [0, 1], "b": [0, 1]}, "title": "x"}),
    ]
    study = Study.of(cases)
    assert study.keys == ("rheology.phi_eq", "slope.angle", "grid.cells")
    assert table(study) == [("f1", 3.0, 1800), ("f2", 0.0, 90)]
    assert (study[1], study[-2], study.base, len(study)) == (cases[1], cases[0], cases[0], 2)
    assert study.given == tuple(cases)
    assert study.identity(1) == identity(cases[1])
    assert Study.of(study) is study
    assert (len(Study.of([base, base])), Study.of([base, base]).keys) == (2, ())
    profiled = base.with_(**{"column.profile": {"x": [0, 1], "h": [1, 1]}})
    assert Study.of([base, profiled]).keys == ()  # what has no part in one of them is no value
    with pytest.raises(ValueError, match="at least one case"):
        Study.of([])


def test_a_study_holds_no_cases() -> None:
    tracemalloc.start()
    try:
        study = Case().sweep({"slope.angle": {"low": 0, "high": 22}}, mode="latin", samples=2000)
        before, _ = tracemalloc.get_traced_memory()
        small = Case().sweep({"slope.angle": {"low": 0, "high": 22}}, mode="latin", samples=1000)
        after, _ = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert len(study) + len(small) == 3000
    assert after - before < 100 * 1000  # a case takes some 5000 bytes
    assert study[0] is not study[0]


# Run files


def test_a_file_without_a_sweep_is_a_study_of_one(write: Callable[..., Path]) -> None:
    path = write("title = 'x'\n[slope]\nangle = 3\n")
    study = read_study(path, ["column.phi=0.5"])
    assert (len(study), study.keys, repr(study)) == (1, (), "<Study of 1 run>")
    assert study[0] == study.base == Case.from_toml(path, ["column.phi=0.5"])
    assert (study.source, study.folder) == (path.read_text(), path.parent)
    with pytest.raises(CaseError, match=r"a\.toml: slope\.angle: 100 is out of range"):
        read_study(path, ["slope.angle=100"])


def test_a_sweep_is_no_case_and_says_what_reads_it(write: Callable[..., Path]) -> None:
    with pytest.raises(CaseError, match=r"sweep: is a sweep of several runs.*warpgran\.read_study"):
        Case.from_toml(write("[sweep.over]\n'slope.angle' = [1, 2]\n"))


@pytest.mark.parametrize(
    "keys", ['"slope.angle" = [0, 3]\n"column.phi" = [0.5]', "slope.angle = [0, 3]\ncolumn.phi = [0.5]"]
)
def test_keys_with_and_without_quotes(write: Callable[..., Path], keys: str) -> None:
    path = write(f"title = 'x'\n[slope]\nangle = 7\n[sweep.over]\n{keys}\n")
    study = read_study(path)
    assert table(study) == [(0.0, 0.5), (3.0, 0.5)]
    assert (study[1].source, study[1].folder, study[1].title) == (path.read_text(), path.parent, "x")


@pytest.mark.parametrize(
    ("overrides", "wanted"),
    [
        (["sweep.mode=zip"], [(0, 0.5), (3, 0.6)]),
        (["sweep.over.slope.angle=[5]"], [(5, 0.5), (5, 0.6)]),
        (['sweep.over."slope.angle"=[5]'], [(5, 0.5), (5, 0.6)]),
        (["sweep.over={'slope.angle'=[5], 'column.phi'=[0.4]}"], [(5, 0.4)]),
        (
            [
                "sweep.mode=sobol",
                "sweep.samples=1",
                "sweep.over.slope.angle={low=5, high=5.0000001}",
                "sweep.over.column.phi.low=0.4",
                "sweep.over.column.phi.high=0.4000001",
            ],
            [(5, 0.4)],
        ),
        (["slope.gravity=1.6"], [(0, 0.5), (0, 0.6), (3, 0.5), (3, 0.6)]),
    ],
)
def test_overrides(write: Callable[..., Path], overrides: list[str], wanted: list[tuple[float, float]]) -> None:
    path = write('[sweep.over]\n"slope.angle" = [0, 3]\n"column.phi" = [0.5, 0.6]\n')
    study = read_study(path, overrides)
    assert np.array(table(study)) == pytest.approx(np.array(wanted), rel=1e-6)


def test_an_override_makes_a_sweep_and_may_not_be_undone_by_one(write: Callable[..., Path]) -> None:
    path = write("")
    assert read_study(path, ["sweep.over.slope.angle=[0, 3]"]).values("slope.angle") == [0.0, 3.0]
    with pytest.raises(CaseError) as caught:
        read_study(path, ["sweep.over.slope.angle=[0, 3]", "slope.angle=2"])
    assert messages(caught.value) == {
        "slope.angle": "the sweep varies it and would undo this override; set sweep.over.slope.angle instead"
    }


def test_tables_are_found_beside_the_run_file(write: Callable[..., Path]) -> None:
    path = write('[slope]\nbed = "bed.csv"\n[sweep.over]\n"slope.angle" = [0, 3]\n')
    (path.parent / "bed.csv").write_text("x,b\n0,0\n1,0.5\n")
    study = read_study(path)
    (path.parent / "bed.csv").unlink()
    assert [case.bed[-1] for case in study] == [0.5, 0.5]
    with pytest.raises(CaseError) as caught:
        read_study(path, ["scheme.cfl=3"])
    assert messages(caught.value).keys() == {"slope.bed", "scheme.cfl"}  # once, not for every run


# A table of runs

SAMPLES = """\ufeff# drawn elsewhere
slope.angle, "column.phi",grid.cells,rheology.phi_eq,scheme.window

0,0.55,4e2,f1,true
 -22.5 ,0.62, 500 ,f2,False
"""


def test_runs_from_a_table(write: Callable[..., Path]) -> None:
    study = read_study(write("[sweep]\nfrom = 'samples.csv'\n", SAMPLES.replace('"', "")))
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
def test_tables_that_are_refused(write: Callable[..., Path], samples: str | None, wanted: dict[str, str]) -> None:
    with pytest.raises(CaseError) as caught:
        read_study(write("[sweep]\nfrom = 'samples.csv'\n", samples))
    found = messages(caught.value)
    assert found.keys() == wanted.keys()
    for key, words in wanted.items():
        assert re.search(words, found[key])


def test_a_bad_table_is_told_in_a_few_lines(write: Callable[..., Path]) -> None:
    with pytest.raises(CaseError) as caught:
        read_study(write("[sweep]\nfrom = 'samples.csv'\n", "slope.angle\n" + "1,2\n" * 50))
    assert len(caught.value.problems) == 6
    assert str(caught.value).endswith("and 45 more of this table")


# What is refused in the section


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
def test_files_that_are_refused(write: Callable[..., Path], text: str, wanted: dict[str, str]) -> None:
    with pytest.raises(CaseError) as caught:
        read_study(write(text))
    found = messages(caught.value)
    assert found.keys() == wanted.keys()
    for key, words in wanted.items():
        assert words in found[key]


# What is refused in the runs


def test_a_bad_run_is_told_with_its_number_and_values() -> None:
    assert refused({"slope.angle": [0, 100], "column.phi": [0.5, 0.6]}) == {
        "slope.angle": "100 is out of range; allowed: >= -80 and <= 80, in degrees "
        "(2 runs, the first is run 2: slope.angle = 100, column.phi = 0.5)"
    }
    assert refused({"rheology.phi_eq": ["f1", "f3"], "grid.cells": [100.0, 100]}, mode="zip") == {
        "rheology.phi_eq": '"f3" is not known; allowed: "f0", "f1" or "f2" '
        '(run 1: rheology.phi_eq = "f3", grid.cells = 100)',
        "grid.cells": "100.0 is not a whole number; allowed: >= 4 and <= 10000000 "
        '(run 0: rheology.phi_eq = "f1", grid.cells = 100)',
    }
    assert refused({"slope.angle": [10**400]}).keys() == {"slope.angle"}


def test_runs_whose_keys_do_not_fit_each_other() -> None:
    found = refused({"rheology.mu1": [0.3, 0.8, 0.9], "rheology.mu2": [0.5, 0.7, 1.0]}, mode="zip")
    assert found.keys() == {"rheology.mu2"}
    assert found["rheology.mu2"].endswith("(run 1: rheology.mu1 = 0.8, rheology.mu2 = 0.7)")


def test_many_bad_runs_are_a_few_lines_and_a_count() -> None:
    with pytest.raises(CaseError) as caught:
        Case().sweep({"column.phi": [0.5, *np.linspace(1.0, 2.0, 100)]})
    problems = caught.value.problems
    assert [problem.key for problem in problems] == ["column.phi"] * 5 + [""]
    assert problems[4].message.endswith("(run 5: column.phi = 1.0404)")
    assert problems[5].message == "and 95 more like these; 100 of 101 runs cannot be run"


def test_all_errors_at_once(write: Callable[..., Path]) -> None:
    path = write("""
        [slope]
        angle = 200                    # checked, though every run has its own
        bed = "missing.csv"
        [rheology]
        mu1 = 0.8
        [scheme]
        cfl = 3
        [sweep.over]
        "slope.angle" = [0, 10]
        "rheology.mu2" = [0.5, 0.9]    # and the default of mu2 is never used
    """)
    with pytest.raises(CaseError) as caught:
        read_study(path, ["nonsense"])
    assert all(line.startswith(f"{path}: ") for line in str(caught.value).splitlines())
    assert [problem.key for problem in caught.value.problems] == [
        "", "slope.bed", "slope.angle", "scheme.cfl", "rheology.mu2"
    ]  # fmt: skip
    with pytest.raises(CaseError) as caught:
        read_study(path, ["sweep.mode=zap", "rheology.K=-1"])
    assert {problem.key for problem in caught.value.problems} == {
        "sweep.mode", "slope.bed", "slope.angle", "scheme.cfl", "rheology.K"
    }  # fmt: skip


# Identity

RESULT_CHANGES: dict[str, Any] = {
    "slope.angle": 1e-9,
    "rheology.phi_eq": "f1",
    "grid.cells": 1801,
    "grid.right": 1.7,
    "column.start": 0.0,
    "time.end": 1.9,
    "time.snapshots": [0.5],
    "time.series": {"every": 0.02},
    "time.rest_speed": 2e-3,
    "time.step_limit": 100,
    "scheme.h_min": 1e-3,
    "scheme.lambda": 0.5,
    "scheme.xi": [2, 2, 4],
    "scheme.right": "wall",
    "slope.bed": {"x": [0, 1], "b": [0, 1]},
    "column.profile": {"x": [0, 1], "h": [1, 1]},
}
NO_CHANGES: dict[str, Any] = {
    "title": "x",
    "scheme.window": False,
    "slope.angle": -0.0,
    "column.start": -0.2,
    "scheme.h_min": 7e-4,
    "time.snapshots": [0.36, 0.72, 1.08, 1.44, 1.8],
    "time.series": [k / 100 for k in range(181)],
    "scheme.xi": [2, 2, 5],
}


@pytest.mark.parametrize(("key", "value"), RESULT_CHANGES.items())
def test_what_changes_a_result_changes_its_identity(key: str, value: Any) -> None:
    assert identity(Case().with_(**{key: value})) != identity(Case())


@pytest.mark.parametrize(("key", "value"), NO_CHANGES.items())
def test_what_changes_no_result_leaves_its_identity(key: str, value: Any) -> None:
    assert identity(Case().with_(**{key: value})) == identity(Case())


def test_identities_differ_from_each_other() -> None:
    identities = {identity(Case().with_(**{key: value})) for key, value in RESULT_CHANGES.items()}
    assert len(identities) == len(RESULT_CHANGES)
    assert all(re.fullmatch("[0-9a-f]{16}", each) for each in identities)


def test_every_key_but_two_is_part_of_the_identity() -> None:
    others: dict[type, Callable[[Any], Any]] = {
        float: lambda value: value * (1.0 - 1e-6) if value else 1e-6,
        int: lambda value: value - 1,
        bool: lambda value: not value,
    }
    words = {"phi_eq": "f0", "relaxation": "exponential", "viscosity": "paper", "left": "open", "right": "wall"}
    for key, kind in KINDS.items():
        value = Case().flat()[key]
        other = words[key.rpartition(".")[2]] if kind is str else others[kind](value)
        if key == "column.start":
            other = 0.1
        same = identity(Case().with_(**{key: other})) == identity(Case())
        assert same == (key == "scheme.window"), key


def test_tables_count_by_their_numbers(tmp_path: Path) -> None:
    for name, b in (("a", "0.5"), ("b", "0.5"), ("c", "0.6")):
        (tmp_path / f"{name}.csv").write_text(f"x,b\n0,0\n1,{b}\n")
    of = {name: identity(Case.from_dict({"slope": {"bed": f"{name}.csv"}}, tmp_path)) for name in "abc"}
    assert of["a"] == of["b"] == identity(Case().with_(**{"slope.bed": {"x": [0, 1], "b": [0, 0.5]}}))
    assert of["a"] != of["c"]
    profile = {"x": [0.0, 0.4], "h": [0.1, 0.2]}
    first, second = (Case().with_(**{"column.profile": {**profile, "phi": [phi, 0.6]}}) for phi in (0.5, 0.51))
    assert len({identity(first), identity(second), identity(Case().with_(**{"column.profile": profile}))}) == 3


def test_the_identity_of_a_run_is_that_of_its_case(write: Callable[..., Path]) -> None:
    path = write('[sweep.over]\n"slope.angle" = [0, 3]\n"column.phi" = [0.5, 0.6]\n')
    study = read_study(path)
    assert [study.identity(i) for i in range(4)] == [identity(case) for case in study]
    assert study.identity(2) == identity(Case().with_(**{"slope.angle": 3.0, "column.phi": 0.5}))
    longer = read_study(path, ["sweep.over.slope.angle=[3, 4, 5]"])
    assert longer.identity(0) == study.identity(2)  # whatever its number
    assert len({study.identity(i) for i in range(4)}) == 4


# The sweeps that come with the project


@pytest.mark.parametrize("path", sorted(RUNS.glob("sweep_*.toml")), ids=lambda path: path.stem)
def test_sweep_files_load(path: Path) -> None:
    study = read_study(path)
    assert len(study) > 1
    assert study.keys
    assert study.base.title


def test_the_angles_and_packings_are_the_papers() -> None:
    study = read_study(RUNS / "sweep_angle_phi.toml")
    assert table(study) == [(angle, phi) for angle in (0, 10, 16, 22) for phi in (0.55, 0.62)]
    assert {case.rheology.K for case in study} == {4.09}
    assert study[7] == Case.from_toml(RUNS / "dense_22deg.toml").with_(title=study.base.title)


def test_the_latin_sweep_is_of_256_coarse_runs() -> None:
    study = read_study(RUNS / "sweep_latin.toml")
    assert (len(study), study.base.grid.cells, len(study.base.sample_times)) == (256, 500, 181)
    assert study.keys == ("rheology.mu1", "rheology.K", "column.phi", "slope.angle")
