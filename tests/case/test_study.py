"""Studies: their cases, how they are read from a run file, and runs that are refused."""

import copy
import math
import pickle
import tracemalloc
from array import array
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from helpers.places import RUNS
from helpers.sweeps import ANGLE_AND_PHI, messages, refused, table, write

from warpgran.case.case import Case, CaseError
from warpgran.case.identity import identity
from warpgran.case.read_study import read_study, sweep
from warpgran.case.study import Study
from warpgran.case.sweep_section import KINDS

FIRST = Case().with_(**{"scheme.order": 1})


@pytest.mark.parametrize("key", [key for key, kind in KINDS.items() if kind in (float, int)])
def test_every_number_can_be_swept(key: str) -> None:
    base = Case() if Case().flat()[key] is not None else FIRST
    value = base.flat()[key]
    assert [case.flat()[key] for case in base.sweep({key: [value, value]})] == [value, value]


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
    study = (FIRST if key in ("scheme.viscosity", "scheme.lambda") else Case()).sweep({key: values})
    assert study.values(key) == list(values)
    assert [case.flat()[key] for case in study] == list(values)


# A study as a sequence


def test_a_study_is_a_sequence_of_cases() -> None:
    case = Case().with_(title="x")
    study = case.sweep(ANGLE_AND_PHI)
    title = study.base.title
    wanted = [case.with_(**{"slope.angle": angle, "column.phi": phi}, title=title) for angle, phi in table(study)]
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
    base = FIRST
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
    for wrong in ("dense.toml", [base, "dense.toml"], [None]):
        with pytest.raises(CaseError, match=r"not cases; .* warpgran\.read_study\(path\) reads a run file"):
            Study.of(wrong)  # type: ignore[arg-type]


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


def test_the_identity_of_a_run_is_that_of_its_case(tmp_path: Path) -> None:
    path = write(tmp_path, '[sweep.over]\n"slope.angle" = [0, 3]\n"column.phi" = [0.5, 0.6]\n')
    study = read_study(path)
    assert [study.identity(i) for i in range(4)] == [identity(case) for case in study]
    assert study.identity(2) == identity(Case().with_(**{"slope.angle": 3.0, "column.phi": 0.5}))
    longer = read_study(path, ["sweep.over.slope.angle=[3, 4, 5]"])
    assert longer.identity(0) == study.identity(2)  # whatever its number
    assert len({study.identity(i) for i in range(4)}) == 4


def test_a_default_that_follows_a_swept_key_differs_with_it() -> None:
    d = [1e-3, 2e-3]
    study = Case().sweep({"rheology.grain_diameter": d})
    assert study.keys == ("rheology.grain_diameter",)
    follow = {"scheme.h_min": [5e-3, 1e-2], "scheme.h_front": [2e-3, 4e-3]}
    assert study.parameters() == {"rheology.grain_diameter": array("d", d), **follow}
    assert [case.h_min for case in study] == follow["scheme.h_min"]
    fixed = Case().with_(**{"scheme.h_min": 1e-3, "scheme.h_front": 1e-3})
    assert fixed.sweep({"rheology.grain_diameter": d}).parameters().keys() == {*study.keys}
    both = Case().sweep({"rheology.grain_diameter": d, "scheme.h_min": [3e-3, 4e-3]}, mode="zip")
    assert both.parameters()["scheme.h_min"] == array("d", [3e-3, 4e-3])
    orders = Case().sweep({"scheme.order": [1, 2]})
    assert orders.parameters() == {"scheme.order": (1, 2), "scheme.h_min": pytest.approx([7e-4, 3.5e-3])}
    steep = Case().sweep({"slope.angle": [0.0, 60.0]}).parameters()["time.rest_speed"]
    assert steep == pytest.approx([math.sqrt(9.81 * 0.14) * 1e-3, math.sqrt(9.81 * 0.07) * 1e-3])
    listed = Study.of(list(study))
    assert (listed.keys, listed.parameters()["scheme.h_min"]) == (study.keys, array("d", [5e-3, 1e-2]))
    ends = {"grid.left": [-0.3, -0.4]}
    assert Case().sweep(ends).parameters()["column.start"] == ends["grid.left"]
    assert Case().with_(**{"column.profile": {"x": [0, 1], "h": [1, 1]}}).sweep(ends).parameters().keys() == ends.keys()


# Run files


def test_a_file_without_a_sweep_is_a_study_of_one(tmp_path: Path) -> None:
    path = write(tmp_path, "title = 'x'\n[slope]\nangle = 3\n")
    study = read_study(path, ["column.phi=0.5"])
    assert (len(study), study.keys, repr(study)) == (1, (), "<Study of 1 run>")
    assert study[0] == study.base == Case.from_toml(path, ["column.phi=0.5"])
    assert (study.source, study.folder) == (path.read_text(), path.parent)
    with pytest.raises(CaseError, match=r"a\.toml: slope\.angle: 100 is out of range"):
        read_study(path, ["slope.angle=100"])


def test_a_sweep_is_no_case_and_says_what_reads_it(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match=r"sweep: is a sweep of several runs.*warpgran\.read_study"):
        Case.from_toml(write(tmp_path, "[sweep.over]\n'slope.angle' = [1, 2]\n"))


@pytest.mark.parametrize(
    "keys", ['"slope.angle" = [0, 3]\n"column.phi" = [0.5]', "slope.angle = [0, 3]\ncolumn.phi = [0.5]"]
)
def test_keys_with_and_without_quotes(tmp_path: Path, keys: str) -> None:
    path = write(tmp_path, f"title = 'x'\n[slope]\nangle = 7\n[sweep.over]\n{keys}\n")
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
def test_overrides(tmp_path: Path, overrides: list[str], wanted: list[tuple[float, float]]) -> None:
    path = write(tmp_path, '[sweep.over]\n"slope.angle" = [0, 3]\n"column.phi" = [0.5, 0.6]\n')
    study = read_study(path, overrides)
    assert np.array(table(study)) == pytest.approx(np.array(wanted), rel=1e-6)


def test_an_override_makes_a_sweep_and_may_not_be_undone_by_one(tmp_path: Path) -> None:
    path = write(tmp_path, "")
    assert read_study(path, ["sweep.over.slope.angle=[0, 3]"]).values("slope.angle") == [0.0, 3.0]
    with pytest.raises(CaseError) as caught:
        read_study(path, ["sweep.over.slope.angle=[0, 3]", "slope.angle=2"])
    assert messages(caught.value) == {
        "slope.angle": "the sweep varies it and would undo this override; set sweep.over.slope.angle instead"
    }


def test_tables_are_found_beside_the_run_file(tmp_path: Path) -> None:
    path = write(tmp_path, '[slope]\nbed = "bed.csv"\n[sweep.over]\n"slope.angle" = [0, 3]\n')
    (path.parent / "bed.csv").write_text("x,b\n0,0\n1,0.5\n")
    study = read_study(path)
    (path.parent / "bed.csv").unlink()
    assert [case.bed[-1] for case in study] == [0.5, 0.5]
    with pytest.raises(CaseError) as caught:
        read_study(path, ["scheme.cfl=3"])
    assert messages(caught.value).keys() == {"slope.bed", "scheme.cfl"}  # once, not for every run


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


def test_all_errors_at_once(tmp_path: Path) -> None:
    path = write(
        tmp_path,
        """
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
    """,
    )
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
    assert (len(study), study.base.grid.cells, len(study.base.sample_times)) == (256, 500, 201)
    assert study.keys == ("rheology.mu1", "rheology.K", "column.phi", "slope.angle")
