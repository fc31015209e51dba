"""The identity of a case: a hash that names its result, whatever its number in a batch."""

from __future__ import annotations

import hashlib
import json
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from warpgran.case.sections import Time
from warpgran.case.tables import Table
from warpgran.case.times import sample_times, snapshot_times

if TYPE_CHECKING:
    from warpgran.case.case import Case


LEFT_OUT = ("title", "scheme.window", "time.snapshots", "time.series")
"""Keys that decide nothing of the flow. The output times are part of an identity as times, however they are given."""


def identity(case: Case) -> str:
    """A hash of all that the result of a case depends on: 16 hexadecimal digits, the same on every machine.

    It covers every value in force, the output times and the numbers of the tables, but not the title, the paths of
    files or `scheme.window`, which gives the same bits.
    """
    values = {key: value for key, value in case.flat().items() if key not in LEFT_OUT}
    values["time.rest_speed"] = float(f"{case.rest_speed:.9g}")  # the last digits of a cosine differ between machines
    values["times"] = _times(case.time)
    values["slope.bed"] = _numbers(case.slope.bed)
    values["column.profile"] = _numbers(case.column.profile)
    return _digest(values)


@lru_cache(maxsize=16)
def _times(time: Time) -> str:
    return _digest([snapshot_times(time), sample_times(time)])


def _numbers(table: Table | None) -> Any:
    return None if table is None else {name: values.tolist() for name, values in table.columns().items()}


def _digest(values: Any) -> str:
    text = json.dumps(_without_sign_of_zero(values), sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def _without_sign_of_zero(value: Any) -> Any:
    """Cases that are equal have one identity: -0.0 equals 0.0."""
    if isinstance(value, dict):
        return {key: _without_sign_of_zero(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_without_sign_of_zero(item) for item in value]
    return value + 0.0 if isinstance(value, float) else value
