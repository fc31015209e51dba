"""Values that are allowed but unlikely: a unit mistaken, a grid too coarse, or a case beyond what the model is for."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from warpgran.case.case import Case
from warpgran.case.problems import Problem, values_in_words
from warpgran.case.sampled_runs import sampled_runs
from warpgran.case.study import Study
from warpgran.case.wave_steps import steps_over, wave_speed

STEEPEST = 10.0
"""Of a bed against the plane, degrees."""
MOST_CURVATURE = 0.1
"""Of a bed, times the thickness of the column."""
GRAINS = 10.0
"""Fewest grain diameters in the height of a column."""
ALONG = 20
"""Fewest cells in the length of a column."""
UPRIGHT = 5
"""Fewest cells over a length equal to the height of a column: its run-out on flat ground, some two heights, is then
good to a tenth."""
TALLEST = 3.0
"""Largest height of a column over the length that spreads to one side."""
ROUGHEST = 2.0
"""Friction coefficient, the tangent of 63 degrees: that of grains is below 1."""
EXAMINED = 1000
"""Most runs of a study that are examined."""


def unlikely(study: Study) -> list[str]:
    """What is unlikely of a study, a line each: the key, its value, and what would be likely.

    Of a batch each comes once, with the number of runs and the values of the first. A batch of more than 1000 runs is
    examined at the ends of what it varies and at equal distances in between.
    """
    runs = sampled_runs({key: study.values(key) for key in study.keys}, len(study), EXAMINED)
    first: dict[Callable[[Case], Problem | None], tuple[int, Problem]] = {}
    times = dict.fromkeys(CHECKS, 0)
    for run in runs:
        case = study[run]
        for check in CHECKS:
            problem = check(case)
            if problem is not None:
                first.setdefault(check, (run, problem))
                times[check] += 1
    flat = sum(study[run].slope.angle == 0.0 for run in runs) if _radians in first else 0
    if times[_radians] + flat < len(runs):  # a sweep across zero
        first.pop(_radians, None)
    return [f"{problem}{_counted(study, run, times[check], len(runs))}" for check, (run, problem) in first.items()]


def _counted(study: Study, run: int, times: int, examined: int) -> str:
    """` (12 of 200 runs, the first is run 3: slope.angle = 22)`; "" of a single run."""
    if len(study) == 1:
        return ""
    if times == len(study):
        return f" (all {times} runs)"
    of = f"{examined} runs" if examined == len(study) else f"{examined} runs examined of {len(study)}"
    values = values_in_words({key: study.values(key)[run] for key in study.keys})
    return f" ({times} of {of}, the first is run {run}{': ' if values else ''}{values})"


@dataclass(frozen=True)
class _Body:
    """The grains of a case at time 0.

    Attributes:
        height: Greatest thickness, m.
        length: Of what is not dry, m.
        sides: To how many sides it can spread: not against a wall, nor into itself around a period.
    """

    height: float
    length: float
    sides: int

    @classmethod
    def of(cls, case: Case) -> _Body:
        h = case.column.thickness_on(case.grid)
        wet = np.flatnonzero(h)
        walls = (case.scheme.left == "wall" and wet[0] == 0, case.scheme.right == "wall" and wet[-1] == h.size - 1)
        full = case.scheme.periodic and wet.size == h.size
        return cls(float(h.max()), float(wet.size * case.dx), 0 if full else 2 - sum(walls))


def _steep_bed(case: Case) -> Problem | None:
    """The model takes b as mild: gravity is split by the plane, and lengths along the bed are those along the plane."""
    if case.slope.bed is None:
        return None
    slope = np.degrees(np.arctan(np.diff(case.bed) / case.dx))
    i = int(np.argmax(abs(slope)))
    if abs(slope[i]) <= STEEPEST:
        return None
    place = f"{abs(slope[i]):.3g} degrees steep against the plane at x = {case.x[i] + case.dx / 2:.4g} m"
    message = (
        f"is {place}; likely: {STEEPEST:g} at most, with the mean slope in slope.angle (docs/run_file.md, the frame)"
    )
    return Problem("slope.bed", message)


def _curved_bed(case: Case) -> Problem | None:
    """Curvature times thickness is how much the slope changes over the length of one thickness."""
    if case.slope.bed is None:
        return None
    height, dx = case.column.greatest_height, case.dx
    slope = np.diff(case.bed) / dx
    n = min(max(1, round(height / dx)), slope.size - 1)
    turn = abs(slope[n:] - slope[:-n]) * height / (n * dx)
    i = int(np.argmax(turn))
    if turn[i] <= MOST_CURVATURE:
        return None
    where = case.x[i + 1 + int(np.argmax(abs(np.diff(slope[i : i + n + 1]))))]
    message = f"is bent at x = {where:.4g} m: its slope changes by {turn[i]:.3g} over the height of the column"
    return Problem(
        "slope.bed", f"{message}; likely: {MOST_CURVATURE:g} at most, for the model knows no centrifugal force"
    )


def _coarse_grains(case: Case) -> Problem | None:
    d, height = case.rheology.grain_diameter, _Body.of(case).height
    if d <= height / GRAINS:
        return None
    message = (
        f"{d:g} is more than a tenth of the column's height, {height:g}; likely: {height / GRAINS:.3g} at most, in m"
    )
    return Problem("rheology.grain_diameter", message)


def _few_cells(case: Case) -> Problem | None:
    """A run-out is off by half a cell to a cell, whatever the column (docs/limits.md), and follows its height."""
    body = _Body.of(case)
    upright, along = body.height / case.dx, body.length / case.dx
    short = min(upright / UPRIGHT, along / ALONG)
    if short >= 1.0 - 1e-9:
        return None
    message = f"{case.grid.cells} put {along:.3g} cells in the column's length and {upright:.3g} in its height"
    likely = f"{ALONG} and {UPRIGHT} or more, with {math.ceil(case.grid.cells / short)}"
    return Problem("grid.cells", f"{message}, and run-outs are off by up to a cell; likely: {likely}")


def _radians(case: Case) -> Problem | None:
    angle = case.slope.angle
    if not 0.0 < abs(angle) < 1.0:
        return None
    message = f"{angle:g} is less than a degree; likely: degrees, and {angle:g} radians are {math.degrees(angle):.3g}"
    return Problem("slope.angle", message)


def _friction_angle(case: Case) -> Problem | None:
    for key in ("mu1", "mu2", "mu_wall"):
        mu = getattr(case.rheology, key)
        if mu > ROUGHEST:
            angle = f", and the tangent of {mu:g} degrees is {math.tan(math.radians(mu)):.3g}" if mu < 80.0 else ""
            message = f"{mu:g} is the friction of no grains; likely: a coefficient below 1{angle}"
            return Problem(f"rheology.{key}", message)
    return None


def _tall_column(case: Case) -> Problem | None:
    body = _Body.of(case)
    if body.sides == 0 or body.height <= TALLEST * body.length / body.sides:
        return None
    spread = "" if body.sides == 1 else ", half of it to each side"
    message = f"{body.height:g} is tall for a length of {body.length:.4g} m{spread}: the model is shallow"
    likely = f"{TALLEST * body.length / body.sides:.3g} at most, in m"
    key = "column.height" if case.column.profile is None else "column.profile"
    return Problem(key, f"{message}, and tall columns run too far (docs/limits.md); likely: {likely}")


def _low_step_limit(case: Case) -> Problem | None:
    steps = steps_over(case, case.time.end, wave_speed(case))
    if steps <= case.time.step_limit:
        return None
    message = f"{case.time.step_limit} is reached before time.end; likely: more than {steps:.3g}, what its waves take"
    return Problem("time.step_limit", message)


CHECKS: tuple[Callable[[Case], Problem | None], ...] = (
    _steep_bed,
    _curved_bed,
    _coarse_grains,
    _few_cells,
    _radians,
    _friction_angle,
    _tall_column,
    _low_step_limit,
)
