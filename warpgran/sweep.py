"""One case to many: studies, and how they are read from a run file with a `[sweep]` and checked.

A study holds one case and a table of values, never its cases, so that 100,000 runs take a few megabytes.
"""

from __future__ import annotations

import os
from array import array
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, SupportsIndex, overload

from warpgran.case import Case, read_tables
from warpgran.errors import CaseError, Problem, shown
from warpgran.identity import identity
from warpgran.runfile import given, load, override, put, without
from warpgran.sweep_section import KINDS, MOST_RUNS, Sweep, flatten, read_section
from warpgran.sweep_values import values_by_run

__all__ = ["KINDS", "MOST_RUNS", "Study", "Sweep", "identity", "read_study", "sweep"]

_MOST_MESSAGES = 5


class Study(Sequence[Case]):
    """The cases of a run file, or of a sweep made in Python. Make it with `read_study`, `Case.sweep` or `Study.of`.

    `study[i]` makes the case of run i, anew each time; a slice gives a list of cases.

    Attributes:
        base: Run 0: what all runs share it has too.
        keys: The swept keys, dotted; none for a study of one run.
        given: The cases of a study made with `of`, which may differ in anything; none for a sweep.
        source: The run file's whole text, "" where there is none.
        folder: What relative paths start from.
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
        self._columns = {key: _compact(key, values) for key, values in columns.items()}
        self.given: tuple[Case, ...] = ()
        self._runs = len(next(iter(columns.values()))) if columns else 1

    @classmethod
    def of(cls, cases: Sequence[Case]) -> Study:
        """A study of given cases, which it keeps. Its keys are those of simple values in which the cases differ.

        Raises:
            ValueError: There is no case.
        """
        if isinstance(cases, Study):
            return cases
        if not cases:
            raise ValueError("a study needs at least one case")
        flats = [case.flat() for case in cases]
        differ = [key for key in KINDS if any(flat[key] != flats[0][key] for flat in flats)]
        simple = [key for key in differ if all(flat[key] is not None for flat in flats)]
        study = cls(cases[0], {key: [flat[key] for flat in flats] for key in simple})
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
        return self.base.with_(**values) if values else self.base

    def values(self, key: str) -> list[Any]:
        """Values of a swept key, by run.

        Raises:
            KeyError: The key is not among `keys`.
        """
        return list(self._columns[key])

    def identity(self, i: int) -> str:
        """The identity of the case of run i, see the function `identity`."""
        return identity(self[i])

    def __repr__(self) -> str:
        runs = "1 run" if self._runs == 1 else f"{self._runs} runs"
        return f"<Study of {runs}{' over ' if self.keys else ''}{', '.join(self.keys)}>"


def _compact(key: str, values: Sequence[Any]) -> Sequence[Any]:
    """Values of a key as they are in force: an int for a float becomes one."""
    return array("d", values) if KINDS[key] is float else tuple(values)


def read_study(path: str | os.PathLike[str], overrides: Sequence[str] = ()) -> Study:
    """Read a run file, with or without a `[sweep]`, and check every run of it.

    Args:
        path: The file, UTF-8. Paths in it start from its folder.
        overrides: `KEY=VALUE` as for `Case.from_toml`; also of the sweep, as in `sweep.over.slope.angle=[0, 10]`.

    Raises:
        CaseError: With all that is wrong, each line beginning with the file's name; what is wrong with runs is told
            with their number, from 0, and their values.
    """
    where = os.fspath(path)
    source, data = load(where)
    problems = flatten(data)
    problems += [problem for text in overrides if (problem := override(data, text))]
    problems += flatten(data)  # again, for an override can set all of sweep.over
    overridden = [text.partition("=")[0].strip() for text in overrides]
    return _study(data, problems, Path(where).parent, source, where, overridden)


def sweep(
    case: Case, over: Mapping[str, Any], *, mode: str = "product", samples: int | None = None, seed: int = 1
) -> Study:
    """Vary a case, as the `[sweep]` section of a run file does, and check every run.

    Args:
        case: What all runs share.
        over: By dotted key a list of values (product, zip) or `{"low": a, "high": b}`, with `"log": True` for equal
            shares of the logarithm (latin, sobol).
        mode: product (every combination, the last key fastest), zip (value by value), latin or sobol (samples).
        samples: Number of runs for latin and sobol, for sobol a power of 2.
        seed: Of the samples: the same seed gives the same values.

    Raises:
        CaseError: With all that is wrong.
    """
    section = {"over": over, "mode": mode, "seed": seed} | ({} if samples is None else {"samples": samples})
    data = given(case) | {"sweep": section}
    return _study(data, flatten(data), case.folder, case.source)


# From the section to a study


def _study(
    data: dict[str, Any],
    problems: list[Problem],
    folder: Path,
    source: str,
    where: str = "",
    overridden: Sequence[str] = (),
) -> Study:
    """The study that the data ask for, or all that is wrong with them beside the problems already found.

    The data are the caller's no more: they are changed.
    """
    section = data.pop("sweep", None)
    if section is None:
        return Study(Case._checked(data, problems, folder, source, where), {})
    columns: Mapping[str, Sequence[Any]] = {}
    try:
        columns = values_by_run(read_section(section), folder)
    except CaseError as error:
        problems = problems + error.problems
    problems += [
        Problem(key, f"the sweep varies it and would undo this override; set sweep.over.{key} instead")
        for key in dict.fromkeys(overridden)
        if key in columns
    ]
    unread = read_tables(data, folder)
    data = without(data, {problem.key for problem in unread})
    of_file = list(_file_problems(data, unread, set(columns), folder))
    of_runs = _run_problems(data, columns, of_file, folder) if columns else []
    if problems or of_file or of_runs:
        raise CaseError([*problems, *of_file, *of_runs], where)
    for key, values in columns.items():
        put(data, key, values[0])
    return Study(Case._checked(data, [], folder, source, where), columns)


def _found(data: dict[str, Any], known: list[Problem], folder: Path) -> list[Problem]:
    try:
        Case._checked(data, known, folder)
    except CaseError as error:
        return error.problems
    return []


def _file_problems(data: dict[str, Any], known: list[Problem], swept: set[str], folder: Path) -> Iterator[Problem]:
    """What is wrong in every run. Without the sweep's keys, nothing that several keys decide can be judged."""
    for problem in _found(data, known, folder):
        if not problem.involves or (swept and swept.isdisjoint((problem.key, *problem.involves))):
            yield problem


def _run_problems(
    data: dict[str, Any], columns: Mapping[str, Sequence[Any]], of_file: list[Problem], folder: Path
) -> list[Problem]:
    """Check every run: each thing that is wrong once, with the first run where it is, a few things and a count."""
    known = [problem for problem in of_file if problem.key not in columns]
    told = set(of_file)
    runs = len(next(iter(columns.values())))
    first: dict[Problem, int] = {}
    times: dict[Problem, int] = {}
    more = invalid = 0
    for run in range(runs):
        for key, values in columns.items():
            put(data, key, values[run])
        found = [problem for problem in _found(data, known, folder) if problem not in told]
        invalid += bool(found)
        for problem in found:
            if problem in first:
                times[problem] += 1
            elif len(first) < _MOST_MESSAGES:
                first[problem], times[problem] = run, 1
            else:
                more += 1
    problems = [
        replace(problem, message=f"{problem.message} ({_where(columns, run, times[problem])})")
        for problem, run in first.items()
    ]
    if more:
        problems.append(Problem("", f"and {more} more like these; {invalid} of {runs} runs cannot be run"))
    return problems


def _where(columns: Mapping[str, Sequence[Any]], run: int, times: int) -> str:
    """`run 3: slope.angle = 100, column.phi = 0.62`."""
    told = []
    for key, values in columns.items():
        value = values[run]
        told.append(f"{key} = {value:.6g}" if isinstance(value, float) else f"{key} = {shown(value)}")
    count = f"{times} runs, the first is " if times > 1 else ""
    return f"{count}run {run}: {', '.join(told)}"
