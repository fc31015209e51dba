"""About how many time steps a case takes, and what they cost."""

from __future__ import annotations

from typing import NamedTuple

from warpgran.case.case import Case
from warpgran.case.wave_steps import steps_over, wave_speed
from warpgran.physics.second_order import end_of_level


class ExpectedSteps(NamedTuple):
    """Time steps of all levels of a run, and cell-steps: each level's steps times its cells."""

    steps: int
    cell_steps: int


def expected_steps(case: Case) -> ExpectedSteps:
    """Steps of a case if its fastest wave stayed that of the initial column, on every level of the start and after it.

    A flow is faster at first, and slower once the mass has spread: the steps of the run files at the top of runs/ are
    0.76 to 1.08 times those, their cell-steps 0.72 to 1.05 times.
    """
    speed = wave_speed(case.refined(case.scheme.start_levels))
    t, steps, cell_steps = 0.0, 0, 0
    for level in range(case.scheme.start_levels, -1, -1):
        on = case.refined(level)
        end = min(end_of_level(on, speed), case.time.end) if level else case.time.end
        taken = steps_over(on, end - t, speed)
        t, steps, cell_steps = end, steps + taken, cell_steps + taken * on.grid.cells
    return ExpectedSteps(steps, cell_steps)
