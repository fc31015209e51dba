"""One run of the model, validated and frozen: how a case is made, changed and compared, its grid and initial state.

Keys, defaults and ranges are in `warpgran.case.sections`, rules that involve several keys in
`warpgran.case.between_keys`.
"""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from pydantic import PrivateAttr, StrictStr, ValidationError, model_validator

from warpgran.arrays import Array
from warpgran.case.between_keys import cross_problems
from warpgran.case.changes import (
    ColumnChanges,
    GridChanges,
    RheologyChanges,
    SchemeChanges,
    SlopeChanges,
    TimeChanges,
    dotted,
)
from warpgran.case.defaults import FOLLOWS, default
from warpgran.case.model import Model, declare
from warpgran.case.notebook import case_table, case_text
from warpgran.case.overrides import named_in_title, override_all
from warpgran.case.problems import CaseError, Problem, problems_of
from warpgran.case.sections import ALLOWED, KEYS, SECTIONS, Column, Every, Grid, Rheology, Scheme, Slope, Time
from warpgran.case.times import output_times, sample_times, series, snapshot_times, snapshots
from warpgran.case.toml import as_data, load, plain, set_key, text_of
from warpgran.case.validation import validated

if TYPE_CHECKING:
    from warpgran.case.study import Study

__all__ = ["Case", "CaseError", "Column", "Every", "Grid", "Problem", "Rheology", "Scheme", "Slope", "Time"]


class Case(Model):
    """One run. Make it with `from_toml` or `from_dict`, change it with `with_`, vary it with `sweep`.

    Raises:
        CaseError: Lists everything that is wrong.
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
            overrides: `KEY=VALUE` with a dotted key and a value in TOML; other values are taken as text. They replace
                the file's values before anything is checked; the file's title then names them.

        Raises:
            CaseError: Lists everything that is wrong, each line beginning with the file's name.
        """
        where = os.fspath(path)
        source, data = load(where)
        problems = override_all(data, overrides)
        return cls._checked(data, problems, Path(where).parent, source, where)

    @classmethod
    def from_dict(cls, mapping: Mapping[str, Any], folder: str | os.PathLike[str] = ".") -> Case:
        """Make a case of nested mappings that hold the keys of a run file.

        Args:
            mapping: Sections of keys; NumPy numbers are taken as numbers.
            folder: What relative paths in it start from.

        Raises:
            CaseError: Lists everything that is wrong.
        """
        return cls._checked(mapping, [], Path(folder))

    @overload
    def with_(
        self,
        *,
        title: str | None = ...,
        rheology: RheologyChanges | None = ...,
        slope: SlopeChanges | None = ...,
        column: ColumnChanges | None = ...,
        grid: GridChanges | None = ...,
        time: TimeChanges | None = ...,
        scheme: SchemeChanges | None = ...,
    ) -> Case: ...
    @overload
    def with_(self, **changes: Any) -> Case: ...
    def with_(self, **changes: Any) -> Case:
        """The same case with other values, checked again: `case.with_(slope={"angle": 16.0}, title="Less steep")`.

        Args:
            changes: By section the keys that change, as a mapping, and `title`; what is not named stays. None, of a
                key or of a section, restores the default. Programs may give values by dotted key instead:
                `case.with_(**{"slope.angle": 16.0})`. Tables are not read again. The title names what changed,
                "Dense column, 22 degrees [slope.angle = 16]", unless it is given itself.

        Raises:
            CaseError: Lists everything that is wrong.
        """
        data = as_data(self)
        pairs = list(dotted(changes))
        with named_in_title(data, [key for key, _ in pairs]):
            problems = [problem for key, value in pairs if (problem := set_key(data, key, value))]
        return self._checked(data, problems, self._folder, self._source)

    def refined(self, level: int) -> Case:
        """This case on 2^level times as many cells; it is not checked again, since the case itself has been."""
        grid = self.grid.model_copy(update={"cells": self.grid.cells * 2**level})
        return self.model_copy(update={"grid": grid}) if level else self

    def sweep(
        self, over: Mapping[str, Any], *, mode: str = "product", samples: int | None = None, seed: int = 1
    ) -> Study:
        """Cases that vary this one: `case.sweep({"slope.angle": [0, 10, 16, 22]})`.

        Args:
            over: By dotted key a list of values (product, zip) or `{"low": a, "high": b}` (latin, sobol).
            mode: product, zip, latin or sobol, as in the `[sweep]` section of a run file.
            samples: Number of runs for latin and sobol.
            seed: Seed of the samples.

        Returns:
            The study of these runs, as a run file with that `[sweep]` gives it.

        Raises:
            CaseError: Lists everything that is wrong with the sweep or with any of its runs.
        """
        from warpgran.case.read_study import sweep

        return sweep(self, over, mode=mode, samples=samples, seed=seed)

    @classmethod
    def _checked(cls, data: Any, problems: list[Problem], folder: Path, source: str = "", where: str = "") -> Case:
        """A case of nested data, or a CaseError with every problem, those already found first."""
        case = validated(cls, data, problems, folder, where)
        case._source, case._folder = source, folder
        return case

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
        return self._value("scheme.h_min")

    @property
    def h_front(self) -> float:
        """Thickness that marks the front, m."""
        return self._value("scheme.h_front")

    @property
    def rest_speed(self) -> float:
        """Speed below which the mass is at rest, m/s."""
        return self._value("time.rest_speed")

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

        Outside the column h is `scheme.h_bed`, 0 by default, and phi that of the column, or of the nearer end of a
        profile.
        """
        profile = self.column.profile
        h = np.maximum(self.column.thickness_on(self.grid), self.scheme.h_bed)
        if profile is None or profile.phi is None:
            return h, np.full(self.grid.cells, self.column.phi)
        return h, np.interp(self.x, profile.x, profile.phi)

    def initial_velocity(self) -> Array:
        """Velocity at the cell centres at time 0, m/s, shape (cells,); 0 unless a profile has a column v."""
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
        """Times of the scalar series, s, increasing; a sample at a snapshot has its time to the bit."""
        return sample_times(self.time)

    @property
    def output_times(self) -> tuple[float, ...]:
        """Output times, s, increasing: snapshots, samples and the end. Each is met exactly."""
        return output_times(self.time)

    def _value(self, key: str) -> Any:
        """The value of a dotted key, or its default if that follows from other keys."""
        if key == "column.height":  # what follows it follows a profile too
            return self.column.greatest_height
        value = self._given(key)
        return float(default(key, self._value)) if value is None and key in FOLLOWS else value

    @property
    def following(self) -> list[str]:
        """The keys that have a part in this case and are not set, but have a default that follows from other keys."""
        values = self._in_force()
        return [key for key in FOLLOWS if self._given(key) is None and values[key] is not None]

    def _given(self, key: str) -> Any:
        section, _, name = key.partition(".")
        return getattr(getattr(self, section), name)

    def _in_force(self) -> dict[str, Any]:
        """Every value in force by dotted key; None for a key that has no part in this case."""
        values: dict[str, Any] = {"title": self.title}
        for section, model in SECTIONS.items():
            for name, key in model.keys().items():
                values[f"{section}.{key}"] = getattr(getattr(self, section), name)
        values |= {key: self._value(key) for key in FOLLOWS}
        values |= {"time.snapshots": snapshots(self.time), "time.series": series(self.time)}
        values |= {key: None for key, known in KEYS.items() if known.order not in (None, self.scheme.order)}
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

    def __repr__(self) -> str:
        return case_text(self)

    __str__ = __repr__

    def _repr_html_(self) -> str:
        return case_table(self)
