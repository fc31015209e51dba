"""What each kernel of a step costs, launched again and again in one graph on columns in motion; and the divider."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from functools import partial
from typing import Any
from unittest import mock

import numpy as np
import warp as wp
from parts.work import Moving, Round, clock_of

REPEATS = 200
IN_CACHE = 8192
"""Elements that fit the cache, and so many that a call of NumPy costs little."""


def stages(moving: Moving, cells: int, repeats: int = REPEATS) -> dict[str, Round]:
    """A round for each launch of a step, in their order, that returns ns per cell of runs of so many cells."""
    moving.put_back()
    state = moving.solver.state
    rounds = {}
    launched = launches(moving.solver.step)
    names = numbered(kernel.func.__name__ for kernel, _ in launched)
    for name, (kernel, keywords) in zip(names, launched, strict=True):
        with wp.ScopedCapture(device=moving.solver.device) as capture:
            for _ in range(repeats):
                wp.launch(kernel, **keywords)
        rounds[name] = _round(capture.graph, repeats * state.runs * cells, moving)
    return rounds


def numbered(names: Iterable[str]) -> list[str]:
    """Names of launches, those of a kernel that is launched again in a step with a number."""
    found: list[str] = []
    for name in names:
        times = 1 + sum(other.split()[0] == name for other in found)
        found.append(name if times == 1 else f"{name} {times}")
    return found


def launches(step: Callable[[], None]) -> list[tuple[Any, dict[str, Any]]]:
    """What a step launches, without launching it."""
    noted: list[tuple[Any, dict[str, Any]]] = []
    with mock.patch.object(wp, "launch", lambda kernel, **keywords: noted.append((kernel, keywords))):
        step()
    return noted


def _round(graph: Any, cells: int, moving: Moving) -> Round:
    device = moving.solver.device
    clock = clock_of(device)

    def round_() -> float:
        moving.put_back()
        wp.synchronize_device(device)
        began = clock()
        wp.capture_launch(graph)
        wp.synchronize_device(device)
        return (clock() - began) * 1e9 / cells

    return round_


def divider() -> dict[str, Round]:
    """Rounds that return ns per vectorised division and square root (NumPy, in the cache): a bound for the kernels.

    The unit that does both is not pipelined: all else in a loop goes on beside it.
    """
    rounds: dict[str, Round] = {}
    for precision in ("float64", "float32"):
        a, b, out = (np.full(IN_CACHE, value, dtype=precision) for value in (1.1, 1.3, 0.0))
        rounds[f"division, {precision}"] = _repeated(partial(np.divide, a, b, out=out))
        rounds[f"square root, {precision}"] = _repeated(partial(np.sqrt, a, out=out))
    return rounds


def _repeated(call: Callable[[], Any]) -> Round:
    def round_() -> float:
        began = time.thread_time()
        for _ in range(2 * REPEATS):
            call()
        return (time.thread_time() - began) * 1e9 / (2 * REPEATS * IN_CACHE)

    return round_
