"""Changes of a run file from outside, `KEY=VALUE`, and what they leave of its title."""

from __future__ import annotations

from collections.abc import Sequence
from copy import deepcopy
from typing import Any

from warpgran.case.identity import LEFT_OUT
from warpgran.case.problems import Problem
from warpgran.case.toml import override, toml_value, value_at

LONGEST = 40
"""Characters of a value that a title shows whole."""


def override_all(data: dict[str, Any], overrides: Sequence[str]) -> list[Problem]:
    """Set keys of a run file, and name in its title those that now differ: it may be about what they were.

    "Dense column, 22 degrees" becomes "Dense column, 22 degrees [slope.angle = 5]". A title that is set itself stays,
    and keys that decide nothing of the flow are not named.
    """
    title = data.get("title")
    keys = dict.fromkeys(text.partition("=")[0].strip() for text in overrides)
    before = {key: deepcopy(value_at(data, key)) for key in keys}
    problems = [problem for text in overrides if (problem := override(data, text))]
    changed = [key for key in keys if key not in LEFT_OUT and value_at(data, key) != before[key]]
    if changed and title and isinstance(title, str) and "title" not in keys:
        data["title"] = f"{title} [{', '.join(f'{key} = {_shown(value_at(data, key))}' for key in changed)}]"
    return problems


def _shown(value: Any) -> str:
    text = value if isinstance(value, str) else toml_value(value)
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 3]}..."
