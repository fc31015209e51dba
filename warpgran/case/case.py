"""One run of the model, validated and frozen: how a case is made, changed and compared, its grid and initial state.

Keys, defaults and ranges are in `warpgran.case.sections`, what must fit between keys in `warpgran.case.between_keys`.
"""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import PrivateAttr, StrictStr, ValidationError, model_validator

from warpgran.arrays import Array
from warpgran.case.between_keys import cross_problems
from warpgran.case.model import Model, declare
from warpgran.case.problems import CaseError, Problem, problems_of, shown
from warpgran.case.sections import ALLOWED, SECTIONS, Column, Every, Grid, Rheology, Scheme, Slope, Time
from warpgran.case.tables import TableError, read_bed, read_profile
from warpgran.case.times import output_times, sample_times, snapshot_times
from warpgran.case.toml import given, load, override, plain, put, text_of, without

if TYPE_CHECKING:
    from warpgran.case.study import Study

__all__ = ["Case", "CaseError", "Column", "Every", "Grid", "Problem", "Rheology", "Scheme", "Slope", "Time"]


class Case(Model):
    """One run. Make it with `from_toml` or `from_dict`, change it with `with_`, make many of it with `sweep`.

    Raises:
        CaseError: With all that is wrong.
    """

    title: StrictStr = declare("", "title")
    """A line for people: pictures and tables show it."""
    rheology: Rheology = Rheology()
    slope: Slope = Slope()
    column: Column = Column()
    grid: Grid = Grid()
    time: Time = Time()
    scheme: Scheme = Scheme()

    _source: str = PrivateAttr("")
    _folder: Path = PrivateAttr(Path("."))

    def __init__(self, **data: Any) -> None:
        """Check sections given as models or mappings: `Case(slope={"angle": 22.0})`."""
        try:
            super().__init__(**data)
        except ValidationError as error:
            raise CaseError(problems_of(error, ALLOWED)) from None

    @model_validator(mode="after")
    def _cross_checks(self) -> Case:
        problems = list(cross_problems(self.rheology, self.slope, self.column, self.grid, self.time, self.scheme))
        if problems:
            raise CaseError(problems)
        return self

    @classmethod
    def from_toml(cls, path: str | os.PathLike[str], overrides: Sequence[str] = ()) -> Case:
        """Read a run file.

        Args:
            path: The file, UTF-8. Paths in it start from its folder.
            overrides: `KEY=VALUE` with a dotted key and a value in TOML; what is no TOML is taken as text. They replace
                the file's values before anything is checked.

        Raises:
            CaseError: With all that is wrong, each line beginning with the file's name.
        """
        where = os.fspath(path)
        source, data = load(where)
        problems = [problem for text in overrides if (problem := override(data, text))]
        return cls._checked(data, problems, Path(where).parent, source, where)

    @classmethod
    def from_dict(cls, mapping: Mapping[str, Any], folder: str | os.PathLike[str] = ".") -> Case:
        """Make a case of nested mappings with the keys of the run file.

        Args:
            mapping: Sections of keys; NumPy numbers are taken as numbers.
            folder: What relative paths in it start from.

        Raises:
            CaseError: With all that is wrong.
        """
        return cls._checked(mapping, [], Path(folder))

    def with_(self, **changes: Any) -> Case:
        """The same case with other values, checked again: `case.with_(**{"slope.angle": 16.0})`.

        Args:
            changes: Values by dotted key; None takes a key back to its default. Tables that were read stay as they are.

        Raises:
            CaseError: With all that is wrong.
        """
        data = given(self)
        problems = [problem for key, value in changes.items() if (problem := put(data, key, value))]
        return self._checked(data, problems, self._folder, self._source)

    def sweep(
        self, over: Mapping[str, Any], *, mode: str = "product", samples: int | None = None, seed: int = 1
    ) -> Study:
        """Many cases out of this one: `case.sweep({"slope.angle": [0, 10, 16, 22]})`.

        Args:
            over: By dotted key a list of values (product, zip) or `{"low": a, "high": b}` (latin, sobol).
            mode: product, zip, latin or sobol, as in the `[sweep]` section of a run file.
            samples: Number of runs for latin and sobol.
            seed: Of the samples.

        Raises:
            CaseError: With all that is wrong with the sweep or with any of its runs.
        """
        from warpgran.case.read_study import sweep

        return sweep(self, over, mode=mode, samples=samples, seed=seed)

    @classmethod
    def _checked(cls, data: Any, problems: list[Problem], folder: Path, source: str = "", where: str = "") -> Case:
        """A case, or all that is wrong with the data beside the problems already found."""
        if not isinstance(data, Mapping):
            raise CaseError([Problem("", f"{shown(data)} is not a table of sections")], where)
        data = given(data)
        problems = [*problems, *_misplaced(data), *read_tables(data, folder)]
        # What depends on several keys can be judged only where those are valid: take out the others and look again.
        for _ in range(2):
            bad = {_field(problem.key) for problem in problems if problem.key}
            try:
                case = cls(**without(data, bad))
            except CaseError as error:
                problems += [p for p in error.problems if not any(_touches(key, bad) for key in (p.key, *p.involves))]
                if any(problem.involves for problem in error.problems):
                    break
            else:
                if problems:
                    break
                case._source, case._folder = source, folder
                return case
        raise CaseError(problems, where)

    @property
    def source(self) -> str:
        """The run file's whole text, "" for a case that came from none."""
        return self._source

    @property
    def folder(self) -> Path:
        """What relative paths start from."""
        return self._folder

    @property
    def column_start(self) -> float:
        """Left end of the column, m."""
        return self.column.start_on(self.grid)

    @property
    def h_min(self) -> float:
        """Least thickness in the shear rate, m."""
        return self.rheology.grain_diameter if self.scheme.h_min is None else self.scheme.h_min

    @property
    def dx(self) -> float:
        """Cell size, m."""
        return self.grid.dx

    @property
    def g_c(self) -> float:
        """Gravity normal to the plane, g cos(theta), m s-2."""
        return self.slope.gravity * math.cos(math.radians(self.slope.angle))

    @property
    def x(self) -> Array:
        """Cell centres left + (i + 1/2) dx, m, shape (cells,)."""
        return self.grid.x

    @property
    def bed(self) -> Array:
        """Bed elevation b normal to the plane at the cell centres, m, shape (cells,)."""
        table = self.slope.bed
        return np.zeros(self.grid.cells) if table is None else np.interp(self.x, table.x, table.b)

    @property
    def bhat(self) -> Array:
        """Total bed b - x tan(theta) at the cell centres, m, shape (cells,)."""
        return self.bed - self.x * math.tan(math.radians(self.slope.angle))

    @property
    def dbhat(self) -> Array:
        """Jump of the total bed at the interfaces, m, shape (cells + 1,): 0 at the two ends, which have one side.

        Periodic ends are one interface, whose sides are the last cell and the first: the bed jumps there by
        b(first) - b(last) - dx tan(theta). The slope then weighs the same, to the bit, at every interface.
        """
        if not self.scheme.periodic:
            return np.concatenate(([0.0], np.diff(self.bhat), [0.0]))
        bed = self.bed
        jumps = np.diff(bed, prepend=bed[-1], append=bed[0])
        return jumps - self.dx * math.tan(math.radians(self.slope.angle))

    def initial_state(self) -> tuple[Array, Array]:
        """Thickness h, m, and solid volume fraction phi at the cell centres at time 0, each of shape (cells,).

        Outside the column h is `scheme.h_bed` and phi goes on.
        """
        profile = self.column.profile
        h = np.maximum(self.column.thickness_on(self.grid), self.scheme.h_bed)
        if profile is None or profile.phi is None:
            return h, np.full(self.grid.cells, self.column.phi)
        return h, np.interp(self.x, profile.x, profile.phi)

    def initial_velocity(self) -> Array:
        """Velocity at the cell centres at time 0, m/s, shape (cells,); 0 but for a profile with a column v."""
        profile = self.column.profile
        if profile is None or profile.v is None:
            return np.zeros(self.grid.cells)
        return np.interp(self.x, profile.x, profile.v, left=0.0, right=0.0)

    @property
    def snapshot_times(self) -> tuple[float, ...]:
        """Times of whole profiles, s, increasing."""
        return snapshot_times(self.time)

    @property
    def sample_times(self) -> tuple[float, ...]:
        """Times of the scalar series, s, increasing. One that is also a snapshot's has its value to the bit."""
        return sample_times(self.time)

    @property
    def output_times(self) -> tuple[float, ...]:
        """Every time at which the run stops to be looked at, s: snapshots, samples and the end."""
        return output_times(self.time)

    def _in_force(self) -> dict[str, Any]:
        """Every value in force by dotted key; None for a key that has no part in this case."""
        values: dict[str, Any] = {"title": self.title}
        for section, model in SECTIONS.items():
            for name, key in model.keys().items():
                values[f"{section}.{key}"] = getattr(getattr(self, section), name)
        values["column.start"] = self.column_start
        values["scheme.h_min"] = self.h_min
        for key, times in (("time.snapshots", self.time.snapshots), ("time.series", self.time.series)):
            if isinstance(times, Every):
                values[key] = Every(every=min(times.every, self.time.end))
            elif times is None:
                values[key] = self.snapshot_times
        if self.column.profile is not None:
            values |= dict.fromkeys(("column.height", "column.length", "column.start"))
            if self.column.profile.phi is not None:
                values["column.phi"] = None
        return values

    def flat(self) -> dict[str, Any]:
        """Every value in force by dotted key, as plain Python data; None for a key that has no part in this case."""
        return {key: plain(value) for key, value in self._in_force().items()}

    def to_toml(self) -> str:
        """Every value in force as a run file, which gives an equal case when read from `folder`."""
        return text_of(self.flat())

    def __eq__(self, other: object) -> bool:
        return self._in_force() == other._in_force() if isinstance(other, Case) else NotImplemented

    def __hash__(self) -> int:
        return hash(tuple(self._in_force().values()))


def _misplaced(data: dict[str, Any]) -> list[Problem]:
    """Take out, and tell of, what looks like a section and is none."""
    problems = []
    for key in [key for key in data if "." in key]:
        del data[key]
        section, _, name = key.partition(".")
        problems.append(Problem(f'"{key}"', f"unknown key; write {name} under [{section}]"))
    if "sweep" in data:
        del data["sweep"]
        message = "is a sweep of several runs, and a case is one; read such a file with warpgran.read_study"
        problems.append(Problem("sweep", message))
    return problems


def read_tables(data: dict[str, Any], folder: Path) -> list[Problem]:
    """Put tables in place of their paths, which start from the folder, and tell of those that cannot be read."""
    problems = []
    for section, key, read in (("slope", "bed", read_bed), ("column", "profile", read_profile)):
        keys = data.get(section)
        if isinstance(keys, dict) and isinstance(keys.get(key), str | os.PathLike):
            try:
                keys[key] = read(keys[key], folder)
            except TableError as error:
                problems += [Problem(f"{section}.{key}", message) for message in error.messages]
    return problems


def _field(key: str) -> str:
    """`time.snapshots` of `time.snapshots[2]` and of `time.snapshots.every`."""
    return ".".join(key.partition("[")[0].split(".")[:2])


def _touches(key: str, bad: set[str]) -> bool:
    """Whether the key, or the section that it is in, is among the bad."""
    field = _field(key)
    return field in bad or field.partition(".")[0] in bad
