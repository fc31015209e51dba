"""Defaults that follow from other keys, as formulas that take the values of one run or arrays over runs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np


def _column_start(left: Any) -> Any:
    return left


def _h_min(order: Any, grain_diameter: Any) -> Any:
    return np.where(np.equal(order, 1), 1.0, 5.0) * grain_diameter


def _h_front(grain_diameter: Any) -> Any:
    return 2.0 * grain_diameter


def _rest_speed(gravity: Any, angle: Any, height: Any) -> Any:
    return 1e-3 * np.sqrt(gravity * np.cos(np.radians(angle)) * height)


FOLLOWS: dict[str, tuple[Callable[..., Any], tuple[str, ...]]] = {
    "column.start": (_column_start, ("grid.left",)),
    "scheme.h_min": (_h_min, ("scheme.order", "rheology.grain_diameter")),
    "scheme.h_front": (_h_front, ("rheology.grain_diameter",)),
    "time.rest_speed": (_rest_speed, ("slope.gravity", "slope.angle", "column.height")),
}
"""By key the formula of its default, and the keys whose values it takes. `column.height` is that of a profile too."""


def default(key: str, value: Callable[[str], Any]) -> Any:
    """The default of a key, given the values of others: `value("grid.left")`."""
    formula, keys = FOLLOWS[key]
    return formula(*(value(other) for other in keys))
