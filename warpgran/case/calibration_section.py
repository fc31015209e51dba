"""The `[calibration]` section of a run file: its keys, the priors of the parameters, and several experiments."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from pydantic import StrictFloat, StrictInt, ValidationError

from warpgran.case.case import Case
from warpgran.case.distributions import FORMS, Distribution, read_over
from warpgran.case.model import Model, declare
from warpgran.case.problems import CaseError, Problem, problems_of, shown, unknown_key
from warpgran.case.sweep_section import dotted_pairs, flatten, key_problem, twice
from warpgran.case.toml import load, override

NAME = "calibration"
_OF_DATA = "slope.angle"


class Calibration(Model):
    """The `[calibration]` section: what is fitted to measurements, and with how many runs."""

    over: dict[str, Any] | None = declare(None, "over", allowed=f"by dotted key {FORMS}", unset="none: must be given")
    """The parameters with their prior distributions."""
    experiments: list[Any] | None = declare(
        None,
        "experiments",
        allowed='tables of data = "FOLDER" and set = { "column.phi" = 0.55, ... }',
        unset="one, of the folder itself",
    )
    """Experiments that share the parameters: for each the folder of its measurements inside that of `--data`, and the
    keys in which it differs. Within a folder every slope is an experiment of its own.
    """
    screening: StrictInt = declare(256, "screening", allowed="a power of 2 from 8 to 1048576", ge=8, le=2**20)
    """Sobol points of the prior that are computed first; the populations begin with them, and need at least `chains` x
    (parameters + 1).
    """
    starts: StrictInt = declare(3, "starts", ge=1, le=100)
    """Best points of the screening from which a best fit is sought."""
    particles: StrictInt = declare(32, "particles", ge=8, le=100_000)
    """Points of each population of the posterior that move at once; all populations move in one batch."""
    chains: StrictInt = declare(4, "chains", ge=2, le=64)
    """Populations of the posterior, which are compared with each other."""
    predictive: StrictInt = declare(100, "predictive", ge=2, le=100_000)
    """Runs of the prediction bands, drawn from the posterior."""
    correlation: StrictFloat | None = declare(
        None, "correlation", allowed="> 0 and <= 10", unset="inferred, from 0.03 to 1", gt=0, le=10
    )
    """Correlation length of the error of the model, as a fraction of the range that the measurements of a kind span in
    x and in t.
    """
    seed: StrictInt = declare(1, "seed", ge=0)
    """Seed of all that is drawn: the same seed gives the same numbers."""

    @classmethod
    def allowed(cls) -> dict[str, str]:
        """Every key, as `calibration.key`, and what is allowed there in words."""
        return {f"{NAME}.{key}": known.hint for key, known in cls.described().items()}


class _CalibrationHolder(Model):
    """Puts the name of the section in front of the keys in errors."""

    calibration: Calibration


@dataclass(frozen=True)
class ExperimentKeys:
    """One entry of `[[calibration.experiments]]`.

    Attributes:
        data: Folder of its measurements, inside that of all; "" for that folder itself.
        changes: Values by dotted key in which it differs from the run file.
    """

    data: str = ""
    changes: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class CalibrationStudy:
    """What a run file asks a calibration for.

    Attributes:
        base: The case that all experiments share.
        priors: Distributions of the parameters, by dotted key.
        experiments: At least one.
        section: The other keys.
    """

    base: Case
    priors: Mapping[str, Distribution]
    experiments: tuple[ExperimentKeys, ...]
    section: Calibration


def read_calibration(path: str | os.PathLike[str], overrides: Sequence[str] = ()) -> CalibrationStudy:
    """Read a run file with a section `[calibration]`.

    Args:
        path: The file, UTF-8.
        overrides: `KEY=VALUE`, as for `read_study`; keys of the section too.

    Raises:
        CaseError: Lists everything that is wrong, each line beginning with the file's name.
    """
    where = os.fspath(path)
    _, data = load(where)
    problems = flatten(data, (NAME,))
    problems += [problem for text in overrides if (problem := override(data, text))]
    problems += flatten(data, (NAME,))  # again, for an override can set all of calibration.over
    section = data.get(NAME)
    base: Case | None = None
    try:
        base = Case.from_toml(path, [text for text in overrides if not text.strip().startswith(f"{NAME}.")])
    except CaseError as error:
        problems += [problem for problem in error.problems if problem not in problems]
    try:
        return calibration_of(base or Case(), section, problems)
    except CaseError as error:
        raise CaseError(error.problems, where) from None


def calibration_of(base: Case, section: Any, problems: Sequence[Problem] = ()) -> CalibrationStudy:
    """A section that has been read, checked against its case.

    Args:
        base: The case that all experiments share.
        section: The keys of the section; distributions may be given as such.
        problems: Those already found.

    Raises:
        CaseError: Lists everything that is wrong, those already found first.
    """
    problems = list(problems)
    if section is None:
        raise CaseError([*problems, Problem(NAME, "is missing: a calibration needs the section and its priors")])
    over = section.get("over") if isinstance(section, Mapping) else None
    experiments = section.get("experiments") if isinstance(section, Mapping) else None
    rest = section
    if isinstance(section, Mapping):
        rest = {key: value for key, value in section.items() if key not in ("over", "experiments")}
    try:
        read = _CalibrationHolder(calibration=rest).calibration
    except ValidationError as error:
        problems += problems_of(error, Calibration.allowed() | {NAME: ""})
        read = Calibration()
    if read.screening & (read.screening - 1):
        following = 1 << read.screening.bit_length()
        message = f"{read.screening} is no power of 2, which Sobol points need; the next is {following}"
        problems.append(Problem(f"{NAME}.screening", message))
    priors: dict[str, Distribution] = {}
    try:
        priors = read_over({} if over is None else over, f"{NAME}.over")
    except CaseError as error:
        problems += error.problems
    least = read.chains * (len(priors) + 1)
    if read.screening < least:
        following = 1 << (least - 1).bit_length()
        message = (
            f"{read.screening} is too few for {read.chains} populations of {len(priors)} parameters; "
            f"allowed: >= {following}"
        )
        problems.append(Problem(f"{NAME}.screening", message))
    problems += [
        Problem(f"{NAME}.over.{key}", f"cannot be fitted: {reason}") for key in priors if (reason := _unfit(key))
    ]
    listed = list(_experiments(experiments, priors, problems))
    if problems:
        raise CaseError(problems)
    study = CalibrationStudy(base, priors, tuple(listed), read)
    _check_cases(study)
    return study


def _unfit(key: str) -> str:
    if key == _OF_DATA:
        return "the measurements give it, in their column angle"
    return "all runs share one grid" if key.startswith("grid.") else ""


def _experiments(given: Any, priors: Mapping[str, Any], problems: list[Problem]) -> Iterator[ExperimentKeys]:
    """The experiments; what is wrong with them is added to the problems."""
    name = f"{NAME}.experiments"
    if given is None:
        yield ExperimentKeys()
        return
    if not isinstance(given, list) or not given:
        problems.append(Problem(name, f"{shown(given)} is not a list of tables; write [[{name}]]"))
        return
    for i, entry in enumerate(given):
        where = f"{name}[{i}]"
        if not isinstance(entry, Mapping):
            problems.append(Problem(where, f"{shown(entry)} is not a table of keys"))
            continue
        problems += [unknown_key(f"{where}.{key}", (f"{where}.data", f"{where}.set"))
                     for key in entry if key not in ("data", "set")]  # fmt: skip
        data, changes = entry.get("data", ""), entry.get("set", {})
        if not isinstance(data, str):
            problems.append(Problem(f"{where}.data", f"{shown(data)} is not text; allowed: the name of a folder"))
        if not isinstance(changes, Mapping):
            problems.append(Problem(f"{where}.set", f"{shown(changes)} is not a table of keys"))
            continue
        pairs = dotted_pairs(changes)
        problems += twice(pairs, f"{where}.set")
        flat = dict(pairs)
        for key in flat:
            problem, reason = key_problem(key), _unfit(key)
            if problem:
                problems.append(replace(problem, key=f"{where}.set.{key}"))
            elif reason:
                problems.append(Problem(f"{where}.set.{key}", f"cannot be set: {reason}"))
            elif key in priors:
                problems.append(Problem(f"{where}.set.{key}", f"is fitted by {NAME}.over; take one of them out"))
        yield ExperimentKeys(str(data), flat)


def _check_cases(study: CalibrationStudy) -> None:
    """Check that every experiment can be run in the middle of the priors.

    Raises:
        CaseError: Lists everything that is wrong.
    """
    middle = {key: float(prior.ppf(np.array(0.5))) for key, prior in study.priors.items()}
    problems = []
    for experiment in study.experiments:
        try:
            study.base.with_(**experiment.changes, **middle)
        except CaseError as error:
            problems += error.problems
    if problems:
        where = "(in the middle of the priors)"
        raise CaseError([replace(p, message=f"{p.message} {where}") for p in dict.fromkeys(problems)])
