"""Problems of a case, in plain words and all at once."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import date, time
from difflib import get_close_matches
from typing import Any

from pydantic import ValidationError

from warpgran.case.tables import TableError
from warpgran.errors import WarpgranError

_OUT_OF_RANGE = {"greater_than", "greater_than_equal", "less_than", "less_than_equal"}
_WRONG_TYPE = {
    "float_type": "a number",
    "int_type": "a whole number",
    "string_type": "text",
    "bool_type": "true or false",
    "tuple_type": "a list",
    "literal_error": "known",
    "finite_number": "a finite number",
    "union_tag_not_found": "a list",
}


@dataclass(frozen=True)
class Problem:
    """One problem of a case.

    Attributes:
        key: Dotted key path as in the run file, "" where no key is to blame.
        message: The value, what is wrong with it and what is allowed.
        involves: Every key that the broken rule involves; `key` alone where empty.
    """

    key: str
    message: str
    involves: tuple[str, ...] = field(default=(), compare=False)

    def __str__(self) -> str:
        return f"{self.key}: {self.message}" if self.key else self.message


class CaseError(WarpgranError, ValueError):
    """A case that cannot be run. Prints as one line per problem.

    Attributes:
        problems: All of them.
        where: The run file, "" where there is none.
    """

    def __init__(self, problems: Iterable[Problem], where: str = "") -> None:
        self.problems = list(problems)
        self.where = where
        super().__init__("\n".join(f"{where}: {problem}" if where else str(problem) for problem in self.problems))

    def __reduce__(self) -> tuple[type[CaseError], tuple[list[Problem], str]]:
        return type(self), (self.problems, self.where)  # the default would hand the text to __init__


def shown(value: Any) -> str:
    """A value as the run file would write it, cut to a length that fits a line."""
    if isinstance(value, bool):
        text = str(value).lower()
    elif isinstance(value, str):
        text = json.dumps(value, ensure_ascii=False)
    elif isinstance(value, date | time):
        text = value.isoformat()
    else:
        text = " ".join(repr(value).split())
    return text if len(text) <= 60 else text[:57] + "..."


def values_in_words(values: Mapping[str, Any]) -> str:
    """`slope.angle = 100, rheology.phi_eq = "f0"` of the values of a run by key."""
    return ", ".join(f"{k} = {v:.6g}" if isinstance(v, float) else f"{k} = {shown(v)}" for k, v in values.items())


def unknown_key(key: str, known: Iterable[str]) -> Problem:
    """The problem of a key that does not exist, with the nearest one that does."""
    names = list(known)
    section, _, last = key.rpartition(".")
    beside = {name.rpartition(".")[2].lower(): name for name in names if name.rpartition(".")[0] == section}
    anywhere = {name.rpartition(".")[2].lower(): name for name in names}
    near = [name for name in names if name.rpartition(".")[2] == last]  # the right name in the wrong section
    near = near or [beside[name] for name in get_close_matches(last.lower(), beside, n=1)]
    near = near or [anywhere[name] for name in get_close_matches(last.lower(), anywhere, n=1, cutoff=0.75)]
    return Problem(key, "unknown key" + (f"; did you mean {' or '.join(near)}?" if near else ""))


def dotted(location: Sequence[str | int]) -> str:
    """`("time", "snapshots", 2)` as `time.snapshots[2]`; names in angle brackets (branches of a union) are left out."""
    key = ""
    for part in location:
        if isinstance(part, int):
            key += f"[{part}]"
        elif not part.startswith("<"):
            key += f".{part}" if key else part
    return key


def problems_of(error: ValidationError, allowed: Mapping[str, str]) -> list[Problem]:
    """Pydantic's errors in plain words, each key and message once.

    Args:
        error: What the validation raised.
        allowed: Every known key (sections too) and what is allowed there.
    """
    problems: dict[Problem, None] = {}
    for detail in error.errors(include_url=False):
        for problem in _plain(detail["type"], detail["loc"], detail["input"], detail.get("ctx", {}), allowed):
            problems[problem] = None
    return list(problems)


def _plain(
    kind: str, location: tuple[int | str, ...], value: Any, context: Mapping[str, Any], allowed: Mapping[str, str]
) -> list[Problem]:
    cause = context.get("error")
    if isinstance(cause, CaseError):
        return [replace(problem, key=dotted((*location, problem.key))) for problem in cause.problems]
    if isinstance(cause, TableError):
        return [Problem(dotted(location), message) for message in cause.messages]
    lacks_element = kind == "missing" and isinstance(location[-1], int)
    if lacks_element:
        location = location[:-1]
    key = dotted(location)
    hint = allowed.get(key.partition("[")[0], "")
    what = f"; allowed: {hint}" if hint else ""
    if kind == "extra_forbidden":
        return [unknown_key(key, allowed)]
    if kind == "missing" and not lacks_element:
        return [Problem(key, f"is missing{what}")]
    if kind in ("missing", "too_long", "too_short"):
        return [Problem(key, f"{shown(value)} has the wrong length{what}")]
    if kind in _OUT_OF_RANGE:
        return [Problem(key, f"{shown(value)} is out of range{what}")]
    if kind in _WRONG_TYPE:
        return [Problem(key, f"{shown(value)} is not {_WRONG_TYPE[kind]}{what}")]
    if kind in ("model_type", "model_attributes_type", "dict_type"):
        return [Problem(key, f"{shown(value)} is not a table of keys")]
    return [Problem(key, f"{shown(value)} is not valid{what}")]
