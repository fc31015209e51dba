"""Rules that involve several keys, e.g. mu2 >= mu1."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from warpgran.case.defaults import default
from warpgran.case.problems import Problem
from warpgran.case.sections import KEYS, Column, Every, Grid, Rheology, Scheme, Slope, Time
from warpgran.case.tables import ProfileTable, Table
from warpgran.case.times import SAME_TIME

MOST_TIMES = 1_000_000
MOST_CELLS = 10_000_000
"""Most cells of the finest level of a start."""
MOST_RELAXATION = {"f0": 20.0, "f1": 60.0, "f2": 60.0}
"""Largest 2.5 cfl K dx/h_min of an exponential relaxation, by phi_eq; docs/limits.md says what happens above it."""
_ENDS = ("grid.left", "grid.right")
_RELAXATION_KEYS = (
    "rheology.K", "rheology.phi_eq", "rheology.phi_eq_N", "rheology.grain_diameter", "scheme.cfl", "scheme.h_min",
    "grid.cells", *_ENDS,
)  # fmt: skip


def cross_problems(
    rheology: Rheology, slope: Slope, column: Column, grid: Grid, time: Time, scheme: Scheme
) -> Iterator[Problem]:
    """Every broken rule, with all keys that it involves."""
    if rheology.mu2 < rheology.mu1:
        allowed = f">= rheology.mu1, which is {rheology.mu1}"
        yield _out_of_range("rheology.mu2", rheology.mu2, allowed, "rheology.mu1")
    if scheme.xi[1] > scheme.xi[0]:
        message = f"{list(scheme.xi)} diffuses momentum faster than mass, which makes velocities out of nothing"
        yield Problem("scheme.xi", f"{message}; allowed: three numbers >= 0, the second <= the first")
    yield from _order_problems(scheme)
    if (scheme.left == "periodic") != (scheme.right == "periodic"):
        yield _half_periodic(scheme)
    yield from _time_problems(time)
    problem = _grid_problem(grid)
    if problem:
        yield problem
        return  # nothing can be placed on such a grid
    if grid.cells * 2**scheme.start_levels > MOST_CELLS:
        allowed = f"grid.cells 2^start <= {MOST_CELLS}, with grid.cells {grid.cells}"
        yield _out_of_range("scheme.start", scheme.start, allowed, "grid.cells", "scheme.order")
    if slope.bed is not None and not _overlap(slope.bed, grid):
        yield _no_overlap("slope.bed", slope.bed, grid)
    if column.profile is None:
        yield from _rectangle_problems(column, grid)
    else:
        yield from _profile_problems(column, column.profile, grid)
    yield from _layer_problems(column, scheme)
    yield from _relaxation_problems(rheology, grid, scheme)


def _out_of_range(key: str, value: Any, allowed: str, *involves: str) -> Problem:
    return Problem(key, f"{value} is out of range; allowed: {allowed}", involves)


def _order_problems(scheme: Scheme) -> Iterator[Problem]:
    for name, key in Scheme.keys().items():
        order = KEYS[f"scheme.{key}"].order
        if name in scheme.model_fields_set and order not in (None, scheme.order):
            message = f"has no part in the scheme of order {scheme.order}; take it out, or set scheme.order = {order}"
            yield Problem(f"scheme.{key}", message, ("scheme.order",))


def _half_periodic(scheme: Scheme) -> Problem:
    key, other = ("scheme.left", "scheme.right") if scheme.left == "periodic" else ("scheme.right", "scheme.left")
    value = scheme.right if scheme.left == "periodic" else scheme.left
    return Problem(key, f'"periodic" needs both ends to be periodic, and {other} is "{value}"', (other,))


def _grid_problem(grid: Grid) -> Problem | None:
    if not grid.left < grid.right:
        return _out_of_range("grid.left", grid.left, f"< grid.right, which is {grid.right}, in m", "grid.right")
    if not math.isfinite(grid.dx) or grid.dx < 1e-12 * max(abs(grid.left), abs(grid.right)):
        message = f"{grid.cells} cells from {grid.left} to {grid.right} m are beyond the precision of numbers"
        return Problem("grid.cells", message, _ENDS)
    return None


def _time_problems(time: Time) -> Iterator[Problem]:
    for name, times in (("snapshots", time.snapshots), ("series", time.series)):
        key = f"time.{name}"
        if isinstance(times, Every):
            yield from _every_problems(f"{key}.every", times.every, time.end)
        elif times is not None:
            yield from _list_problems(key, times, time.end)


def _every_problems(key: str, every: float, end: float) -> Iterator[Problem]:
    if every > end:
        yield _out_of_range(key, every, f"> 0 and <= time.end, which is {end}, in s", "time.end")
    elif end / every * (1 + SAME_TIME) >= MOST_TIMES:  # and one at time 0
        yield Problem(key, f"{every} gives more than {MOST_TIMES} times up to time.end, which is {end}", ("time.end",))


def _list_problems(key: str, times: tuple[float, ...], end: float) -> Iterator[Problem]:
    if len(times) > MOST_TIMES:
        yield Problem(key, f"has {len(times)} times; allowed: {MOST_TIMES}")
        return
    for i, time in enumerate(times):
        if time > end:
            yield _out_of_range(f"{key}[{i}]", time, f">= 0 and <= time.end, which is {end}, in s", "time.end")
        elif i > 0 and time - times[i - 1] <= 2 * SAME_TIME * end:
            message = f"{time} comes after {times[i - 1]}; allowed: strictly increasing times, in s"
            yield Problem(f"{key}[{i}]", message, ("time.end",))


def _rectangle_problems(column: Column, grid: Grid) -> Iterator[Problem]:
    involves = ("column.profile", "column.start", "column.length", *_ENDS)
    start, stop = column.start_on(grid), column.start_on(grid) + column.length
    rounding = 1e-12 * (grid.right - grid.left)
    if start < grid.left - rounding or stop > grid.right + rounding:
        key = "column.length" if column.start is None else "column.start"
        message = f"the column from {start:.12g} to {stop:.12g} m is not inside the grid"
        yield Problem(key, f"{message}; allowed: {grid.left} to {grid.right} m", involves)
    elif not column.thickness_on(grid).any():
        message = f"the column from {start:.12g} to {stop:.12g} m covers no cell centre"
        yield Problem("column.length", f"{message}; cells are {grid.dx:.3g} m long", (*involves, "grid.cells"))


def _profile_problems(column: Column, profile: ProfileTable, grid: Grid) -> Iterator[Problem]:
    for name in ("height", "length", "start") if profile.phi is None else ("height", "length", "start", "phi"):
        if name in column.model_fields_set:
            message = "has no part beside column.profile, which gives it; take one of them out"
            yield Problem(f"column.{name}", message, ("column.profile",))
    if not _overlap(profile, grid):
        yield _no_overlap("column.profile", profile, grid)
    elif not column.thickness_on(grid).any():
        yield Problem("column.profile", "is 0 at every cell centre", (*_ENDS, "grid.cells"))


def _layer_problems(column: Column, scheme: Scheme) -> Iterator[Problem]:
    if scheme.h_bed >= column.greatest_height:
        allowed = f">= 0 and < the column's height, which is {column.greatest_height}, in m"
        yield _out_of_range("scheme.h_bed", scheme.h_bed, allowed, "column.height", "column.profile")


def _relaxation_problems(rheology: Rheology, grid: Grid, scheme: Scheme) -> Iterator[Problem]:
    """The exponential relaxation lets phi fall to nothing in a step where phi_eq vanishes in fast flow."""
    if scheme.relaxation != "exponential" or scheme.order != 1:  # of order 2 it is refused whatever it does
        return
    vanishes = rheology.phi_eq != "f2" or rheology.phi_eq_N > 2.0
    values = {"scheme.order": scheme.order, "rheology.grain_diameter": rheology.grain_diameter}
    h_min = default("scheme.h_min", values.__getitem__) if scheme.h_min is None else scheme.h_min
    exponent = 2.5 * scheme.cfl * rheology.K * grid.dx / h_min  # of (3.18) over phi, at the longest step
    most = MOST_RELAXATION[rheology.phi_eq]
    if vanishes and exponent > most:
        message = (
            f'"exponential" takes phi to nothing in one step of a thin cell: 2.5 cfl K dx/h_min is {exponent:.3g}; '
            f'allowed: <= {most:g} with {rheology.phi_eq}; take "rational", or smaller cells'
        )
        yield Problem("scheme.relaxation", message, _RELAXATION_KEYS)


def _overlap(table: Table, grid: Grid) -> bool:
    return bool(table.x[0] < grid.right and table.x[-1] > grid.left)


def _no_overlap(key: str, table: Table, grid: Grid) -> Problem:
    message = f"x from {table.x[0]:g} to {table.x[-1]:g} m lies outside the grid"
    return Problem(key, f"{message}; allowed: an overlap with {grid.left} to {grid.right} m", _ENDS)
