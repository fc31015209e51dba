"""Defaults that follow from other keys, as formulas that take the values of one run or arrays over runs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any


def _same(value: Any) -> Any:
    return value


FOLLOWS: dict[str, tuple[Callable[..., Any], tuple[str, ...]]] = {
    "column.start": (_same, ("grid.left",)),
    "scheme.h_min": (_same, ("rheology.grain_diameter",)),
}
"""The formula of a default by key, and the keys whose values it takes."""


def default(key: str, value: Callable[[str], Any]) -> Any:
    """The default of a key, given what says the values of others: `value("grid.left")`."""
    formula, keys = FOLLOWS[key]
    return formula(*(value(other) for other in keys))
