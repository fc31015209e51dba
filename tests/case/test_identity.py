"""The identity of a case: what changes it and what does not."""

import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from warpgran.case.case import Case
from warpgran.case.identity import identity
from warpgran.case.sweep_section import KINDS

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
    "scheme.order": 1,
    "scheme.start": 1,
    "scheme.right": "wall",
    "slope.bed": {"x": [0, 1], "b": [0, 1]},
    "column.profile": {"x": [0, 1], "h": [1, 1]},
}
NO_CHANGES: dict[str, Any] = {
    "title": "x",
    "scheme.window": False,
    "slope.angle": -0.0,
    "column.start": -0.2,
    "scheme.h_min": 3.5e-3,
    "scheme.start": 2,
    "time.rest_speed": math.nextafter(Case().rest_speed, 1.0),
    "time.snapshots": [0.0, 0.36, 0.72, 1.08, 1.44, 1.8],
    "time.series": {"every": 0.009},
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
    words = {
        "order": 1,
        "phi_eq": "f0",
        "relaxation": "exponential",
        "viscosity": "paper",
        "left": "open",
        "right": "wall",
    }
    for key, kind in KINDS.items():
        base = Case() if Case().flat()[key] is not None else Case().with_(**{"scheme.order": 1})
        value = base.flat()[key]
        name = key.rpartition(".")[2]
        other = words[name] if kind is str or name == "order" else others[kind](value)
        if key == "column.start":
            other = 0.1
        same = identity(base.with_(**{key: other})) == identity(base)
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
