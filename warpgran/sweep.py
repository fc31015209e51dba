"""One case to many: the `[sweep]` section of a run file, and the cases that it asks for, made on demand.

A study holds one case and a table of values, never its cases, so that 100,000 runs take a few megabytes.
"""

from __future__ import annotations

import csv
import hashlib
import json
import math
import os
from array import array
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from types import UnionType
from typing import Annotated, Any, Literal, SupportsIndex, Union, get_args, get_origin, overload

import numpy as np
from pydantic import Discriminator, Field, StrictBool, StrictFloat, StrictInt, StrictStr, Tag, ValidationError

from warpgran.case import Case, read_tables
from warpgran.errors import CaseError, Problem, problems_of, shown, unknown_key
from warpgran.runfile import given, load, override, put, without
from warpgran.sections import ALLOWED, SECTIONS, Array, Model, Time
from warpgran.tables import Table
from warpgran.times import sample_times, snapshot_times

MOST_RUNS = 1_000_000
_MOST_MESSAGES = 5
_SAMPLED = ("latin", "sobol")

_SHARED_TIMES = "all runs of a file share their output times"
_FIXED = {
    "title": "it is that of the whole file",
    "time.end": _SHARED_TIMES,
    "time.snapshots": _SHARED_TIMES,
    "time.series": _SHARED_TIMES,
}


def _kind(annotation: Any) -> type | None:
    """What a key holds, optional or not: float, int, bool, str for one of several words; None for a table or a list."""
    if get_origin(annotation) is Literal:
        return str
    while get_origin(annotation) in (Annotated, Union, UnionType):
        annotation = get_args(annotation)[0]
    return annotation if annotation in (float, int, bool) else None


def _kinds() -> dict[str, type]:
    kinds = {
        f"{section}.{key}": _kind(model.model_fields[name].annotation)
        for section, model in SECTIONS.items()
        for name, key in model.keys().items()
    }
    return {key: kind for key, kind in kinds.items() if kind and key not in _FIXED}


KINDS = _kinds()
"""What each key that can be swept holds: float, int, str or bool."""


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
    problems = _flatten(data)
    problems += [problem for text in overrides if (problem := override(data, text))]
    problems += _flatten(data)
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
    return _study(data, _flatten(data), case.folder, case.source)


def identity(case: Case) -> str:
    """A hash of all that the result of a case depends on: 16 hexadecimal digits, the same on every machine.

    It is made of every value in force, the output times and the numbers of the tables. Not in it are the title,
    `scheme.window`, which gives the same bits, and the paths of files.
    """
    left_out = ("title", "scheme.window", "time.snapshots", "time.series")
    values = {key: value for key, value in case.flat().items() if key not in left_out}
    values["times"] = _times(case.time)
    values["slope.bed"] = _numbers(case.slope.bed)
    values["column.profile"] = _numbers(case.column.profile)
    return _digest(values)


@lru_cache(maxsize=16)
def _times(time: Time) -> str:
    return _digest([snapshot_times(time), sample_times(time)])


def _numbers(table: Table | None) -> Any:
    return None if table is None else {name: values.tolist() for name, values in table.columns().items()}


def _digest(values: Any) -> str:
    text = json.dumps(_without_sign_of_zero(values), sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def _without_sign_of_zero(value: Any) -> Any:
    """Cases that are equal have one identity: -0.0 equals 0.0."""
    if isinstance(value, dict):
        return {key: _without_sign_of_zero(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_without_sign_of_zero(item) for item in value]
    return value + 0.0 if isinstance(value, float) else value


# The section


class Range(Model):
    """Where samples of a key lie.

    Attributes:
        low: Least value.
        high: Greatest value.
        log: Whether equal shares of the logarithm, not of the value, are equally likely.
    """

    low: StrictFloat
    high: StrictFloat
    log: StrictBool = False


def _branch(value: Any) -> str | None:
    """Which of the two forms is meant, so that errors are told of that one alone."""
    if isinstance(value, Mapping):
        return "<range>"
    return "<list>" if isinstance(value, list) else None


Over = Annotated[
    Annotated[list[Any], Tag("<list>")] | Annotated[Range, Tag("<range>")],
    Discriminator(_branch),
]


def _key(default: Any, allowed: str, **options: Any) -> Any:
    return Field(default, json_schema_extra={"allowed": allowed}, **options)


class Sweep(Model):
    """The `[sweep]` section.

    Attributes:
        mode: How the runs are made of `over`.
        samples: Number of runs for latin and sobol.
        seed: Of the samples.
        over: Lists of values or ranges, by dotted key.
        from_: A table of values instead, a row a run; `from` in the run file.
    """

    mode: Literal["product", "zip", "latin", "sobol"] = _key("product", '"product", "zip", "latin" or "sobol"')
    samples: StrictInt | None = _key(None, ">= 1 and <= 1000000, for sobol a power of 2", ge=1, le=MOST_RUNS)
    seed: StrictInt = _key(1, ">= 0", ge=0)
    over: dict[str, Over] | None = _key(None, "by dotted key a list of values or { low = , high = }")
    from_: StrictStr | None = _key(None, "the path of a CSV file", alias="from")

    @classmethod
    def allowed(cls) -> dict[str, str]:
        """Every key, as `sweep.key`, and what is allowed there in words."""
        words = {}
        for name, key in cls.keys().items():
            extra = cls.model_fields[name].json_schema_extra
            words[f"sweep.{key}"] = str(extra["allowed"]) if isinstance(extra, dict) else ""
        return words


class _Holder(Model):
    """So that errors of the section have its name in their keys."""

    sweep: Sweep


def _flatten(data: dict[str, Any]) -> list[Problem]:
    """Turn what `[sweep.over]` nests, as in `slope.angle = [1, 2]` without quotes, into dotted keys, in place."""
    section = data.get("sweep")
    over = section.get("over") if isinstance(section, Mapping) else None
    if not isinstance(section, dict) or not isinstance(over, Mapping):
        return []
    pairs: list[tuple[str, Any]] = []
    for key, value in over.items():
        nested = isinstance(value, Mapping) and "." not in str(key) and not value.keys() <= Range.model_fields.keys()
        pairs += [(f"{key}.{name}", item) for name, item in value.items()] if nested else [(str(key), value)]
    section["over"] = {key: _listed(value) for key, value in pairs}
    names = [key for key, _ in pairs]
    twice = dict.fromkeys(name for name in names if names.count(name) > 1)
    return [Problem(f"sweep.over.{name}", "is given twice") for name in twice]


def _listed(value: Any) -> Any:
    """Arrays, tuples and other sequences as lists, NumPy's numbers as Python's."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, Sequence) and not isinstance(value, str | bytes):
        return [item.tolist() if isinstance(item, np.generic) else item for item in value]
    return value


# From the section to a study


def _study(
    data: dict[str, Any],
    problems: list[Problem],
    folder: Path,
    source: str,
    where: str = "",
    overridden: Sequence[str] = (),
) -> Study:
    """The study that the data ask for, or all that is wrong with them beside the problems already found."""
    data = dict(data)
    section = data.pop("sweep", None)
    if section is None:
        return Study(Case._checked(data, problems, folder, source, where), {})
    columns: dict[str, Sequence[Any]] = {}
    try:
        columns = _columns(section, folder)
    except CaseError as error:
        problems = problems + error.problems
    problems += [
        Problem(key, f"the sweep varies it and would undo this override; set sweep.over.{key} instead")
        for key in dict.fromkeys(overridden)
        if key in columns
    ]
    data = given(data)
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
    values = (
        f"{key} = {value:.6g}" if isinstance(value := column[run], float) else f"{key} = {shown(value)}"
        for key, column in columns.items()
    )
    return f"{f'{times} runs, the first is ' if times > 1 else ''}run {run}: {', '.join(values)}"


def _columns(section: Any, folder: Path) -> dict[str, Sequence[Any]]:
    """Values by run of every swept key.

    Raises:
        CaseError: With all that is wrong with the section.
    """
    over = section.get("over") if isinstance(section, Mapping) else None
    allowed = Sweep.allowed() | {"sweep": ""}
    for key in over if isinstance(over, Mapping) else ():
        allowed[f"sweep.over.{key}"] = "a list of values, or { low = , high = } for latin and sobol"
        allowed |= {f"sweep.over.{key}.low": "a number", f"sweep.over.{key}.high": "a number"}
        allowed[f"sweep.over.{key}.log"] = ""
    try:
        sweep = _Holder(sweep=section).sweep
    except ValidationError as error:
        raise CaseError(problems_of(error, allowed)) from None
    problems = list(_section_problems(sweep))
    if problems:
        raise CaseError(problems)
    if sweep.from_ is not None:
        return _read_samples(Path(folder) / sweep.from_)
    lists = {key: values for key, values in (sweep.over or {}).items() if isinstance(values, list)}
    if sweep.mode == "zip":
        return {key: values for key, values in lists.items()}
    return _product(lists) if sweep.mode == "product" else _sampled(sweep)


def _section_problems(sweep: Sweep) -> Iterator[Problem]:
    if sweep.from_ is not None:
        for name in ("mode", "over", "samples"):
            if name in sweep.model_fields_set:
                yield Problem(f"sweep.{name}", "has no part beside sweep.from, which gives the runs; take one out")
        return
    if not sweep.over:
        yield Problem("sweep.over", f"names no key; allowed: {Sweep.allowed()['sweep.over']}, or a file by sweep.from")
    for key, values in (sweep.over or {}).items():
        problem = _key_problem(key)
        if problem:
            yield replace(problem, key=f"sweep.over.{key}")
        else:
            yield from (
                _range_problems(key, values, sweep) if isinstance(values, Range) else _list_problems(key, values, sweep)
            )
    yield from _size_problems(sweep)


def _key_problem(key: str) -> Problem | None:
    """Why a key cannot be swept."""
    if key in KINDS:
        return None
    if key in ALLOWED:
        reason = _FIXED.get(".".join(key.split(".")[:2]), "it holds no single number or word")
        return Problem(key, f"cannot be swept: {reason}")
    return unknown_key(key, KINDS)


def _range_problems(key: str, values: Range, sweep: Sweep) -> Iterator[Problem]:
    name = f"sweep.over.{key}"
    if sweep.mode not in _SAMPLED:
        yield Problem(name, f"is a range; allowed in mode {sweep.mode}: a list of values (latin and sobol take ranges)")
    elif KINDS[key] not in (float, int):
        yield Problem(name, "holds no number, so that it has no range; vary it by a list, in mode product or zip")
    elif not values.low < values.high:
        yield Problem(f"{name}.low", f"{values.low} is out of range; allowed: < high, which is {values.high}")
    elif values.log and values.low <= 0:
        yield Problem(f"{name}.low", f"{values.low} is out of range; allowed with log: > 0")


def _list_problems(key: str, values: list[Any], sweep: Sweep) -> Iterator[Problem]:
    name = f"sweep.over.{key}"
    if sweep.mode in _SAMPLED:
        yield Problem(name, f"is a list; allowed in mode {sweep.mode}: {{ low = , high = }}")
    elif not values:
        yield Problem(name, "has no values")
    for i, value in enumerate(values):
        if not isinstance(value, bool | int | float | str):
            yield Problem(f"{name}[{i}]", f"{shown(value)} is not a number, a word, true or false")


def _size_problems(sweep: Sweep) -> Iterator[Problem]:
    """What is wrong with the number of runs."""
    lengths = {key: len(values) for key, values in (sweep.over or {}).items() if isinstance(values, list)}
    if sweep.mode in _SAMPLED:
        if sweep.samples is None:
            yield Problem("sweep.samples", f"is missing: mode {sweep.mode} needs a number of runs")
        elif sweep.mode == "sobol" and sweep.samples & (sweep.samples - 1):
            following = 1 << sweep.samples.bit_length()
            message = f"{sweep.samples} is no power of 2, which Sobol points need; the next is {following}"
            yield Problem("sweep.samples", message)
        return
    if sweep.samples is not None:
        yield Problem("sweep.samples", f"has no part in mode {sweep.mode}, whose lists give the number of runs")
    if sweep.mode == "zip" and len(set(lengths.values())) > 1:
        told = ", ".join(f"{key} has {length}" for key, length in lengths.items())
        yield Problem("sweep.over", f"mode zip needs lists of one length: {told}")
    runs = math.prod(lengths.values()) if sweep.mode == "product" else max(lengths.values(), default=0)
    if runs > MOST_RUNS:
        yield Problem("sweep.over", f"asks for {runs} runs; allowed: {MOST_RUNS}")


def _product(lists: Mapping[str, list[Any]]) -> dict[str, Sequence[Any]]:
    """Every combination, the last key fastest."""
    columns: dict[str, Sequence[Any]] = {}
    before, after = 1, math.prod(len(values) for values in lists.values())
    for key, values in lists.items():
        after //= len(values)
        columns[key] = [value for _ in range(before) for value in values for _ in range(after)]
        before *= len(values)
    return columns


def _sampled(sweep: Sweep) -> dict[str, Sequence[Any]]:
    """Latin hypercube or scrambled Sobol points in the ranges."""
    from scipy.stats import qmc

    ranges = {key: values for key, values in (sweep.over or {}).items() if isinstance(values, Range)}
    engine = {"latin": qmc.LatinHypercube, "sobol": qmc.Sobol}[sweep.mode]
    points = engine(len(ranges), seed=np.random.default_rng(sweep.seed)).random(sweep.samples)
    return {
        key: [round(value) for value in _scaled(u, values)] if KINDS[key] is int else array("d", _scaled(u, values))
        for (key, values), u in zip(ranges.items(), points.T, strict=True)
    }


def _scaled(u: Array, values: Range) -> list[float]:
    """Points u in [0, 1) as values of the range."""
    low, high = values.low, values.high
    scaled = np.exp((1 - u) * math.log(low) + u * math.log(high)) if values.log else (1 - u) * low + u * high
    return np.clip(scaled, low, high).tolist()


# A table of runs


def _read_samples(path: Path) -> dict[str, Sequence[Any]]:
    """Values by run from a CSV file: a header of dotted keys, and a row a run. Empty lines and `#` are passed over.

    Raises:
        CaseError: The file cannot be used.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise _unusable([f"{path}: is not UTF-8 text"]) from None
    except (OSError, ValueError) as error:  # ValueError: a null character in the name
        raise _unusable([f"{path}: cannot be read: {getattr(error, 'strerror', None) or error}"]) from None
    lines = [(n, line) for n, line in enumerate(text.splitlines(), 1) if line.strip() and line.strip()[0] != "#"]
    if len(lines) < 2:
        raise _unusable([f"{path}: has no runs; allowed: a header of dotted keys and a row a run"])
    if len(lines) - 1 > MOST_RUNS:
        raise _unusable([f"{path}: has {len(lines) - 1} runs; allowed: {MOST_RUNS}"])
    try:
        (number, header), *rows = [(n, [cell.strip() for cell in next(csv.reader([line]))]) for n, line in lines]
    except csv.Error as error:
        raise _unusable([f"{path}: is not a CSV file: {error}"]) from None
    messages = [f"{path}:{number}: {problem}" for key in header if (problem := _key_problem(key))]
    messages += [f"{path}:{number}: {key}: is given twice" for key in dict.fromkeys(header) if header.count(key) > 1]
    messages += [
        f"{path}:{n}: has {len(row)} values; allowed: {len(header)}" for n, row in rows if len(row) != len(header)
    ]
    if messages:
        raise _unusable(messages)
    return {key: [_CELLS[KINDS[key]](row[i]) for _, row in rows] for i, key in enumerate(header)}


def _unusable(messages: list[str]) -> CaseError:
    more = len(messages) - _MOST_MESSAGES
    told = messages[:_MOST_MESSAGES] + ([f"and {more} more of this table"] if more > 0 else [])
    return CaseError([Problem("sweep.from", message) for message in told])


def _real(cell: str) -> float | str:
    """A number; what is none stays text, which is refused with its run."""
    try:
        return cell if "_" in cell else float(cell)  # float() takes 1_000
    except ValueError:
        return cell


def _whole(cell: str) -> float | str:
    """A whole number, also one written 4e2, as programs write tables."""
    value = _real(cell)
    return int(value) if isinstance(value, float) and value.is_integer() else value


def _truth(cell: str) -> bool | str:
    return {"true": True, "false": False}.get(cell.lower(), cell)


_CELLS: dict[type, Callable[[str], Any]] = {float: _real, int: _whole, str: str, bool: _truth}
