"""The `[sweep]` section of a run file: its keys, what they may hold, and which keys of a case can be swept.

The section is checked here; `warpgran.case.sweep_values` makes the values that it asks for.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Discriminator, StrictBool, StrictFloat, StrictInt, StrictStr, Tag, ValidationError

from warpgran.case.model import Model, declare
from warpgran.case.problems import CaseError, Problem, problems_of, shown, unknown_key
from warpgran.case.sections import ALLOWED, KEYS
from warpgran.case.toml import VARYING

MOST_RUNS = 1_000_000
SAMPLED = ("latin", "sobol")

_SHARED_TIMES = "all runs of a file share their output times"
_FIXED = {
    "title": "it is that of the whole file",
    "time.end": _SHARED_TIMES,
    "time.snapshots": _SHARED_TIMES,
    "time.series": _SHARED_TIMES,
}


_WORDS = {"low", "high", "log", "scale", "mean", "sd"}
"""What a range or a distribution is made of; no key of a section has such a name."""

KINDS = {name: known.kind for name, known in KEYS.items() if known.kind and name not in _FIXED}
"""What each key that can be swept holds: float, int, str or bool."""


def key_problem(key: str) -> Problem | None:
    """Why a key cannot be swept."""
    if key in KINDS:
        return None
    if key in ALLOWED:
        reason = _FIXED.get(".".join(key.split(".")[:2]), "it holds no single number or word")
        return Problem(key, f"cannot be swept: {reason}")
    return unknown_key(key, KINDS)


class Range(Model):
    """Where samples of a key lie."""

    low: StrictFloat = declare(..., "low", allowed="a number")
    """Least value."""
    high: StrictFloat = declare(..., "high", allowed="a number")
    """Greatest value."""
    log: StrictBool = declare(False, "log")
    """Whether equal shares of the logarithm, not of the value, are equally likely."""


def _branch(value: Any) -> str | None:
    """The form that is meant, so that errors speak of that one alone."""
    if isinstance(value, Mapping):
        return "<range>"
    return "<list>" if isinstance(value, list) else None


Over = Annotated[
    Annotated[list[Any], Tag("<list>")] | Annotated[Range, Tag("<range>")],
    Discriminator(_branch),
]


class Sweep(Model):
    """The `[sweep]` section: what varies from run to run."""

    mode: Literal["product", "zip", "latin", "sobol"] = declare("product", "mode")
    """How the runs are made of `over`."""
    samples: StrictInt | None = declare(
        None,
        "samples",
        allowed=f">= 1 and <= {MOST_RUNS}, for sobol a power of 2",
        unset="none: the lists give the number of runs",
        ge=1,
        le=MOST_RUNS,
    )
    """Number of runs for latin and sobol, which must have it; the other modes must not."""
    seed: StrictInt = declare(1, "seed", ge=0)
    """Seed of the samples of latin and sobol: the same seed gives the same runs."""
    over: dict[str, Over] | None = declare(
        None, "over", allowed="by dotted key a list of values or { low = , high = }", unset="none"
    )
    """What varies."""
    from_: StrictStr | None = declare(None, "from", allowed="the path of a CSV file", unset="none", alias="from")
    """The runs as a table, instead of `mode`, `over` and `samples`; its path starts from the run file's folder."""

    @classmethod
    def allowed(cls) -> dict[str, str]:
        """Every key, as `sweep.key`, and what is allowed there in words."""
        return {f"sweep.{name}": known.hint for name, known in cls.described().items()}


class _Holder(Model):
    """Puts the name of the section in front of the keys in errors."""

    sweep: Sweep


def flatten(data: dict[str, Any], sections: Iterable[str] = VARYING) -> list[Problem]:
    """Turn what `[sweep.over]` and the like nest, as in `slope.angle = [1, 2]` without quotes, into dotted keys."""
    problems = []
    for name in sections:
        section = data.get(name)
        if not isinstance(section, dict) or not isinstance(section.get("over"), Mapping):
            continue
        pairs = dotted_pairs(section["over"])
        section["over"] = {key: _listed(value) for key, value in pairs}
        problems += twice(pairs, f"{name}.over")
    return problems


def twice(pairs: Sequence[tuple[str, Any]], where: str) -> list[Problem]:
    """A problem for each key that stands in the pairs more than once."""
    names = [key for key, _ in pairs]
    return [Problem(f"{where}.{key}", "is given twice") for key in dict.fromkeys(names) if names.count(key) > 1]


def dotted_pairs(over: Mapping[str, Any]) -> list[tuple[str, Any]]:
    """Dotted keys and what they hold; a key that is nested and dotted stands twice."""
    pairs: list[tuple[str, Any]] = []
    for key, value in over.items():
        nested = isinstance(value, Mapping) and value and "." not in str(key) and not value.keys() & _WORDS
        pairs += [(f"{key}.{name}", item) for name, item in value.items()] if nested else [(str(key), value)]
    return pairs


def _listed(value: Any) -> Any:
    """Arrays, tuples and other sequences as lists, NumPy's numbers as Python's."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, Sequence) and not isinstance(value, str | bytes):
        return [item.tolist() if isinstance(item, np.generic) else item for item in value]
    return value


def read_section(section: Any) -> Sweep:
    """The section as a model.

    Raises:
        CaseError: Lists everything that is wrong with it.
    """
    over = section.get("over") if isinstance(section, Mapping) else None
    allowed = Sweep.allowed() | {"sweep": ""}
    for key in over if isinstance(over, Mapping) else ():
        allowed[f"sweep.over.{key}"] = "a list of values, or { low = , high = } for latin and sobol"
        allowed |= {f"sweep.over.{key}.{name}": known.hint for name, known in Range.described().items()}
    try:
        sweep = _Holder(sweep=section).sweep
    except ValidationError as error:
        raise CaseError(problems_of(error, allowed)) from None
    problems = list(_section_problems(sweep))
    if problems:
        raise CaseError(problems)
    return sweep


def _section_problems(sweep: Sweep) -> Iterator[Problem]:
    if sweep.from_ is not None:
        for name in ("mode", "over", "samples"):
            if name in sweep.model_fields_set:
                yield Problem(f"sweep.{name}", "has no part beside sweep.from, which gives the runs; take one out")
        return
    if not sweep.over:
        yield Problem("sweep.over", f"names no key; allowed: {Sweep.allowed()['sweep.over']}, or a file by sweep.from")
    for key, values in (sweep.over or {}).items():
        problem = key_problem(key)
        if problem:
            yield replace(problem, key=f"sweep.over.{key}")
        elif isinstance(values, Range):
            yield from _range_problems(key, values, sweep)
        else:
            yield from _list_problems(key, values, sweep)
    yield from _size_problems(sweep)


def _range_problems(key: str, values: Range, sweep: Sweep) -> Iterator[Problem]:
    name = f"sweep.over.{key}"
    if sweep.mode not in SAMPLED:
        yield Problem(name, f"is a range; allowed in mode {sweep.mode}: a list of values (latin and sobol take ranges)")
    elif KINDS[key] not in (float, int):
        yield Problem(name, "holds no number, so that it has no range; vary it by a list, in mode product or zip")
    elif not values.low < values.high:
        yield Problem(f"{name}.low", f"{values.low} is out of range; allowed: < high, which is {values.high}")
    elif values.log and values.low <= 0:
        yield Problem(f"{name}.low", f"{values.low} is out of range; allowed with log: > 0")


def _list_problems(key: str, values: list[Any], sweep: Sweep) -> Iterator[Problem]:
    name = f"sweep.over.{key}"
    if sweep.mode in SAMPLED:
        yield Problem(name, f"is a list; allowed in mode {sweep.mode}: {{ low = , high = }}")
    elif not values:
        yield Problem(name, "has no values")
    for i, value in enumerate(values):
        if not isinstance(value, bool | int | float | str):
            yield Problem(f"{name}[{i}]", f"{shown(value)} is not a number, a word, true or false")


def _size_problems(sweep: Sweep) -> Iterator[Problem]:
    """What is wrong with the number of runs."""
    if sweep.mode in SAMPLED:
        if sweep.samples is None:
            yield Problem("sweep.samples", f"is missing: mode {sweep.mode} needs a number of runs")
        elif sweep.mode == "sobol" and sweep.samples & (sweep.samples - 1):
            following = 1 << sweep.samples.bit_length()
            message = f"{sweep.samples} is no power of 2, which Sobol points need; the next is {following}"
            yield Problem("sweep.samples", message)
        return
    if sweep.samples is not None:
        yield Problem("sweep.samples", f"has no part in mode {sweep.mode}, whose lists give the number of runs")
    lengths = {key: len(values) for key, values in (sweep.over or {}).items() if isinstance(values, list)}
    if sweep.mode == "zip" and len(set(lengths.values())) > 1:
        each = ", ".join(f"{key} has {length}" for key, length in lengths.items())
        yield Problem("sweep.over", f"mode zip needs lists of one length: {each}")
    runs = math.prod(lengths.values()) if sweep.mode == "product" else max(lengths.values(), default=0)
    if runs > MOST_RUNS:
        yield Problem("sweep.over", f"asks for {runs} runs; allowed: {MOST_RUNS}")
