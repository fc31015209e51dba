"""What `Case.with_` takes for each section, so that editors complete it and type checkers know it.

Each key is as in `warpgran.case.sections`, which says what it means; a test holds the two together. None restores a
default.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Literal, TypedDict

from warpgran.case.sections import SECTIONS

Path = str | os.PathLike[str]
Times = Sequence[float] | Mapping[str, float]


class RheologyChanges(TypedDict, total=False):
    """Keys of `[rheology]`."""

    mu1: float | None
    mu2: float | None
    I0: float | None
    grain_diameter: float | None
    K: float | None
    K_tilde: float | None
    phi_stat: float | None
    phi_eq: Literal["f0", "f1", "f2"] | None
    phi_eq_N: float | None
    mu_wall: float | None
    channel_width: float | None


class SlopeChanges(TypedDict, total=False):
    """Keys of `[slope]`."""

    angle: float | None
    gravity: float | None
    bed: Path | Mapping[str, Any] | None


class ColumnChanges(TypedDict, total=False):
    """Keys of `[column]`."""

    height: float | None
    length: float | None
    phi: float | None
    start: float | None
    profile: Path | Mapping[str, Any] | None


class GridChanges(TypedDict, total=False):
    """Keys of `[grid]`."""

    left: float | None
    right: float | None
    cells: int | None


class TimeChanges(TypedDict, total=False):
    """Keys of `[time]`."""

    end: float | None
    snapshots: Times | None
    series: Times | None
    rest_speed: float | None
    stop_at_rest: bool | None
    step_limit: int | None


class SchemeChanges(TypedDict, total=False):
    """Keys of `[scheme]`."""

    order: int | None
    start: int | None
    alpha: float | None
    lambda_: float | None
    cfl: float | None
    relaxation: Literal["rational", "exponential"] | None
    viscosity: Literal["bounded", "paper"] | None
    xi: Sequence[float] | None
    h_min: float | None
    h_bed: float | None
    h_front: float | None
    left: Literal["wall", "open", "periodic"] | None
    right: Literal["wall", "open", "periodic"] | None
    window: bool | None


def dotted(changes: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """Changes key by key: a mapping for a section, whose names are keys or attributes, is taken apart."""
    for name, change in changes.items():
        if name in SECTIONS and isinstance(change, Mapping):
            keys = SECTIONS[name].keys()
            yield from ((f"{name}.{keys.get(key, key)}", value) for key, value in change.items())
        else:
            yield name, change
