"""How likely the values of a key are: what `[sensitivity.over]` and other sections that sample keys hold.

A table of a run file gives a distribution: `{ low = 0.0, high = 8.0 }` is uniform, with `scale = "log"` log-uniform;
`{ mean = 0.48, sd = 0.05 }` is normal, and with `low`, `high` or both truncated there.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cached_property
from typing import Any, Literal

import numpy as np
from pydantic import StrictBool, StrictFloat, ValidationError

from warpgran.arrays import Array
from warpgran.case.model import Model, declare
from warpgran.case.problems import CaseError, Problem, problems_of, shown
from warpgran.case.sweep_section import KINDS, dotted_pairs, key_problem

FORMS = "{ low = , high = } or { mean = , sd = }"


class Distribution(Model):
    """The distribution of one parameter. Make it with `read_over`, which checks what is given together."""

    low: StrictFloat | None = declare(None, "low", allowed="a number", unset="none")
    """Least value."""
    high: StrictFloat | None = declare(None, "high", allowed="a number", unset="none")
    """Greatest value."""
    mean: StrictFloat | None = declare(None, "mean", allowed="a number", unset="none: a uniform distribution")
    """Mean of the normal distribution, before it is truncated."""
    sd: StrictFloat | None = declare(None, "standard deviation", unset="none: a uniform distribution", gt=0)
    """Standard deviation of the normal distribution, before it is truncated."""
    scale: Literal["linear", "log"] | None = declare(None, "scale", unset='`"linear"`', allowed='"linear" or "log"')
    """With "log" equal shares of the logarithm, not of the value, are equally likely; of a uniform distribution."""
    log: StrictBool | None = declare(None, "log", unset="`false`", allowed="true or false")
    """`true` is `scale = "log"`, as ranges of `[sweep.over]` have it."""

    @property
    def normal(self) -> bool:
        """Whether it is normal, truncated or not; uniform otherwise."""
        return self.mean is not None or self.sd is not None

    @property
    def logarithmic(self) -> bool:
        """Whether equal shares of the logarithm are equally likely."""
        return bool(self.log) or self.scale == "log"

    @property
    def bounds(self) -> tuple[float, float]:
        """Least and greatest value that it can have; infinite where there is none."""
        return -math.inf if self.low is None else self.low, math.inf if self.high is None else self.high

    @cached_property
    def law(self) -> Any:
        """The distribution as `scipy.stats` has it, frozen."""
        from scipy import stats

        low, high = self.bounds
        if not self.normal:
            return stats.loguniform(low, high) if self.logarithmic else stats.uniform(low, high - low)
        if self.bounds == (-math.inf, math.inf):
            return stats.norm(self.mean, self.sd)
        assert self.mean is not None and self.sd is not None
        return stats.truncnorm((low - self.mean) / self.sd, (high - self.mean) / self.sd, self.mean, self.sd)

    def ppf(self, u: Array) -> Array:
        """Values below which shares u in [0, 1] of the probability lie; never beyond the bounds, whatever rounding.

        A normal distribution that is not truncated gives infinities at u = 0 and u = 1.
        """
        return np.clip(self.law.ppf(u), *self.bounds)

    def logpdf(self, x: Array) -> Array:
        """Logarithm of the probability density at x; minus infinity beyond the bounds."""
        with np.errstate(divide="ignore", invalid="ignore"):  # scipy takes the logarithm of what lies outside too
            return np.asarray(self.law.logpdf(x))

    def __str__(self) -> str:
        """In words, as tables and figures name it."""
        low, high = (f"{bound:.4g}" for bound in self.bounds)
        if not self.normal:
            return f"{low} to {high}{', logarithmic' if self.logarithmic else ''}"
        words = f"normal, {self.mean:.4g} ± {self.sd:.4g}"
        return words if self.low is None and self.high is None else f"{words}, {low} to {high}"


def read_over(over: Any, where: str) -> dict[str, Distribution]:
    """Distributions by dotted key.

    Args:
        over: What the section holds: dotted keys, or sections of keys (`rheology.K = { ... }` without quotes).
        where: The name of the section, such as "sensitivity.over".

    Raises:
        CaseError: Lists everything that is wrong.
    """
    if not isinstance(over, Mapping):
        raise CaseError([Problem(where, f"{shown(over)} is not a table of keys")])
    found: dict[str, Distribution] = {}
    problems: list[Problem] = [] if over else [Problem(where, f"names no key; allowed: by dotted key {FORMS}")]
    for key, value in dotted_pairs(over):
        name = f"{where}.{key}"
        problem = key_problem(key)
        if key in found:
            problems.append(Problem(name, "is given twice"))
        elif problem:
            problems.append(replace(problem, key=name))
        elif KINDS[key] not in (float, int):
            problems.append(Problem(name, "holds no number, so that it has no distribution"))
        else:
            try:
                found[key] = _read(value, name)
            except CaseError as error:
                problems += error.problems
    if problems:
        raise CaseError(problems)
    return found


def _read(value: Any, name: str) -> Distribution:
    if isinstance(value, Distribution):
        return value
    if not isinstance(value, Mapping):
        raise CaseError([Problem(name, f"{shown(value)} is not a distribution; allowed: {FORMS}")])
    try:
        found = Distribution(**value)
    except ValidationError as error:
        problems = problems_of(error, {key: known.hint for key, known in Distribution.described().items()})
        raise CaseError([replace(problem, key=f"{name}.{problem.key}") for problem in problems]) from None
    problems = list(_problems(found, name))
    if problems:
        raise CaseError(problems)
    return found


def _problems(found: Distribution, name: str) -> Iterator[Problem]:
    """Rules that involve several of the numbers."""
    needed = ("mean", "sd") if found.normal else ("low", "high")
    missing = [key for key in needed if getattr(found, key) is None]
    for key in missing:
        yield Problem(f"{name}.{key}", f"is missing; allowed: {FORMS}")
    low, high = found.bounds
    if not low < high:
        yield Problem(f"{name}.low", f"{low} is out of range; allowed: < high, which is {high}")
    if found.log is not None and found.scale is not None:
        yield Problem(f"{name}.log", "has no part beside scale; take one of them out")
    elif found.logarithmic and found.normal:
        yield Problem(name, 'is normal, and has no logarithmic scale; allowed with scale = "log": { low = , high = }')
    elif found.logarithmic and found.low is not None and low <= 0:
        yield Problem(f"{name}.low", f'{low} is out of range; allowed with scale = "log": > 0')
    if not missing and found.normal and not _has_probability(found):
        yield Problem(name, "the normal distribution has no probability between low and high")


def _has_probability(found: Distribution) -> bool:
    """Whether the bounds leave something of a normal distribution: within 30 standard deviations of its mean."""
    low, high = found.bounds
    assert found.mean is not None and found.sd is not None
    return low < found.mean + 30.0 * found.sd and high > found.mean - 30.0 * found.sd
