"""The `[sensitivity]` section of a run file: what varies, how likely each value is, and what is asked.

The section is checked here; `warpgran.case.sensitivity_design` makes the runs that it asks for.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Literal

import numpy as np
from pydantic import StrictInt, StrictStr, ValidationError

from warpgran.case.distributions import FORMS, Distribution, read_over
from warpgran.case.model import Model, declare
from warpgran.case.problems import CaseError, Problem, problems_of, shown, unknown_key
from warpgran.case.sweep_section import MOST_RUNS
from warpgran.case.times import SAME_TIME
from warpgran.case.toml import text_of, toml_value
from warpgran.schema import SERIES

DEFAULT_SAMPLES = {"sobol": 256, "morris": 32}
SINGLE = ("run_out", "h_max_final", "dilation_max", "stop_time")
"""Outputs of a run that are one number, by themselves; a series at a time is one too."""
MOST_ASKED = 50
"""Most outputs that a section asks for."""


class Sensitivity(Model):
    """The `[sensitivity]` section: makes the file a design of runs that says which parameters matter."""

    method: Literal["sobol", "morris"] = declare("sobol", "method")
    """Shares of the variance (Saltelli's design), or elementary effects (Morris's), which take far fewer runs."""
    samples: StrictInt | None = declare(
        None,
        "samples",
        allowed=">= 2, for sobol a power of 2",
        unset="256 for sobol, 32 for morris",
        ge=2,
        le=MOST_RUNS,
    )
    """Base samples n of sobol, n (d + 2) runs of d parameters; trajectories r of morris, r (d + 1) runs."""
    seed: StrictInt = declare(1, "seed", ge=0)
    """Seed of the samples: the same seed gives the same runs."""
    of: tuple[StrictStr, ...] = declare(
        ("run_out",), "of", allowed="a list of run_out, h_max_final, dilation_max, stop_time, front, front@0.5, ..."
    )
    """What is asked about: a result of a run, a series at all its times (`"front"`), or at one (`"front@0.5"`)."""
    over: dict[str, Distribution] = declare(..., "over", allowed=f"by dotted key {FORMS}", unset="none, must be given")
    """What varies, independently of each other."""

    @property
    def size(self) -> int:
        """Number of base samples, or of trajectories."""
        return DEFAULT_SAMPLES[self.method] if self.samples is None else self.samples

    @property
    def per_sample(self) -> int:
        """Runs of a base sample, or of a trajectory."""
        return len(self.over) + (2 if self.method == "sobol" else 1)

    def to_toml(self) -> str:
        """The section as text of a run file."""
        values: dict[str, Any] = {"method": self.method, "samples": self.size, "seed": self.seed, "of": [*self.of]}
        over = {key: toml_value(found.model_dump(exclude_none=True)) for key, found in self.over.items()}
        lines = ["", "[sensitivity.over]", *(f'"{key}" = {found}' for key, found in over.items())]
        return (
            text_of({f"sensitivity.{name}": value for name, value in values.items()}).lstrip() + "\n".join(lines) + "\n"
        )


def read_sensitivity(section: Any) -> Sensitivity:
    """The section as a model.

    Raises:
        CaseError: Lists everything that is wrong with it.
    """
    if not isinstance(section, Mapping):
        raise CaseError([Problem("sensitivity", f"{shown(section)} is not a table of keys")])
    problems: list[Problem] = []
    over: dict[str, Distribution] = {}
    try:
        over = read_over(section.get("over", {}), "sensitivity.over")
    except CaseError as error:
        problems += error.problems
    allowed = {name: known.hint for name, known in Sensitivity.described().items()}
    try:
        found = Sensitivity(**{str(key): _listed(value) for key, value in section.items()} | {"over": over})
    except ValidationError as error:
        wrong = problems_of(error, allowed)
        problems = [Problem(f"sensitivity.{problem.key}", problem.message) for problem in wrong] + problems
    else:
        problems = [*_problems(found), *problems]
    if problems:
        raise CaseError(problems)
    return found


def _listed(value: Any) -> Any:
    """Lists as tuples, which are all that a strict model takes."""
    return tuple(value) if isinstance(value, list) else value


def _problems(found: Sensitivity) -> Iterator[Problem]:
    size = found.size
    if found.method == "sobol" and size & (size - 1):
        following = 1 << size.bit_length()
        yield Problem("sensitivity.samples", f"{size} is no power of 2, which Sobol points need; next: {following}")
    runs = size * found.per_sample
    if runs > MOST_RUNS:
        yield Problem("sensitivity.samples", f"{size} asks for {runs} runs; allowed: {MOST_RUNS}")
    if not found.of:
        yield Problem("sensitivity.of", f"asks for nothing; allowed: {Sensitivity.described()['of'].hint}")
    if len(found.of) > MOST_ASKED:
        yield Problem("sensitivity.of", f"asks for {len(found.of)} results; allowed: {MOST_ASKED}")
    for i, name in enumerate(found.of):
        problem = asked_problem(name)
        if problem:
            yield Problem(f"sensitivity.of[{i}]", problem)
        elif name in found.of[:i]:
            yield Problem(f"sensitivity.of[{i}]", f"{name} is given twice")


def asked_problem(name: str) -> str:
    """Why an output cannot be asked for; "" if it can."""
    series, at, time = name.partition("@")
    if not at:
        if name in SINGLE or name in SERIES:
            return ""
        near = unknown_key(name, [*SINGLE, *SERIES]).message.removeprefix("unknown key")
        return f"{shown(name)} is no result of a run{near or f'; allowed: {_LIST}'}"
    if series not in SERIES:
        return f"{shown(name)}: {series} is no series; allowed before @: {', '.join(SERIES)}"
    try:
        ok = math.isfinite(float(time)) and float(time) >= 0.0 and "_" not in time
    except ValueError:
        ok = False
    return "" if ok else f"{shown(name)}: {shown(time)} is no time; allowed after @: a number >= 0, in s"


_LIST = ", ".join([*SINGLE, *SERIES]) + ", and a series at a time, as front@0.5"


def sample_of(name: str, times: Sequence[float]) -> int | str:
    """The number of the sample that `front@0.5` asks for, or why there is none.

    Args:
        name: A series, "@" and a time.
        times: Sample times of the runs, s, increasing.
    """
    time = float(name.partition("@")[2])
    if not len(times):
        return f"{shown(name)}: the runs have no samples; allowed: a time of time.series"
    nearest = np.argsort(np.abs(np.asarray(times) - time), kind="stable")[:2]
    if abs(times[nearest[0]] - time) <= SAME_TIME * times[-1]:
        return int(nearest[0])
    near = " and ".join(f"{times[n]:.6g}" for n in sorted(nearest.tolist()))
    return f"{shown(name)}: {time:g} s is none of the times of time.series; the nearest are {near}"


def time_problems(found: Sensitivity, times: Sequence[float]) -> Iterator[Problem]:
    """What is asked for at times that the runs have no sample at.

    Args:
        found: A valid section.
        times: Sample times of the runs, s, increasing.
    """
    for i, name in enumerate(found.of):
        where = sample_of(name, times) if "@" in name else 0
        if isinstance(where, str):
            yield Problem(f"sensitivity.of[{i}]", where)
    if not len(times):
        yield Problem("sensitivity.of", "has no results to ask about: the runs have no samples, time.series is empty")
