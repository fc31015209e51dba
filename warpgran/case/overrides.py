"""Changes of a run file from outside, `KEY=VALUE`, and what becomes of its title when keys change."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager
from copy import deepcopy
from numbers import Real
from typing import Any

import numpy as np

from warpgran.case.identity import LEFT_OUT
from warpgran.case.problems import Problem
from warpgran.case.toml import override, plain, toml_value, value_at

LONGEST = 40
"""Characters of a value that a title shows whole."""
_NOTE = re.compile(r"(.*?) \[([\w.]+ = .*)\]", re.DOTALL)
_BETWEEN = re.compile(r", (?=[\w.]+ = )")


def override_all(data: dict[str, Any], overrides: Sequence[str]) -> list[Problem]:
    """Set keys of a run file, and name in its title those that now differ, see `named_in_title`."""
    with named_in_title(data, [text.partition("=")[0].strip() for text in overrides]):
        return [problem for text in overrides if (problem := override(data, text))]


@contextmanager
def named_in_title(data: dict[str, Any], keys: Iterable[str]) -> Iterator[None]:
    """Add to the title the keys that are changed in this block, since it may describe their old values.

    "Dense column, 22 degrees" becomes "Dense column, 22 degrees [slope.angle = 5]"; a key that is changed again is
    named with its last value. A title that is itself set stays, and keys that do not affect the flow are not named.
    """
    title, keys = data.get("title"), list(dict.fromkeys(keys))
    before = {key: deepcopy(value_at(data, key)) for key in keys}
    yield
    changed = [key for key in keys if key not in LEFT_OUT and _differ(value_at(data, key), before[key])]
    if changed and title and isinstance(title, str) and "title" not in keys:
        data["title"] = _noted(title, {key: f"{key} = {_shown(value_at(data, key))}" for key in changed})


def without_notes(title: str, keys: Collection[str]) -> str:
    """The title without its notes on these keys."""
    return _noted(title, dict.fromkeys(keys, ""))


def _noted(title: str, notes: dict[str, str]) -> str:
    """The title with these notes by key, which replace those that it has on the same keys."""
    found = _NOTE.fullmatch(title)
    if found:
        title = found[1]
        notes = {note.partition(" = ")[0]: note for note in _BETWEEN.split(found[2])} | notes
    said = ", ".join(filter(None, notes.values()))
    return f"{title} [{said}]" if said else title


def _differ(a: Any, b: Any) -> bool:
    found = a != b
    return found if isinstance(found, bool) else True  # an array against anything


def _shown(value: Any) -> str:
    if value is None:
        return "default"
    value = value.tolist() if isinstance(value, np.ndarray) else value
    number = isinstance(value, Real) and not isinstance(value, bool)
    text = f"{value:.12g}" if number else value if isinstance(value, str) else toml_value(plain(value))
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 3]}..."
