"""What is refused, in which words, and the ends of what is not."""

import math
import pickle
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from warpgran.case.case import Case, CaseError

THREE = "three numbers >= 0, the second <= the first"
PROFILE = {"x": [0.0, 0.4], "h": [0.1, 0.2]}


def problems(make: Callable[[], Case]) -> dict[str, str]:
    """Messages by key; each key at most once."""
    with pytest.raises(CaseError) as caught:
        make()
    found = {problem.key: problem.message for problem in caught.value.problems}
    assert len(found) == len(caught.value.problems)
    return found


def refused(**changes: Any) -> dict[str, str]:
    return problems(lambda: Case().with_(**changes))


FIRST = {"scheme.order": 1}
"""The paper's scheme, which has keys of its own."""


# One key by itself

POSITIVE = [
    "rheology.I0",
    "rheology.grain_diameter",
    "rheology.phi_eq_N",
    "rheology.channel_width",
    "slope.gravity",
    "column.height",
    "column.length",
    "time.end",
    "time.rest_speed",
    "scheme.h_min",
    "scheme.h_front",
]
NOT_NEGATIVE = ["rheology.mu1", "rheology.mu2", "rheology.K", "rheology.K_tilde", "rheology.mu_wall", "scheme.h_bed"]
REALS = [key for key, value in Case().flat().items() if type(value) is float]


@pytest.mark.parametrize(
    "changes",
    [
        dict.fromkeys(POSITIVE, 0) | dict.fromkeys(NOT_NEGATIVE, -1e-9),
        {"rheology.phi_stat": 0.0, "column.phi": 0.0, "slope.angle": -80.1, "grid.cells": 3, "time.step_limit": 0},
        {"rheology.phi_stat": 1.0, "column.phi": 1.0, "slope.angle": 80.1, "grid.cells": 10_000_001},
        {"scheme.alpha": 1.0, "scheme.lambda": -0.1, "scheme.cfl": 0.0, "time.snapshots.every": 0.0},
        {"scheme.alpha": 10.1, "scheme.lambda": 1.1, "scheme.cfl": 0.51, "time.series.every": -1},
        {"scheme.start": -1, "scheme.order": 0},
        {"scheme.start": 11, "scheme.order": 3},
    ],
)
def test_out_of_range(changes: dict[str, float]) -> None:
    found = refused(**changes)
    assert found.keys() == changes.keys()
    for key, value in changes.items():
        assert found[key].startswith(f"{value} is out of range; allowed: {'1 or 2' if key == 'scheme.order' else '>'}")


@pytest.mark.parametrize(
    "changes",
    [
        {key: 0 for key in NOT_NEGATIVE if key != "rheology.mu2"}
        | FIRST
        | {"scheme.xi": [0, 0, 0], "slope.angle": -80},
        {"slope.angle": 80, "scheme.alpha": 10, "scheme.lambda": 1, "scheme.cfl": 0.5, "rheology.mu2": 0.48, **FIRST},
        {"scheme.order": 2, "scheme.start": 10},
        {"scheme.start": 0},
        {"grid.cells": 9, "column.length": 1.8, "time.snapshots": [0, 1.8], "time.series": []},
        {"column.start": 1.4, "time.snapshots": {"every": 1.8}, "time.series": {"every": 1.8001e-6}},
    ],
)
def test_the_ends_of_the_ranges_are_in(changes: dict[str, Any]) -> None:
    flat = Case().with_(**changes).flat()
    assert {key: flat[key] for key in changes} == changes


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (True, "true is not a number; allowed: "),
        ("soon", '"soon" is not a number; allowed: '),
        ([1.0], "[1.0] is not a number; allowed: "),
        ({"a": 1}, "{'a': 1} is not a number; allowed: "),
        (math.nan, "nan is not a finite number; allowed: "),
        (math.inf, "inf is not a finite number; allowed: "),
        (-math.inf, "-inf is not a finite number; allowed: "),
    ],
)
def test_only_finite_numbers_are_numbers(value: Any, words: str) -> None:
    found = refused(**dict.fromkeys(REALS, value))
    assert found.keys() == set(REALS)
    assert all(message.startswith(words) for message in found.values())


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("title", 3, "3 is not text"),
        ("grid.cells", 1800.0, "1800.0 is not a whole number; allowed: >= 4 and <= 10000000"),
        ("grid.cells", True, "true is not a whole number; allowed: >= 4 and <= 10000000"),
        ("scheme.window", 1, "1 is not true or false"),
        ("rheology.phi_eq", "f3", '"f3" is not known; allowed: "f0", "f1" or "f2"'),
        ("scheme.relaxation", "fast", '"fast" is not known; allowed: "rational" or "exponential"'),
        ("scheme.viscosity", "none", '"none" is not known; allowed: "bounded" or "paper"'),
        ("scheme.left", "cyclic", '"cyclic" is not known; allowed: "wall", "open" or "periodic"'),
        ("scheme.right", 2, '2 is not known; allowed: "wall", "open" or "periodic"'),
        ("scheme.xi", [1, 2], f"[1, 2] has the wrong length; allowed: {THREE}"),
        ("scheme.xi", [1, 2, 3, 4], f"[1, 2, 3, 4] has the wrong length; allowed: {THREE}"),
        ("scheme.xi", 2, f"2 is not a list; allowed: {THREE}"),
        ("time.snapshots", 0.1, "0.1 is not a list; allowed: times in [0, time.end] or { every = s }, in s"),
        ("slope.bed", 3, "3 is not the path of a CSV file"),
        ("slope", 3, "3 is not a table of keys"),
    ],
)
def test_wrong_type_or_word(key: str, value: Any, message: str) -> None:
    assert refused(**{key: value}) == {key: message}


def test_a_part_of_a_value_is_named() -> None:
    assert refused(**{"scheme.xi": [1, -2, True]}).keys() == {"scheme.xi[1]", "scheme.xi[2]"}
    assert refused(**{"time.snapshots": [0.1, "x"]}).keys() == {"time.snapshots[1]"}
    assert refused(**{"time.series": {}}) == {"time.series.every": "is missing; allowed: > 0 and <= time.end, in s"}


# Unknown keys


@pytest.mark.parametrize(
    ("key", "near"),
    [
        ("slope.angel", "slope.angle"),
        ("rheology.k", "rheology.K"),
        ("rheology.diameter", "rheology.grain_diameter"),
        ("column.h_min", "scheme.h_min"),
        ("angle", "slope.angle"),
        ("titel", "title"),
        ("scheme.lambda_", "scheme.lambda"),
        ("scheme.left_", "scheme.left"),
        ("left", "grid.left or scheme.left"),
        ("rheology.zzz", None),
    ],
)
def test_unknown_key_and_the_nearest_known(key: str, near: str | None) -> None:
    section, _, name = key.rpartition(".")
    message = f"unknown key; did you mean {near}?" if near else "unknown key"
    assert problems(lambda: Case.from_dict({section: {name: 1}} if section else {name: 1})) == {key: message}
    for value in (1, None):
        assert refused(**{key: value}) == {key: message}


def test_unknown_sections_and_names_with_dots() -> None:
    assert problems(lambda: Case.from_dict({"grids": {"left": 0}})) == {"grids": "unknown key; did you mean grid?"}
    assert problems(lambda: Case.from_dict({"slope.angle": 3})) == {
        '"slope.angle"': "unknown key; write angle under [slope]"
    }
    assert "not a table" in problems(lambda: Case.from_dict([1]))[""]  # type: ignore[arg-type]


def test_a_sweep_is_no_case() -> None:
    found = problems(lambda: Case.from_dict({"sweep": {"mode": "product"}}))
    message = "is a sweep of several runs, and a case is one; read such a file with warpgran.read_study"
    assert found == {"sweep": message}


# Between keys


@pytest.mark.parametrize(
    ("changes", "key", "words"),
    [
        ({"rheology.mu2": 0.3}, "rheology.mu2", ">= rheology.mu1, which is 0.48"),
        ({"grid.left": 1.6}, "grid.left", "< grid.right"),
        ({"grid.left": -1e30, "grid.right": 1e30}, "column.length", "covers no cell centre"),
        ({"grid.left": 1.0, "grid.right": 1.0 + 1e-13}, "grid.cells", "precision"),
        ({"column.start": -0.3}, "column.start", "from -0.3 to -0.1 m is not inside the grid; allowed: -0.2 to 1.6 m"),
        ({"column.start": 1.5}, "column.start", "not inside the grid"),
        ({"grid.cells": 10_000_000, "scheme.start": 1}, "scheme.start", "allowed: grid.cells 2^start <= 10000000"),
        ({"column.length": 1.9}, "column.length", "not inside the grid"),
        ({"column.length": 4e-4}, "column.length", "covers no cell centre"),
        ({"scheme.h_bed": 0.14}, "scheme.h_bed", "< the column's height"),
        ({"time.snapshots": [0.1, 1.9]}, "time.snapshots[1]", "<= time.end, which is 1.8"),
        ({"time.snapshots": [0.1, 0.1]}, "time.snapshots[1]", "strictly increasing"),
        ({"time.series": [0.2, 0.1]}, "time.series[1]", "strictly increasing"),
        ({"time.series": [0.2, 0.2 + 1e-12]}, "time.series[1]", "strictly increasing"),
        ({"time.series.every": 1.9}, "time.series.every", "<= time.end"),
        ({"time.series.every": 1.8e-6}, "time.series.every", "more than 1000000 times"),
        ({"slope.bed": {"x": [2, 3], "b": [0, 0]}}, "slope.bed", "outside the grid"),
        ({"column.profile": {"x": [2, 3], "h": [1, 1]}}, "column.profile", "outside the grid"),
        ({"column.profile": {"x": [0, 1e-4], "h": [1, 1]}}, "column.profile", "0 at every cell centre"),
        ({"column.profile": PROFILE, "scheme.h_bed": 0.2}, "scheme.h_bed", "< the column's height, which is 0.2"),
        ({"column.profile": PROFILE, "column.height": 0.2}, "column.height", "no part beside column.profile"),
        ({"column.profile": PROFILE, "column.length": 0.2}, "column.length", "no part beside column.profile"),
        ({"column.profile": PROFILE, "column.start": 0.2}, "column.start", "no part beside column.profile"),
        ({"column.profile": {**PROFILE, "phi": [0.5, 0.5]}, "column.phi": 0.6}, "column.phi", "no part beside"),
    ],
)
def test_keys_that_do_not_fit_each_other(changes: dict[str, Any], key: str, words: str) -> None:
    found = refused(**changes)
    assert found.keys() == {key}
    assert words in found[key]


@pytest.mark.parametrize(
    ("data", "keys"),
    [
        ({"grid": {"right": "far"}, "column": {"start": 3.0}}, {"grid.right"}),
        ({"grid": 3, "column": {"start": 3.0}}, {"grid"}),
        ({"column": {"profile": "missing.csv"}, "grid": {"right": -0.1}}, {"column.profile"}),
        ({"column": {"profile": "missing.csv"}, "scheme": {"h_bed": 0.2}}, {"column.profile"}),
        ({"time": {"end": -1, "snapshots": [5.0]}, "rheology": {"mu2": 0.1}}, {"time.end", "rheology.mu2"}),
    ],
)
def test_no_judgement_rests_on_a_bad_value(data: dict[str, Any], keys: set[str]) -> None:
    assert problems(lambda: Case.from_dict(data)).keys() == keys


ORDER_1: dict[str, Any] = {
    "scheme.lambda": 0.0,
    "scheme.relaxation": "rational",
    "scheme.viscosity": "bounded",
    "scheme.xi": [2.0, 2.0, 5.0],
}


@pytest.mark.parametrize(
    ("order", "changes"),
    [(2, {key: value}) for key, value in ORDER_1.items()] + [(2, ORDER_1), (1, {"scheme.start": 2})],
)
def test_keys_of_the_other_order_are_refused_by_name(order: int, changes: dict[str, Any]) -> None:
    message = f"has no part in the scheme of order {order}; take it out, or set scheme.order = {3 - order}"
    assert refused(**{"scheme.order": order, **changes}) == dict.fromkeys(changes, message)
    case = Case().with_(**{"scheme.order": 3 - order, **changes})
    assert all(case.flat()[key] == value for key, value in changes.items())
    other = Case().with_(**{"scheme.order": order}).flat()
    assert all(other[key] is None for key in changes)


def test_a_sweep_over_the_order_cannot_set_a_key_of_one() -> None:
    assert len(Case().sweep({"scheme.order": [1, 2]})) == 2
    with pytest.raises(CaseError, match=r"scheme\.start: has no part in the scheme of order 1.*run 0"):
        Case().with_(**{"scheme.start": 1}).sweep({"scheme.order": [1, 2]})


# All at once


def test_all_errors_at_once(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text("""
        titel = "x"
        [rheology]
        mu1 = -0.3
        I0 = nan
        [slope]
        angel = 22
        bed = "missing.csv"
        [time]
        end = "soon"
        [column]
        start = 9
    """)
    with pytest.raises(CaseError) as caught:
        Case.from_toml(path, ["scheme.cfl=2", "nonsense"])
    lines = str(caught.value).splitlines()
    assert all(line.startswith(f"{path}: ") for line in lines)
    text = [line.removeprefix(f"{path}: ") for line in lines]
    assert sorted(text) == sorted(
        [
            'override "nonsense" is not KEY=VALUE',
            f"slope.bed: {tmp_path / 'missing.csv'}: cannot be read: No such file or directory",
            "titel: unknown key; did you mean title?",
            "rheology.mu1: -0.3 is out of range; allowed: >= 0",
            "rheology.I0: nan is not a finite number; allowed: > 0",
            "slope.angel: unknown key; did you mean slope.angle?",
            'time.end: "soon" is not a number; allowed: > 0, in s',
            "scheme.cfl: 2 is out of range; allowed: > 0 and <= 0.5",
            "column.start: the column from 9 to 9.2 m is not inside the grid; allowed: -0.2 to 1.6 m",
        ]
    )


def test_no_jargon_and_every_error_survives_a_pickle() -> None:
    with pytest.raises(CaseError) as caught:
        Case(slope={"angle": 100, "x": 3}, grid=3, scheme={"xi": "x", "h_min": []})
    assert not re.search("pydantic|http|Input should|type=|valid (dict|tuple)", str(caught.value))
    assert len(caught.value.problems) == 5
    assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)


# What the scheme cannot do


def test_momentum_must_not_diffuse_faster_than_mass() -> None:
    assert refused(**FIRST, **{"scheme.xi": [2.0, 2.1, 5.0]}) == {
        "scheme.xi": "[2.0, 2.1, 5.0] diffuses momentum faster than mass, which makes velocities out of nothing; "
        "allowed: three numbers >= 0, the second <= the first"
    }
    assert Case().with_(**FIRST, **{"scheme.xi": [2.0, 0.0, 0.0]}).scheme.xi == (2.0, 0.0, 0.0)


EXPONENTIAL = {**FIRST, "scheme.relaxation": "exponential", "scheme.cfl": 0.5, "rheology.K": 20.0, "scheme.h_min": 1e-3}


@pytest.mark.parametrize(
    ("law", "most", "cells"),
    [
        ({"rheology.phi_eq": "f0"}, 20, 2750),
        ({"rheology.phi_eq": "f1"}, 60, 917),
        ({"rheology.phi_eq_N": 2.1}, 60, 917),
    ],
)
def test_the_exponential_relaxation_has_a_longest_step(law: dict[str, Any], most: int, cells: int) -> None:
    at_limit = {**EXPONENTIAL, **law, "grid.right": 2.0, "grid.cells": cells}  # 2.5 cfl K dx/h_min = 55000/cells
    assert Case().with_(**at_limit).scheme.relaxation == "exponential"
    phi_eq = law.get("rheology.phi_eq", "f2")
    says = f'2.5 cfl K dx/h_min is {most}; allowed: <= {most} with {phi_eq}; take "rational", or smaller cells'
    assert refused(**{**at_limit, "grid.cells": cells - 1}) == {
        "scheme.relaxation": f'"exponential" takes phi to nothing in one step of a thin cell: {says}'
    }
    Case().with_(**{**at_limit, "grid.cells": 183, "scheme.relaxation": "rational"})


def test_the_exponential_relaxation_of_order_2_is_refused_for_one_reason() -> None:
    found = refused(**{"scheme.relaxation": "exponential", "rheology.phi_eq": "f0", "rheology.K": 20.0})
    assert found == {"scheme.relaxation": "has no part in the scheme of order 2; take it out, or set scheme.order = 1"}


def test_the_exponential_relaxation_is_free_where_phi_eq_does_not_vanish() -> None:
    Case().with_(**EXPONENTIAL, **{"grid.cells": 20, "rheology.phi_eq_N": 2.0})
