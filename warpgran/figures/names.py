"""What the keys of the run file are called in figures."""

from __future__ import annotations

from typing import Any, NamedTuple

from warpgran.analysis.units import typical, unit_of
from warpgran.arrays import Array
from warpgran.case.sections import KEYS


class Parameter(NamedTuple):
    """How a key of the run file is called in a figure."""

    words: str
    symbol: str
    unit: str = ""
    factor: float = 1.0  # from the unit of the run file

    @property
    def label(self) -> str:
        """Words, symbol and unit."""
        return f"{self.words} {self.symbol} ({self.unit.strip() or '-'})" if self.symbol else self.words

    def value(self, value: Any) -> str:
        """Symbol, value and unit."""
        value = self.factor * value if isinstance(value, float) else value
        return f"{self.symbol or self.words} = {shown(value)}{self.unit}"


def named(key: str, values: Array | None = None) -> Parameter:
    """What a key of the run file is called; one that is not known is called by the key.

    Args:
        key: dotted.
        values: what it is in the runs; the unit of lengths suits them.
    """
    if key not in KEYS:
        return Parameter(key, "")
    known = KEYS[key]
    unit, factor = known.display_unit, known.factor
    if known.unit == "m" and values is not None:
        unit, factor = unit_of(typical(values))
    space = "" if unit in ("", "°") else " "
    return Parameter(known.name, known.symbol and f"${known.symbol}$", space + unit, factor)


def shown(value: Any) -> str:
    """One value of a parameter, short."""
    return f"${value:.4g}$" if isinstance(value, float) else str(value)
