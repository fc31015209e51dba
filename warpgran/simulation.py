"""Runs of a batch from their initial state to their end: output times, interruption, results."""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Literal

import numpy as np

from warpgran.case import Case
from warpgran.engines import Engine, Failure, NumPyEngine, WarpEngine
from warpgran.results import Results
from warpgran.schema import Status

if TYPE_CHECKING:
    import xarray as xr

Precision = Literal["float64", "float32"]
EngineName = Literal["warp", "numpy"]


class OptionError(ValueError):
    """A precision or engine that is not there; the message says what is."""


def simulate(
    cases: Case | Sequence[Case],
    *,
    device: str = "cpu",
    precision: Precision = "float64",
    engine: EngineName = "warp",
) -> xr.Dataset:
    """Compute one case or a batch of cases.

    Args:
        cases: Those of a batch share time.end, time.snapshots and time.series; all else may differ.
        device: "cpu", "cuda" or "cuda:N".
        precision: "float64" or "float32".
        engine: "warp", or "numpy" for the reference implementation.

    Returns:
        Thickness, velocity and volume fraction (run, time, cell) and the series (run, sample), in SI units with their
        names; `status` says how each run ended. What was not computed is NaN.

    Raises:
        OptionError: No such precision or engine.
        DeviceError: No such device.
        ValueError: The output times differ.
    """
    batch = [cases] if isinstance(cases, Case) else list(cases)
    return compute(batch, device=device, precision=precision, engine=engine)[0].to_dataset()


def compute(
    cases: Sequence[Case],
    *,
    device: str = "cpu",
    precision: Precision = "float64",
    engine: EngineName = "warp",
    progress: Callable[[float], None] = lambda t: None,
) -> tuple[Results, list[Failure]]:
    """Compute a batch, with Ctrl-C heard between two looks at the clock: what was computed until then is returned.

    Args:
        cases: as for `simulate`.
        device: as for `simulate`.
        precision: as for `simulate`.
        engine: as for `simulate`.
        progress: told now and then the mean time reached, s.

    Returns:
        The results, and where runs diverged.
    """
    results = Results(cases)
    began = time.perf_counter()
    runner = _engine(cases, device, precision, engine)
    kernel_seconds = 0.0
    with _interruptible() as interrupted:

        def go_on() -> bool:
            progress(float(runner.t.mean()))
            return not interrupted()

        for t in cases[0].output_times:
            start = time.perf_counter()
            if t > 0.0:
                runner.advance(t, go_on)
            kernel_seconds += time.perf_counter() - start
            if interrupted():
                break
            _record(results, runner, t)
    unfinished = (runner.status == Status.OK) & (runner.t < cases[0].time.end)
    results.status[:] = np.where(unfinished, Status.INTERRUPTED, runner.status)
    results.steps[:] = runner.steps
    results.end_time[:] = runner.t
    results.finish({
        "device": runner.device,
        "precision": precision,
        "engine": engine,
        "threads": 1,
        "wall_seconds": time.perf_counter() - began,
        "kernel_seconds": kernel_seconds,
    })  # fmt: skip
    return results, runner.failures


def _record(results: Results, runner: Engine, t: float) -> None:
    """Store what is due at t [s], of the runs that have reached it soundly."""
    there = (runner.status == Status.OK) & (runner.t == t)
    if t in results.time:
        results.put_profiles(t, there, runner.profiles())
    if t in results.series_time:
        results.put_scalars(t, there, runner.scalars())


def _engine(cases: Sequence[Case], device: str, precision: str, engine: str) -> Engine:
    if precision not in ("float64", "float32"):
        raise OptionError(f"precision: {precision!r} is not known; allowed: float64, float32")
    if engine == "numpy":
        if (device, precision) != ("cpu", "float64"):
            raise OptionError("engine: numpy computes on the cpu in float64 alone")
        return NumPyEngine(cases)
    if engine != "warp":
        raise OptionError(f"engine: {engine!r} is not known; allowed: warp, numpy")
    from warpgran.device import find_device

    return WarpEngine(cases, find_device(device), precision)


@contextmanager
def _interruptible() -> Iterator[Callable[[], bool]]:
    """Within the block Ctrl-C is remembered instead of raised; a second one is raised.

    Yields a function that tells whether it was pressed. Elsewhere than in the main thread nothing changes.
    """
    pressed = threading.Event()

    def remember(signum: int, frame: object) -> None:
        pressed.set()
        signal.signal(signal.SIGINT, previous)

    if threading.current_thread() is not threading.main_thread():
        yield pressed.is_set
        return
    previous = signal.signal(signal.SIGINT, remember)
    try:
        yield pressed.is_set
    finally:
        signal.signal(signal.SIGINT, previous)
