"""Read run files, with or without a `[sweep]` or a `[sensitivity]`, as studies, and check every run."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from warpgran.case.case import Case
from warpgran.case.overrides import named_in_title, override_all, without_notes
from warpgran.case.problems import CaseError, Problem, values_in_words
from warpgran.case.sampled_runs import sampled_runs
from warpgran.case.sensitivity_design import design_values
from warpgran.case.sensitivity_section import Sensitivity, read_sensitivity, time_problems
from warpgran.case.study import Study
from warpgran.case.sweep_section import dotted_pairs, flatten, read_section
from warpgran.case.sweep_values import values_by_run
from warpgran.case.toml import VARYING, as_data, load, set_key, value_at, without
from warpgran.case.validation import read_tables

_MOST_MESSAGES = 5


Examined = Callable[[int, int], None]
"""Called now and then with the number of runs examined and of those to be."""


def read_study(
    path: str | os.PathLike[str],
    overrides: Sequence[str] = (),
    *,
    most: int | None = None,
    examined: Examined = lambda done, total: None,
) -> Study:
    """Read a run file, with or without a `[sweep]` or a `[sensitivity]`, and check every run of it.

    Args:
        path: The file, UTF-8. Paths in it start from its folder.
        overrides: `KEY=VALUE` as for `Case.from_toml`; keys of these sections too: `sweep.over.slope.angle=[0, 10]`.
        most: Number of runs that are checked of a larger study: those at the ends of the swept ranges, and others at
            equal distances. By default all.
        examined: Called now and then with the number of runs checked and of those to be.

    Returns:
        The study; of one run where the file varies nothing.

    Raises:
        CaseError: Lists everything that is wrong, each line beginning with the file's name; problems of single
            runs come with the number, from 0, and the values of the first.
    """
    where = os.fspath(path)
    source, data = load(where)
    problems = flatten(data)
    problems += override_all(data, overrides)
    problems += flatten(data)  # again, for an override can set all of sweep.over
    overridden = [text.partition("=")[0].strip() for text in overrides]
    folder, section = Path(where).parent, data.get("sweep")
    study = _study(data, problems, folder, source, where, overridden, most, examined)
    tables = [table.path for table in (study.base.slope.bed, study.base.column.profile) if table and table.path]
    samples = [section["from"]] if isinstance(section, dict) and "from" in section else []
    study.inputs = (Path(where), *(folder / name for name in (*tables, *samples)))
    return study


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
        seed: Seed of the samples: the same seed gives the same values.

    Raises:
        CaseError: Lists everything that is wrong.
    """
    section = {"over": over, "mode": mode, "seed": seed} | ({} if samples is None else {"samples": samples})
    data = as_data(case)
    given = [key for key, _ in dotted_pairs(over) if value_at(data, key) is not None]
    if case.title:
        data["title"] = without_notes(case.title, given)
    with named_in_title(data, [f"sweep.over.{key}" for key in given]):
        data["sweep"] = section
    return _study(data, flatten(data), case.folder, case.source)


def sensitivity_design(case: Case, over: Mapping[str, Any], **section: Any) -> Study:
    """The runs of a sensitivity study of a case, as the `[sensitivity]` section of a run file asks for them.

    Args:
        case: What all runs share.
        over: Distributions by dotted key, `{"low": a, "high": b}` for instance.
        section: The other keys of the section: `method`, `samples`, `seed`, `of`.

    Raises:
        CaseError: Lists everything that is wrong.
    """
    data = as_data(case) | {"sensitivity": {"over": over, **section}}
    return _study(data, flatten(data), case.folder, case.source)


def _study(
    data: dict[str, Any],
    problems: list[Problem],
    folder: Path,
    source: str,
    where: str = "",
    overridden: Sequence[str] = (),
    most: int | None = None,
    examined: Examined = lambda done, total: None,
) -> Study:
    """The study that the data ask for, or a CaseError with every problem, those already found first.

    The data are changed.
    """
    sections = {name: data.pop(name) for name in VARYING if name in data}
    if not sections:
        return Study(Case._checked(data, problems, folder, source, where), {})
    columns: Mapping[str, Sequence[Any]] = {}
    design: Sensitivity | None = None
    try:
        if len(sections) > 1:
            raise CaseError([Problem("sensitivity", "has no part beside [sweep]; take one of them out")])
        if "sweep" in sections:
            columns = values_by_run(read_section(sections["sweep"]), folder)
        else:
            design = read_sensitivity(sections["sensitivity"])
            columns = design_values(design)
            _leave_profiles_out(data)
    except CaseError as error:
        problems = problems + error.problems
    problems += [
        Problem(key, f"the {VARYING[name]} varies it and would undo this override; set {name}.over.{key} instead")
        for key in dict.fromkeys(overridden)
        for name in sections
        if key in columns
    ]
    unread = read_tables(data, folder)
    data = without(data, {problem.key for problem in unread})
    of_file = list(_file_problems(data, unread, set(columns), folder))
    of_runs: list[Problem] = []
    if columns:
        runs = len(next(iter(columns.values())))
        chosen = sampled_runs(columns, runs, most or runs)
        of_runs = _run_problems(data, columns, chosen, of_file, folder, examined)
    if problems or of_file or of_runs:
        raise CaseError([*problems, *of_file, *of_runs], where)
    for key, values in columns.items():
        set_key(data, key, values[0])
    study = Study(Case._checked(data, [], folder, source, where), columns)
    if design:
        at_no_sample = list(time_problems(design, study.base.sample_times))
        if at_no_sample:
            raise CaseError(at_no_sample, where)
        study.design = design.to_toml()
    return study


def _leave_profiles_out(data: dict[str, Any]) -> None:
    """No snapshots unless they are asked for: thousands of runs are looked at by their series."""
    time = data.setdefault("time", {})
    if isinstance(time, dict):
        time.setdefault("snapshots", [])


def _found(data: dict[str, Any], known: list[Problem], folder: Path) -> list[Problem]:
    try:
        Case._checked(data, known, folder)
    except CaseError as error:
        return error.problems
    return []


def _file_problems(data: dict[str, Any], known: list[Problem], swept: set[str], folder: Path) -> Iterator[Problem]:
    """Problems that all runs share. Rules that involve a swept key are left to the runs."""
    for problem in _found(data, known, folder):
        if not problem.involves or (swept and swept.isdisjoint((problem.key, *problem.involves))):
            yield problem


def _run_problems(
    data: dict[str, Any],
    columns: Mapping[str, Sequence[Any]],
    runs: Sequence[int],
    of_file: list[Problem],
    folder: Path,
    examined: Examined,
) -> list[Problem]:
    """Problems of these runs: each once, with the first run that has it; a few, then a count."""
    known = [problem for problem in of_file if problem.key not in columns]
    reported = set(of_file)
    first: dict[Problem, int] = {}
    times: dict[Problem, int] = {}
    more = invalid = 0
    for done, run in enumerate(runs):
        if done % 1000 == 0:
            examined(done, len(runs))
        for key, values in columns.items():
            set_key(data, key, values[run])
        found = [problem for problem in _found(data, known, folder) if problem not in reported]
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
        problems.append(Problem("", f"and {more} more like these; {invalid} of {len(runs)} runs cannot be run"))
    return problems


def _where(columns: Mapping[str, Sequence[Any]], run: int, times: int) -> str:
    """`run 3: slope.angle = 100, column.phi = 0.62`."""
    count = f"{times} runs, the first is " if times > 1 else ""
    return f"{count}run {run}: {values_in_words({key: values[run] for key, values in columns.items()})}"
