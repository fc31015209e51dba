"""Run files: reading, overriding and writing them, and those that come with the project."""

import copy
import pickle
import re
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from helpers.places import RUNS

from warpgran.case.case import Case, CaseError

PROFILE = {"x": [0.0, 0.4], "h": [0.1, 0.2]}


@pytest.fixture
def write(tmp_path: Path) -> Callable[[str], Path]:
    def write_file(text: str) -> Path:
        (tmp_path / "a.toml").write_text(text, encoding="utf-8")
        return tmp_path / "a.toml"

    return write_file


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"a = 1\nb = \n", r"is not valid TOML: .*line 2"),
        (b"[slope]\nangle = 1\nangle = 2\n", "is not valid TOML"),
        (b"title = '\xff'\n", "is not UTF-8 text"),
        (None, "No such file"),
    ],
)
def test_files_that_are_no_run_files(tmp_path: Path, content: bytes | None, words: str) -> None:
    path = tmp_path / "a.toml"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(CaseError, match=f"^{re.escape(str(path))}: .*{words}"):
        Case.from_toml(path)
    with pytest.raises(CaseError, match="it is a folder, not a file"):
        Case.from_toml(tmp_path)


def test_an_empty_file_is_the_default_case_and_a_byte_order_mark_is_passed_over(write: Callable[[str], Path]) -> None:
    assert Case.from_toml(write("")) == Case()
    assert Case.from_toml(write("\ufefftitle = 'x'")).title == "x"


@pytest.mark.parametrize(
    ("override", "key", "value"),
    [
        ("slope.angle=16", "slope.angle", 16.0),
        (" slope.angle = 16.5 ", "slope.angle", 16.5),
        ("rheology.phi_eq=f1", "rheology.phi_eq", "f1"),
        ('rheology.phi_eq="f1"', "rheology.phi_eq", "f1"),
        ("title=A slope = steep", "title", "A slope = steep"),
        ("title=", "title", ""),
        ("scheme.window=false", "scheme.window", False),
        ("time.snapshots=[0.1, 0.2]", "time.snapshots", [0.1, 0.2]),
        ("time.snapshots={every=0.9}", "time.snapshots", {"every": 0.9}),
        ("time.snapshots.every=0.9", "time.snapshots", {"every": 0.9}),
        ("scheme.order=1", "scheme.order", 1),
    ],
)
def test_overrides(write: Callable[[str], Path], override: str, key: str, value: Any) -> None:
    path = write("[slope]\nangle = 3\n[time]\nsnapshots = [1.0]")
    assert Case.from_toml(path, [override]).flat()[key] == value


def test_overrides_come_before_the_check_and_the_last_one_counts(write: Callable[[str], Path]) -> None:
    path = write("[slope]\nangle = 300\n")
    assert Case.from_toml(path, ["slope.angle=2", "slope.angle=3"]).slope.angle == 3.0


@pytest.mark.parametrize(
    ("override", "key", "words"),
    [
        ("slope.angle", "", "is not KEY=VALUE"),
        ("=3", "", "is not KEY=VALUE"),
        ("slope.angle=steep", "slope.angle", '"steep" is not a number'),
        ("slope.angle=", "slope.angle", '"" is not a number'),
        ("slope.angle=nan", "slope.angle", "nan is not a finite number"),
        ("slope.angle=1\ncolumn.phi = 0.1", "slope.angle", "is not a number"),
        ("slope.angel=3", "slope.angel", "did you mean slope.angle?"),
        ("slope=3", "slope", "is not a table of keys"),
        ("slope.angle.x=3", "slope.angle.x", "unknown key"),
        ("sweep.seed=3", "sweep", "read_study"),
    ],
)
def test_bad_overrides(write: Callable[[str], Path], override: str, key: str, words: str) -> None:
    path = write("[slope]\nangle = 3\n")
    with pytest.raises(CaseError) as caught:
        Case.from_toml(path, [override])
    [problem] = caught.value.problems
    assert problem.key == key
    assert words in problem.message


def test_source_and_folder_stay_with_the_case(write: Callable[[str], Path]) -> None:
    text = "# as written\n[slope]\nangle = 3\n"
    path = write(text)
    case = Case.from_toml(path, ["slope.angle=4"]).with_(**{"column.phi": 0.5})
    assert (case.source, case.folder) == (text, path.parent)
    assert (case.slope.angle, case.column.phi) == (4.0, 0.5)
    assert Case().source == ""


def test_tables_are_found_beside_the_run_file_and_read_once(write: Callable[[str], Path]) -> None:
    path = write('[slope]\nbed = "bed.csv"\n[column]\nprofile = "p.csv"\n')
    (path.parent / "bed.csv").write_text("x,b\n0,0\n1,0.5\n")
    (path.parent / "p.csv").write_text("x,h\n0,0.1\n1,0.1\n")
    case = Case.from_toml(path)
    again = Case.from_dict(tomllib.loads(case.to_toml()), folder=case.folder)
    assert again == case
    (path.parent / "bed.csv").unlink()
    (path.parent / "p.csv").write_text("x,h\n")
    assert case.with_(title="x").bed[-1] == 0.5
    with pytest.raises(CaseError) as caught:
        Case.from_toml(path)
    missing, short = caught.value.problems
    assert (missing.key, short.key) == ("slope.bed", "column.profile")
    assert "p.csv: has 0 rows" in short.message


MANY = {
    "title": 'quotes " and \\ and \n and \x7f and é 😀',
    "slope.angle": -1e-07,
    "slope.bed": {"x": [0.0, 1.0], "b": [0.0, 1e-20]},
    "column.profile": {**PROFILE, "phi": [0.5, 0.6]},
    "time.snapshots": [0.1, 1 / 3],
    "time.series": [],
    "scheme.order": 1,
    "scheme.lambda": 0.1,
    "scheme.window": False,
    "scheme.xi": [1, 0, 1e16],
}


@pytest.mark.parametrize("changes", [{}, MANY, {"time.end": 1e-3}, {"column.profile": PROFILE, "column.phi": 0.5}])
def test_round_trips(changes: dict[str, Any]) -> None:
    case = Case().with_(**changes)
    assert Case.from_dict(tomllib.loads(case.to_toml())) == case
    assert case.with_(**case.flat()) == case
    assert pickle.loads(pickle.dumps(case)) == case
    assert copy.deepcopy(case) == case
    for key, value in changes.items():
        assert case.flat()[key] == value


def test_lambda_by_its_key_and_its_attribute() -> None:
    case = Case().with_(**{"scheme.order": 1, "scheme.lambda": 0.5})
    assert case.scheme.lambda_ == 0.5
    assert "\nlambda = 0.5\n" in case.to_toml()


# The run files that come with the project


STUDIES = {*RUNS.glob("sweep_*"), *RUNS.glob("sensitivity_*"), *RUNS.glob("calibrate_*")}


@pytest.mark.parametrize("path", sorted({*RUNS.glob("*.toml")} - STUDIES), ids=lambda path: path.stem)
def test_run_files_load(path: Path) -> None:
    case = Case.from_toml(path)
    assert case.title
    assert case.dx == pytest.approx(1e-3)


@pytest.mark.parametrize(
    ("kind", "phi", "K"), [("dense", 0.62, 4.09), ("loose", 0.55, 4.09), ("incompressible", 0.62, 0)]
)
@pytest.mark.parametrize(("angle", "right"), [(0, 0.6), (10, 0.8), (16, 1.1), (22, 1.6)])
def test_run_files_are_the_papers(kind: str, phi: float, K: float, angle: int, right: float) -> None:
    case = Case.from_toml(RUNS / f"{kind}_{angle}deg.toml")
    same = {"title": case.title, "time.end": case.time.end, "time.snapshots": case.time.snapshots}
    cells = round((right + 0.2) * 1000)
    named = {"slope.angle": angle, "column.phi": phi, "rheology.K": K, "grid.right": right, "grid.cells": cells}
    assert case == Case().with_(**same, **named)


def test_the_first_run_is_the_contracts() -> None:
    case = Case.from_toml(RUNS / "dense_22deg.toml")
    assert case.snapshot_times == (0.06, 0.48, 1.38, 1.8)
    assert (len(case.sample_times), len(case.output_times)) == (201, 204)
