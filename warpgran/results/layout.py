"""The layout of a result: its variables, their shapes and types, and their values from what an engine returns."""

from __future__ import annotations

import platform
from collections.abc import Sequence
from datetime import UTC, datetime
from importlib.metadata import version
from typing import Any, NamedTuple

import numpy as np

from warpgran.analysis.run_values import final_values, run_values
from warpgran.arrays import Array
from warpgran.case.case import Case
from warpgran.case.identity import identity
from warpgran.case.problems import CaseError, Problem
from warpgran.case.sections import KEYS
from warpgran.case.study import Study
from warpgran.results.series import Samples, check_sources, series
from warpgran.schema import COORDINATES, FIELDS, GRID, PER_RUN, SCHEMA_VERSION, SERIES, Status, Variable
from warpgran.solve.finished import SCALARS, Finished
from warpgran.solve.schedule import Outputs

FAILURE = np.dtype("S200")
"""Text that says how a run diverged."""
UNITS = {"": "1", "degrees": "degree", "m/s": "m s-1", "m/s2": "m s-2"}
"""Units of the run file that the CF conventions write in another way."""


class ResultColumn(NamedTuple):
    """A variable with a first dimension of runs: its schema, and the shape and type of one run's part."""

    schema: Variable
    shape: tuple[int, ...]
    dtype: np.dtype[Any]


class Layout:
    """The variables of a result of some runs of a study, known before anything is computed.

    Attributes:
        study: The whole study.
        runs: Numbers of the runs in this result, in increasing order.
        outputs: The output times that they share.
        cells: Number of cells of the largest grid.
        one_grid: Whether all runs have the same cells and bed.
        keys: The keys in which the runs differ.
        columns: The variables with a first dimension of runs, by name.
    """

    def __init__(self, study: Study, runs: Sequence[int] | None = None) -> None:
        """Lay out a result of the runs given, by default of the whole study.

        Raises:
            CaseError: The runs do not share their output times.
            NotImplementedError: A series of the schema has no source.
        """
        check_sources()
        self.study = study
        self.runs = np.arange(len(study)) if runs is None else np.asarray(runs)
        self.outputs = Outputs.of(study.base)
        self.one_grid, self.cells = True, study.base.grid.cells
        if study.given:
            _check_times(study.given)
            self.cells = max(case.grid.cells for case in study.given)
            x, bed = study.base.x, study.base.bed
            self.one_grid = all(np.array_equal(c.x, x) and np.array_equal(c.bed, bed) for c in study.given)
        elif any(key.startswith("grid.") for key in study.keys):
            self.one_grid = False
            self.cells = max(study.values("grid.cells")) if "grid.cells" in study.keys else self.cells
        self.keys = tuple(study.parameters())
        self.columns = self._columns()

    def _columns(self) -> dict[str, ResultColumn]:
        real = np.dtype(np.float64)
        profile = self.outputs.snapshots, self.cells
        fields = {name: ResultColumn(self._along(v), profile, real) for name, v in FIELDS.items()}
        series = {name: ResultColumn(v, (self.outputs.series,), real) for name, v in SERIES.items()}
        types: dict[str, np.dtype[Any]] = {"status": np.dtype(np.int8), "steps": np.dtype(np.int64), "failure": FAILURE}
        single = {name: ResultColumn(v, (), types.get(name, real)) for name, v in PER_RUN.items()}
        grid = {} if self.one_grid else {name: ResultColumn(v.padded, (self.cells,), real) for name, v in GRID.items()}
        return {**fields, **series, **single, **grid}

    def _along(self, variable: Variable) -> Variable:
        return variable if self.one_grid else variable.padded

    def rows(self, cases: Sequence[Case], finished: Finished) -> dict[str, Array]:
        """The columns of runs that have ended, every array with a first dimension of runs."""
        rows = {
            name: _wide(profile, self.cells, [case.grid.cells for case in cases])
            for name, profile in zip(FIELDS, finished.profiles, strict=True)
        }
        t = self.outputs.times[self.outputs.sample_at >= 0]
        of_series, at_end = slice(self.outputs.series), slice(-1, None)
        rows |= _series(cases, t, finished, of_series)
        rows |= run_values(t[of_series], rows, np.array([case.rest_speed for case in cases]))
        rows |= final_values(rows, _series(cases, t, finished, at_end))
        rows |= {"status": finished.status, "steps": finished.steps, "end_time": finished.end_time}
        words = [str(finished.failures[r]) if r in finished.failures else "" for r in range(len(cases))]
        rows["failure"] = np.array([word.encode() for word in words], dtype=FAILURE)
        if not self.one_grid:
            for name in GRID:
                rows[name] = np.full((len(cases), self.cells), np.nan)
                for row, case in zip(rows[name], cases, strict=True):
                    row[: case.grid.cells] = getattr(case, name)
        return rows

    def dimensions(self) -> dict[str, tuple[Variable, Array]]:
        """The dimensions, each with its values."""
        times = self.outputs.times
        values = {
            "run": self.runs,
            "time": times[self.outputs.snapshot_at >= 0],
            "series_time": times[self.outputs.sample_at >= 0][: self.outputs.series],
            **({"x": self.study.base.x} if self.one_grid else {"cell": np.arange(self.cells)}),
        }
        return {name: (COORDINATES[name], each) for name, each in values.items()}

    def shared(self) -> dict[str, tuple[Variable, Array]]:
        """The variables that all runs share: the bed if there is one grid."""
        return {"bed": (GRID["bed"], self.study.base.bed)} if self.one_grid else {}

    def parameters(self) -> dict[str, tuple[Variable, Array]]:
        """The keys in which the runs differ, each with its value in every run."""
        runs = self.runs.tolist()
        return {key: (_key(key), _column([values[r] for r in runs])) for key, values in self.study.parameters().items()}

    def coordinates(self, name: str) -> list[str]:
        """The coordinates of a column of the runs that are no dimensions, as its attribute of the CF conventions."""
        along = [] if self.one_grid or name == "x" or "cell" not in self.columns[name].schema.dims else ["x"]
        return [*along, *self.keys]

    def attributes(self, **more: Any) -> dict[str, Any]:
        """Attributes of the whole result."""
        base, date = self.study.base, now()
        return {
            "Conventions": "CF-1.11",
            "title": base.title,
            "source": f"warpgran {version('warpgran')}",
            "history": f"{date} computed by warpgran {version('warpgran')}",
            "schema_version": SCHEMA_VERSION,
            "run_file": self.study.source,
            "case_toml": base.to_toml(),
            **({"sensitivity": self.study.design} if self.study.design else {}),
            "identity": identity(base),
            "study_runs": len(self.study),
            "warpgran_version": version("warpgran"),
            "warp_version": version("warp-lang"),
            "numpy_version": version("numpy"),
            "python_version": platform.python_version(),
            "date": date,
            **more,
        }


def _series(cases: Sequence[Case], t: Array, finished: Finished, which: slice) -> dict[str, Array]:
    """The series at some of the samples."""
    scalars = dict(zip(SCALARS, np.moveaxis(finished.scalars[:, which], 2, 0), strict=True))
    return series(Samples(cases, t[which], scalars))


def now() -> str:
    """The date and time, UTC."""
    return datetime.now(UTC).isoformat(timespec="seconds")


def status_attributes() -> dict[str, Any]:
    """Meaning of the status codes, as the CF conventions have it."""
    return {
        "flag_values": np.array([int(s) for s in Status], dtype=np.int8),
        "flag_meanings": " ".join(s.word for s in Status),
    }


def _key(key: str) -> Variable:
    """The variable of a key of the run file."""
    unit = KEYS[key].unit
    return Variable(("run",), UNITS.get(unit, unit), KEYS[key].name)


def _column(values: list[Any]) -> Array:
    return np.array(values, dtype=object if isinstance(values[0], str) else None)


def _check_times(cases: Sequence[Case]) -> None:
    if len({(case.snapshot_times, case.sample_times, case.time.end) for case in cases}) != 1:
        raise CaseError([Problem("", "the cases of a batch must share time.snapshots, time.series and time.end")])


def _wide(profile: Array, cells: int, each: Sequence[int]) -> Array:
    """Profiles (runs, snapshots, any) as (runs, snapshots, cells), NaN beyond the cells of each run."""
    wide = np.full((*profile.shape[:2], cells), np.nan)
    for row, source, n in zip(wide, profile, each, strict=True):
        row[:, :n] = source[:, :n]
    return wide
