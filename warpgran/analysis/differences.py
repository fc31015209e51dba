"""Differences between runs of two results: of the values of a run, and the largest of its series and profiles."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from warpgran.arrays import Array
from warpgran.schema import FIELDS, PER_RUN, SERIES

VALUES = tuple(name for name in PER_RUN if name not in ("status", "failure"))
"""Values of each run that are numbers."""
GROUP = 2**26
"""Bytes of profiles that are read at once from either result."""

Parameters = Mapping[str, Sequence[Any]]
"""By dotted key its value in each run."""
Pairs = list[tuple[int, int]]
"""Places in two results of the runs that are compared with each other."""


class Largest(NamedTuple):
    """The largest difference of a quantity between two runs, or the difference of one that has a single value.

    Attributes:
        run_a: Number of the run in a.
        run_b: Number of the run in b.
        quantity: Its name in the result.
        a: What it is in a there and then, in the units of the result.
        b: What it is in b.
        difference: b - a; NaN where nothing can be compared, as after a divergence.
        time: When, s; NaN of a single value.
        x: Where, m; NaN of a series and of a single value.
        identical: Whether all that was compared is the same bit for bit.
    """

    run_a: int
    run_b: int
    quantity: str
    a: float
    b: float
    difference: float
    time: float
    x: float
    identical: bool


@dataclass
class Grids:
    """How many pairs of runs were found on different grids, and on one grid with different beds."""

    differ: int = 0
    beds: int = 0


def common_times(a: Array, b: Array) -> tuple[Array, Array]:
    """Places in a and in b of the times that both have, but for rounding."""
    if not b.size:
        return np.zeros(0, int), np.zeros(0, int)
    after = np.searchsorted(b, a).clip(max=b.size - 1)
    before = (after - 1).clip(min=0)
    nearest = np.where(np.abs(b[before] - a) < np.abs(b[after] - a), before, after)
    common = np.flatnonzero(np.isclose(b[nearest], a, rtol=1e-9, atol=0.0))
    return common, nearest[common]


def _same(a: Array, b: Array) -> Array:
    """Whether numbers are the same bit for bit, any NaN like any other."""
    return ((a == b) & (np.signbit(a) == np.signbit(b))) | (np.isnan(a) & np.isnan(b))


def of_values(a: xr.Dataset, b: xr.Dataset, pairs: Pairs) -> Iterator[Largest]:
    """The differences of what has a single value in each run."""
    i, j = np.array(pairs).T
    for name in VALUES:
        of_a, of_b = (data[name].values[at].astype(float) for data, at in ((a, i), (b, j)))
        same = _same(of_a, of_b)
        for k, numbers in enumerate(_numbers(a, b, pairs)):
            x, y = float(of_a[k]), float(of_b[k])
            yield Largest(*numbers, name, x, y, y - x, np.nan, np.nan, bool(same[k]))


def of_series(a: xr.Dataset, b: xr.Dataset, pairs: Pairs) -> Iterator[Largest]:
    """The largest difference of each series at the times that both have."""
    i, j = np.array(pairs).T
    at_a, at_b = common_times(a["series_time"].values, b["series_time"].values)
    t, nowhere = a["series_time"].values[at_a], np.array([np.nan])
    for name in SERIES:
        of_a, of_b = (
            data[name].transpose("run", "series_time").values[np.ix_(runs, at)]
            for data, runs, at in ((a, i, at_a), (b, j, at_b))
        )
        same = np.all(_same(of_a, of_b), axis=1)
        for k, numbers in enumerate(_numbers(a, b, pairs)):
            yield _largest(numbers, name, of_a[k, :, None], of_b[k, :, None], t, nowhere, bool(same[k]))


def of_fields(
    a: xr.Dataset, b: xr.Dataset, pairs: Pairs, parameters: tuple[Parameters, Parameters], grids: Grids
) -> Iterator[Largest]:
    """The largest difference of h, v and phi at the times that both have; counts the grids that differ.

    Args:
        a: A result.
        b: Another.
        pairs: runs to compare.
        parameters: of either.
        grids: Where pairs on different grids, or on different beds, are counted.
    """
    at_a, at_b = common_times(a["time"].values, b["time"].values)
    t, numbers = a["time"].values[at_a], _numbers(a, b, pairs)
    row = max(8 * len(FIELDS) * data["h"][0].size for data in (a, b))
    group = max(1, GROUP // max(row, 1))
    for begin in range(0, len(pairs), group):
        i, j = np.array(pairs[begin : begin + group]).T
        profiles = _profiles(a, i, at_a), _profiles(b, j, at_b)
        for k in range(i.size):
            one, other = (_Profile.of(each, k) for each in profiles)
            same_grid = np.array_equal(one.x, other.x)
            grids.differ += not same_grid
            grids.beds += same_grid and not np.array_equal(one.bed, other.bed)
            same = {name: same_grid and bool(_same(one.fields[name], other.fields[name]).all()) for name in FIELDS}
            if not same_grid:
                x = _coarser(one.x, other.x)
                one, other = one.at(x), other.at(x)
            flowing = one.flowing(parameters[0], i[k]) & other.flowing(parameters[1], j[k])
            for name in FIELDS:
                where = True if name == "h" else flowing
                of_a, of_b = (np.where(where, each.fields[name], np.nan) for each in (one, other))
                yield _largest(numbers[begin + k], name, of_a, of_b, t, one.x, same[name])


def _numbers(a: xr.Dataset, b: xr.Dataset, pairs: Pairs) -> list[tuple[int, int]]:
    """The numbers of the runs of each pair."""
    i, j = np.array(pairs).T
    return list(zip(a["run"].values[i].tolist(), b["run"].values[j].tolist(), strict=True))


def _profiles(data: xr.Dataset, runs: Array, times: Array) -> dict[str, Array]:
    """x and bed (runs, cells), and h, v and phi (runs, times, cells)."""
    part = data[["bed", *FIELDS]].isel(run=runs, time=times).transpose("run", "time", ..., missing_dims="ignore")
    grid = {name: np.broadcast_to(part[name].values, (runs.size, part[name].shape[-1])) for name in ("x", "bed")}
    return grid | {name: part[name].values for name in FIELDS}


class _Profile(NamedTuple):
    """x [m] and bed [m] of the cells of a run, and h, v and phi, each (times, cells)."""

    x: Array
    bed: Array
    fields: dict[str, Array]

    @classmethod
    def of(cls, profiles: dict[str, Array], k: int) -> _Profile:
        """Of the k-th run, without the cells that only pad its grid."""
        cells = np.isfinite(profiles["x"][k])
        x, bed = (profiles[name][k, cells] for name in ("x", "bed"))
        return cls(x, bed, {name: profiles[name][k][:, cells] for name in FIELDS})

    def at(self, x: Array) -> _Profile:
        """Interpolated linearly in x."""
        fields = {name: [np.interp(x, self.x, row) for row in values] for name, values in self.fields.items()}
        return _Profile(x, self.bed, {name: np.reshape(rows, (-1, x.size)) for name, rows in fields.items()})

    def flowing(self, parameters: Parameters, run: int) -> Array:
        """Where the compacted thickness exceeds h_front, as the front has it."""
        phi_stat, h_front = (
            parameters[key][run] if key in parameters else default
            for key, default in (("rheology.phi_stat", 1.0), ("scheme.h_front", 0.0))
        )
        return np.asarray(self.fields["h"] * self.fields["phi"] > h_front * phi_stat)


def _coarser(a: Array, b: Array) -> Array:
    """The cell centres of the coarser grid that lie within both."""
    coarse, fine = (a, b) if np.ptp(a) * (b.size - 1) >= np.ptp(b) * (a.size - 1) else (b, a)
    rounding = 1e-9 * np.ptp(coarse)
    return np.asarray(coarse[(coarse >= fine[0] - rounding) & (coarse <= fine[-1] + rounding)])


def _largest(numbers: tuple[int, int], name: str, a: Array, b: Array, t: Array, x: Array, identical: bool) -> Largest:
    """The largest difference of arrays (times, places)."""
    with np.errstate(invalid="ignore"):
        difference = b - a
    amounts = np.where(np.isfinite(difference), np.abs(difference), -1.0)
    if not amounts.size or amounts.max() < 0.0:
        return Largest(*numbers, name, np.nan, np.nan, np.nan, np.nan, np.nan, identical)
    time, place = np.unravel_index(np.argmax(amounts), amounts.shape)
    of_a, of_b, largest = (float(each[time, place]) for each in (a, b, difference))
    return Largest(*numbers, name, of_a, of_b, largest, float(t[time]), float(x[place]), identical)
