"""Experiments: a case for each slope of each folder of measurements, and what was measured of it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from warpgran.arrays import Array
from warpgran.case.calibration_section import CalibrationStudy, ExperimentKeys
from warpgran.case.case import Case
from warpgran.case.measurements import COLUMNS, MeasuredTable, read_measurements
from warpgran.case.tables import TableError

KINDS = tuple(COLUMNS)
"""The kinds of measurements: profiles, front, volume."""
UNITS = {"profiles": "m", "front": "m", "volume": "1"}


@dataclass(frozen=True)
class Observed:
    """Measurements of one kind of one experiment.

    Attributes:
        kind: One of KINDS.
        t: Times, s, shape (data,); those of a deposit are the end of the run.
        x: Positions, m, shape (data,); NaN for what has none.
        value: What was measured, in the unit of its kind, shape (data,).
        sigma: Its standard deviation, shape (data,); None if the file has no such column.
    """

    kind: str
    t: Array
    x: Array
    value: Array
    sigma: Array | None


@dataclass(frozen=True)
class Experiment:
    """One experiment.

    Attributes:
        name: As tables and figures call it.
        changes: Values by dotted key in which it differs from the other experiments, the slope included.
        observed: What was measured, a kind after the other.
    """

    name: str
    changes: Mapping[str, Any]
    observed: tuple[Observed, ...]


@dataclass(frozen=True)
class Experiments:
    """All experiments that are fitted together; their measurements are also one long vector, one after the other.

    Attributes:
        base: The case that they share, with the output times of all measurements.
        each: The experiments.
    """

    base: Case
    each: tuple[Experiment, ...]

    @property
    def size(self) -> int:
        """Number of measurements."""
        return sum(observed.value.size for _, observed in self.observed())

    def observed(self) -> Iterator[tuple[int, Observed]]:
        """Every kind of every experiment, with the number of the experiment, in the order of the long vector."""
        for number, experiment in enumerate(self.each):
            for observed in experiment.observed:
                yield number, observed

    def slices(self) -> Iterator[tuple[int, Observed, slice]]:
        """The same with the place of each in the long vector."""
        begin = 0
        for number, observed in self.observed():
            yield number, observed, slice(begin, begin + observed.value.size)
            begin += observed.value.size

    @property
    def value(self) -> Array:
        """All that was measured, shape (data,)."""
        return np.concatenate([observed.value for _, observed in self.observed()])


def read_experiments(study: CalibrationStudy, folder: Path) -> Experiments:
    """Read the measurements of every experiment of a calibration.

    Args:
        study: What is asked for.
        folder: Folder of the measurements.

    Raises:
        TableError: Lists everything that is wrong with the files.
    """
    messages: list[str] = []
    each: list[Experiment] = []
    for keys in study.experiments:
        place = folder / keys.data if keys.data else folder
        try:
            tables = read_measurements(place)
        except TableError as error:
            messages += error.messages
            continue
        messages += _unfit(tables, study.base)
        several = len(study.experiments) > 1
        each += _of_folder(tables, keys, keys.data or place.name if several else "", study.base.time.end)
    messages += _half_given(each, folder) if not messages else []
    if messages:
        raise TableError(messages)
    return Experiments(_with_times(study.base, each), tuple(each))


def _of_folder(
    tables: Mapping[str, MeasuredTable], keys: ExperimentKeys, name: str, end: float
) -> Iterator[Experiment]:
    """An experiment for each slope."""
    slopes = sorted({angle for table in tables.values() for angle in table.columns["angle"].tolist()})
    for angle in slopes:
        observed = []
        for kind, table in tables.items():
            rows = table.columns["angle"] == angle
            columns = {column: values[rows] for column, values in table.columns.items()}
            if rows.any():
                t = np.where(np.isinf(columns["t"]), end, columns["t"])
                x = columns["x"] if kind == "profiles" else np.full(t.size, np.nan)
                observed.append(Observed(kind, t, x, columns[COLUMNS[kind][-1]], columns.get("sigma")))
        yield Experiment(
            f"{name}, {angle:g}°" if name else f"{angle:g}°", {**keys.changes, "slope.angle": angle}, tuple(observed)
        )


def _unfit(tables: Mapping[str, MeasuredTable], base: Case) -> Iterator[str]:
    """Measurements with which the runs of a case cannot be compared."""
    grid = base.grid
    for name, table in tables.items():
        for i, place in enumerate(table.places):
            row = {column: float(values[i]) for column, values in table.columns.items()}
            if row["t"] != math.inf and row["t"] > base.time.end:
                yield f"{place}: t = {row['t']} is out of range; allowed: <= time.end, which is {base.time.end}"
            if name != "volume" and not grid.left <= row["x"] <= grid.right:
                within = f"{grid.left} to {grid.right} m"
                yield f"{place}: x = {row['x']} is not in the grid; allowed: {within}"


def _half_given(each: Sequence[Experiment], folder: Path) -> Iterator[str]:
    """Kinds of which some experiments have a sigma, and others have none."""
    for kind in KINDS:
        given = {o.sigma is not None for experiment in each for o in experiment.observed if o.kind == kind}
        if len(given) > 1:
            yield f"{folder}: some files {kind}.csv have a column sigma; allowed: in all of them, or in none"


def _with_times(base: Case, each: Sequence[Experiment]) -> Case:
    """The case with the times of all measurements as its output times, and no longer than the last of them."""
    profiles = [o.t for e in each for o in e.observed if o.kind == "profiles"]
    series = [o.t for e in each for o in e.observed if o.kind != "profiles"]
    snapshots, samples = _distinct(profiles, base.time.end), _distinct(series, base.time.end)
    end = max([*snapshots, *samples])
    times = {"time.end": end, "time.snapshots": snapshots, "time.series": samples or [end]}
    return base.with_(**times, title=base.title)


def _distinct(times: Sequence[Array], end: float) -> list[float]:
    """Times in increasing order; those that differ by less than a millionth of the whole are one."""
    found: list[float] = []
    for t in np.unique(np.concatenate([*times, []])).tolist():
        if not found or t - found[-1] > 1e-6 * end:
            found.append(t)
    return found
