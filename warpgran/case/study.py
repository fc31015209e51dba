"""Studies: many cases as one sequence.

A study of a sweep holds one case and a table of values, never its cases, so that 100,000 runs take a few megabytes.
"""

from __future__ import annotations

from array import array
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, SupportsIndex, overload

import numpy as np

from warpgran.arrays import Array
from warpgran.case.defaults import FOLLOWS, default
from warpgran.case.identity import identity
from warpgran.case.notebook import study_table
from warpgran.case.overrides import without_notes
from warpgran.case.problems import CaseError, Problem, shown
from warpgran.case.sweep_section import KINDS

if TYPE_CHECKING:  # at run time a study asks a case for no more than its values
    from warpgran.case.case import Case


class Study(Sequence["Case"]):
    """The cases of a run file, or of a sweep made in Python. Make one with `read_study`, `Case.sweep` or `Study.of`.

    `study[i]` makes the case of run i, a new one each time; a slice gives a list of cases.

    Attributes:
        base: The case of run 0, for what all runs share.
        keys: The swept keys, dotted; empty for a study of one run.
        given: The cases of a study made with `of`, which may differ in any key; empty for a sweep.
        source: The run file's whole text, "" where there is none.
        folder: What relative paths start from.
        design: The `[sensitivity]` section that made the runs, as text; "" where there is none.
        inputs: The files that were read for it: the run file and the tables that it names.
    """

    def __init__(self, base: Case, columns: Mapping[str, Sequence[Any]]) -> None:
        """Vary a case. Nothing is checked before a case is made.

        Args:
            base: A case that has the values of run 0.
            columns: Values by run of each key, all of one length >= 1; none for a study of one run.
        """
        self.base = base
        self.keys = tuple(columns)
        self.source = base.source
        self.folder = base.folder
        self.design = ""
        self.inputs: tuple[Path, ...] = ()
        self._columns = {key: _compact(key, values) for key, values in columns.items()}
        self.given: tuple[Case, ...] = ()
        self._runs = len(next(iter(columns.values()))) if columns else 1

    @classmethod
    def of(cls, cases: Sequence[Case]) -> Study:
        """A study of given cases, which it keeps.

        Its keys are those of single values in which the cases differ, without those that follow another by default.

        Raises:
            CaseError: There is no case, or what is no case.
        """
        if isinstance(cases, Study):
            return cases
        if not cases:
            raise CaseError([Problem("", "a study needs at least one case")])
        if isinstance(cases, str) or not all(hasattr(case, "flat") for case in cases):
            what = "warpgran.read_study(path) reads a run file"
            raise CaseError([Problem("", f"{shown(cases)} are not cases; allowed: a Case, a Study or a list; {what}")])
        flats = [case.flat() for case in cases]
        differ = [key for key in KINDS if any(flat[key] != flats[0][key] for flat in flats)]
        simple = [key for key in differ if all(flat[key] is not None for flat in flats)]
        base = cases[0].model_copy(update={"title": without_notes(cases[0].title, differ)})
        study = cls(base, {key: [flat[key] for flat in flats] for key in simple})
        follow = set(simple).intersection(*(case.following for case in cases))
        study.keys = tuple(key for key in simple if key not in follow)
        study.given, study._runs = tuple(cases), len(cases)
        return study

    def __len__(self) -> int:
        return self._runs

    @overload
    def __getitem__(self, i: SupportsIndex) -> Case: ...
    @overload
    def __getitem__(self, i: slice) -> list[Case]: ...
    def __getitem__(self, i: SupportsIndex | slice) -> Case | list[Case]:
        runs = range(self._runs)[i]
        return [self._case(run) for run in runs] if isinstance(runs, range) else self._case(runs)

    def _case(self, run: int) -> Case:
        if self.given:
            return self.given[run]
        values = {key: column[run] for key, column in self._columns.items()}
        return self.base.with_(**values, title=self.base.title) if values else self.base

    def values(self, key: str) -> list[Any]:
        """Values of a swept key, by run.

        Raises:
            KeyError: The key is not among `keys`.
        """
        return list(self._columns[key])

    def parameters(self) -> dict[str, Sequence[Any]]:
        """Values by run of the keys in which the runs differ: those of `keys`, and those whose default follows one.

        `scheme.h_min`, say, differs where the grain diameter does, unless it was set.
        """
        differ = dict(self._columns)
        for key in () if self.given else self.base.following:
            if not self._columns.keys().isdisjoint(FOLLOWS[key][1]):
                differ[key] = default(key, self._over_runs).tolist()
        return differ

    def _over_runs(self, key: str) -> Array:
        return np.asarray(self._columns.get(key, self.base._value(key)))

    def identity(self, i: int) -> str:
        """The identity of the case of run i, see the function `identity`."""
        return identity(self[i])

    def _repr_html_(self) -> str:
        return study_table(self)

    def __repr__(self) -> str:
        runs = "1 run" if self._runs == 1 else f"{self._runs} runs"
        return f"<Study of {runs}{' over ' if self.keys else ''}{', '.join(self.keys)}>"


def _compact(key: str, values: Sequence[Any]) -> Sequence[Any]:
    """Values of a key, packed; whole numbers become floats where the key holds those."""
    return array("d", values) if KINDS[key] is float else tuple(values)
