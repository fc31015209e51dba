"""What the keys of the run file are called in figures."""

from __future__ import annotations

from typing import Any, NamedTuple

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


def named(key: str) -> Parameter:
    """What a key of the run file is called; one that is not known is called by the key."""
    if key not in KEYS:
        return Parameter(key, "")
    known = KEYS[key]
    space = "" if known.display_unit in ("", "°") else " "
    return Parameter(known.name, known.symbol and f"${known.symbol}$", space + known.display_unit, known.factor)


def shown(value: Any) -> str:
    """One value of a parameter, short."""
    return f"${value:.4g}$" if isinstance(value, float) else str(value)
