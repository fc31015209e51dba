"""The kernels against the NumPy reference and a numba version, one run on one core, from the same state in motion."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any, get_args

import numpy as np
from parts.work import Array, Crews, Moving, Precision, Round, Work

from warpgran.physics.reference import reference

STEPS = 100
CHECKED = 50
TOLERANCE = 1e-10
NUMPY, NUMBA = "NumPy reference", "numba, float64"


class DifferentError(RuntimeError):
    """What was to be timed does not compute the same."""


def rivals(crews: Crews, cells: int, order: int) -> dict[str, Round]:
    """Rounds that return ns per cell-step of one run by the scheme of an order.

    Raises:
        DifferentError: After 50 steps one of them in float64 is further than 1e-10 from the reference.
    """
    full = Work(cells, 1, order=order, start=0 if order == 2 else None)  # the state is that of these cells
    moving = crews.of(full)[0]
    moving.put_back()
    case, U = full.case, moving.U
    run = reference(case)
    run.U = U
    for _ in range(CHECKED):
        run.step()
    expected = run.U

    def by_reference() -> None:
        run.U = U
        for _ in range(STEPS):
            run.step()

    rounds = {NUMPY: _round(by_reference, cells * STEPS)}
    numba = _numba(case, U) if order == 1 else None
    if numba:
        numba.advance(CHECKED)
        _check(NUMBA, numba.U, expected)
        rounds[NUMBA] = _numba_round(numba, U, cells)
    for precision in get_args(Precision):
        for window in (False, True):
            work = replace(full, precision=precision, window=window)
            label = f"kernels, {precision}, {'window' if window else 'full range'}"
            if precision == "float64":
                _check(label, _after(crews.of(work)[0]), expected)
            rounds[label] = crews.round_of(work, STEPS)
    return rounds


def _after(moving: Moving) -> Array:
    moving.seconds(CHECKED)
    return moving.U


def _numba(case: Any, U: Array) -> Any:
    """A run of order 1 in numba; None where numba is not installed."""
    try:
        from parts.numba_version import NumbaRun
    except ImportError:
        return None
    return NumbaRun(case, U)


def _numba_round(run: Any, U: Array, cells: int) -> Round:
    repeats = 10  # so that it lasts long enough to be timed

    def go() -> None:
        for _ in range(repeats):
            run.U = U
            run.advance(STEPS)

    return _round(go, cells * STEPS * repeats)


def _round(go: Callable[[], None], cell_steps: int) -> Round:
    def round_() -> float:
        began = time.thread_time()
        go()
        return (time.thread_time() - began) * 1e9 / cell_steps

    return round_


def _check(name: str, U: Array, expected: Array) -> None:
    """That a state is the one expected, relative to the largest value of each of its three parts.

    Raises:
        DifferentError: It is not.
    """
    off = float((np.abs(U - expected).max(axis=1) / np.abs(expected).max(axis=1)).max())
    if not off <= TOLERANCE:
        raise DifferentError(f"{name}: off by {off:.1e} after {CHECKED} steps, refused")
