"""How many time steps a case takes at least."""

from __future__ import annotations

import math

from warpgran.case.case import Case


def least_steps(case: Case) -> int:
    """Least number of steps of a case: those of the initial column at rest, whose waves travel at sqrt(g_c h)."""
    h, _ = case.initial_state()
    return math.ceil(case.time.end * math.sqrt(case.g_c * float(h.max())) / (case.scheme.cfl * case.dx))
