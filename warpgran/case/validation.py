"""Nested data of a run file to a valid case, or every problem at once."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

from warpgran.case.problems import CaseError, Problem, shown
from warpgran.case.tables import TableError, read_bed, read_profile
from warpgran.case.toml import ASIDE, VARYING, as_data, without

T = TypeVar("T")


def validated(make: Callable[..., T], data: Any, problems: list[Problem], folder: Path, where: str = "") -> T:
    """A case of nested data whose tables are paths, which start from the folder, or columns.

    Args:
        make: The class of the case, called with its sections.
        data: Sections of keys.
        problems: Those already found.
        folder: What relative paths start from.
        where: The run file, "" where there is none.

    Raises:
        CaseError: Lists every problem, those already found first.
    """
    if not isinstance(data, Mapping):
        raise CaseError([Problem("", f"{shown(data)} is not a table of sections")], where)
    data = as_data(data)
    problems = [*problems, *_misplaced(data), *read_tables(data, folder)]
    # Rules that involve several keys need all of them valid: leave out the invalid keys and validate once more.
    for _ in range(2):
        invalid = {_field(problem.key) for problem in problems if problem.key}
        try:
            case = make(**without(data, invalid))
        except CaseError as error:
            problems += [p for p in error.problems if not any(_in(key, invalid) for key in (p.key, *p.involves))]
            if any(problem.involves for problem in error.problems):
                break
        else:
            if problems:
                break
            return case
    raise CaseError(problems, where)


def _misplaced(data: dict[str, Any]) -> list[Problem]:
    """Remove what is no section of a case, and report what only looks like one."""
    problems = []
    for key in [key for key in data if "." in key]:
        del data[key]
        section, _, name = key.partition(".")
        problems.append(Problem(f'"{key}"', f"unknown key; write {name} under [{section}]"))
    for name in ASIDE:
        data.pop(name, None)
    for name in [name for name in VARYING if name in data]:
        del data[name]
        message = f"is a {VARYING[name]} of several runs, and a case is one; read such a file with warpgran.read_study"
        problems.append(Problem(name, message))
    return problems


def read_tables(data: dict[str, Any], folder: Path) -> list[Problem]:
    """Replace the paths of tables, which start from the folder, by the tables, and report those that cannot be read."""
    problems = []
    for section, key, read in (("slope", "bed", read_bed), ("column", "profile", read_profile)):
        keys = data.get(section)
        if isinstance(keys, dict) and isinstance(keys.get(key), str | os.PathLike):
            try:
                keys[key] = read(keys[key], folder)
            except TableError as error:
                problems += [Problem(f"{section}.{key}", message) for message in error.messages]
    return problems


def _field(key: str) -> str:
    """`time.snapshots` of `time.snapshots[2]` and of `time.snapshots.every`."""
    return ".".join(key.partition("[")[0].split(".")[:2])


def _in(key: str, invalid: set[str]) -> bool:
    """Whether the key or its section is among the invalid ones."""
    field = _field(key)
    return field in invalid or field.partition(".")[0] in invalid
