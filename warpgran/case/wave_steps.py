"""Time steps that the waves of the initial column ask for."""

from __future__ import annotations

import math

from warpgran.case.case import Case


def wave_speed(case: Case) -> float:
    """Speed of the fastest wave of the initial state at rest, sqrt(g_c max h) [m/s]."""
    h, _ = case.initial_state()
    return math.sqrt(case.g_c * float(h.max()))


def steps_over(case: Case, seconds: float, speed: float) -> int:
    """Steps on the case's cells over a time [s] in which the fastest wave has this speed [m/s]."""
    return math.ceil(seconds * speed / (case.scheme.cfl * case.dx))
