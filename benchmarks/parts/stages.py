"""What each kernel of a step costs, launched again and again in one graph on columns in motion; and the divider."""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial
from typing import Any
from unittest import mock

import numpy as np
import warp as wp
from parts.work import Moving, Round

REPEATS = 200
IN_CACHE = 8192
"""Elements that fit the cache, and so many that a call of NumPy costs little."""


def stages(moving: Moving, cells: int, repeats: int = REPEATS) -> dict[str, Round]:
    """A round for each kernel of a step, in their order, that returns ns per cell of runs of so many cells."""
    moving.put_back()
    state = moving.solver.state
    rounds = {}
    for kernel, keywords in launches(moving.solver.step):
        with wp.ScopedCapture(device=moving.solver.device) as capture:
            for _ in range(repeats):
                wp.launch(kernel, **keywords)
        rounds[kernel.key.split("__")[-1]] = _round(capture.graph, repeats * state.runs * cells, moving)
    return rounds


def launches(step: Callable[[], None]) -> list[tuple[Any, dict[str, Any]]]:
    """What a step launches, without launching it."""
    noted: list[tuple[Any, dict[str, Any]]] = []
    with mock.patch.object(wp, "launch", lambda kernel, **keywords: noted.append((kernel, keywords))):
        step()
    return noted


def _round(graph: Any, cells: int, moving: Moving) -> Round:
    def round_() -> float:
        moving.put_back()
        wp.synchronize_device(moving.solver.device)
        began = time.perf_counter()
        wp.capture_launch(graph)
        wp.synchronize_device(moving.solver.device)
        return (time.perf_counter() - began) * 1e9 / cells

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
        began = time.perf_counter()
        for _ in range(2 * REPEATS):
            call()
        return (time.perf_counter() - began) * 1e9 / (2 * REPEATS * IN_CACHE)

    return round_
