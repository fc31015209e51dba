"""A study from its initial states to its end: blocks on threads, interruption, results as they come."""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from itertools import cycle
from typing import TYPE_CHECKING, Any, Literal, Protocol

import numpy as np

from warpgran.case import Case
from warpgran.engines import Finished, run_kernels, run_reference
from warpgran.results import Layout, MemoryResults
from warpgran.sweep import Study

if TYPE_CHECKING:
    import xarray as xr
    from distributed import Client

    from warpgran.blocks import Block
    from warpgran.solver import Solver

Array = np.ndarray
Precision = Literal["float64", "float32"]
EngineName = Literal["warp", "numpy"]


class OptionError(ValueError):
    """A precision or engine that is not there, or an impossible number; the message says what is allowed."""


class Sink(Protocol):
    """Where results go."""

    layout: Layout

    def put(self, at: Sequence[int], rows: Mapping[str, Array]) -> None:
        """Store rows of `Layout.rows` at these places."""


@dataclass(frozen=True)
class Options:
    """How to compute.

    Attributes:
        device: "cpu", "cuda", "cuda:N", or several of a kind with commas between, which share the blocks.
        precision: "float64" or "float32".
        engine: "warp", or "numpy" for the reference implementation.
        threads: Blocks at once; all cores by default. A GPU has one.
        memory: Bytes for the runs being computed; a quarter of the machine's, or of the GPUs', by default.
    """

    device: str = "cpu"
    precision: Precision = "float64"
    engine: EngineName = "warp"
    threads: int | None = None
    memory: float | None = None

    def __post_init__(self) -> None:
        if self.precision not in ("float64", "float32"):
            raise OptionError(f"precision: {self.precision!r} is not known; allowed: float64, float32")
        if self.engine not in ("warp", "numpy"):
            raise OptionError(f"engine: {self.engine!r} is not known; allowed: warp, numpy")
        if self.engine == "numpy" and (self.device, self.precision) != ("cpu", "float64"):
            raise OptionError("engine: numpy computes on the cpu in float64 alone")
        if self.threads is not None and self.threads < 1:
            raise OptionError(f"threads: {self.threads} is out of range; allowed: >= 1")
        if self.memory is not None and not self.memory > 0:
            raise OptionError(f"memory: {self.memory:g} is out of range; allowed: > 0 bytes")

    @property
    def devices(self) -> tuple[str, ...]:
        """The devices, one after another."""
        return tuple(name.strip() for name in self.device.split(","))

    @property
    def workers(self) -> int:
        """Threads to use: all cores, but one for each GPU, whose blocks fill it, and for the reference."""
        if self.threads is not None:
            return self.threads
        return (os.cpu_count() or 1) if self.engine == "warp" and self.device == "cpu" else len(self.devices)

    @property
    def bytes(self) -> float:
        """Memory to use."""
        if self.memory is not None:
            return self.memory
        from warpgran.device import memory_of

        different = set(self.devices)
        return min(map(memory_of, different)) * len(different) / 4


@dataclass
class Outcome:
    """What there is to tell of a computation.

    Attributes:
        interrupted: Whether Ctrl-C ended it.
        failures: Words for each run that diverged, by its number in the study.
        cell_steps: Sum over runs of steps times cells.
        kernel_seconds: Of the time loops, averaged over the threads.
        wall_seconds: Of all.
    """

    interrupted: bool = False
    failures: dict[int, str] = field(default_factory=dict)
    cell_steps: int = 0
    kernel_seconds: float = 0.0
    wall_seconds: float = 0.0


def simulate(
    cases: Case | Sequence[Case],
    *,
    device: str = "cpu",
    precision: Precision = "float64",
    engine: EngineName = "warp",
    threads: int | None = None,
    client: Client | None = None,
) -> xr.Dataset:
    """Compute one case, a sweep of cases, or any batch of them.

    Args:
        cases: Those of a batch share time.end, time.snapshots and time.series; all else may differ.
        device: "cpu", "cuda", "cuda:N", or several GPUs with commas between, which share the runs.
        precision: "float64" or "float32".
        engine: "warp", or "numpy" for the reference implementation.
        threads: Blocks of runs computed at once; all cores by default. A GPU has one.
        client: Of a dask cluster, whose workers compute instead of this machine; threads then has no part.

    Returns:
        Thickness, velocity and volume fraction (run, time, cell) and the series (run, sample), in SI units with their
        names; `status` says how each run ended. What was not computed is NaN.

    Raises:
        OptionError: No such precision or engine.
        DeviceError: No such device.
        ValueError: The output times differ.
        ClusterError: A block failed on a worker, or the scheduler is gone.
        KeyboardInterrupt: Ctrl-C.
    """
    study = Study.of([cases] if isinstance(cases, Case) else cases)
    options = Options(device, precision, engine, threads)
    sink = MemoryResults(Layout(study))
    if client is None:
        outcome = compute(sink, options, range(len(study)))
    else:
        from warpgran import cluster

        options = replace(options, threads=cluster.threads_of(client) or None)
        outcome = cluster.compute(sink, options, range(len(study)), client=client)
    if outcome.interrupted:
        raise KeyboardInterrupt
    return sink.to_dataset(**attributes(options, outcome))


def attributes(options: Options, outcome: Outcome) -> dict[str, Any]:
    """Attributes of a result that tell how it was computed."""
    return {
        "device": options.device,
        "precision": options.precision,
        "engine": options.engine,
        "threads": options.workers,
        "cell_steps": outcome.cell_steps,
        "kernel_seconds": outcome.kernel_seconds,
        "wall_seconds": outcome.wall_seconds,
    }


def compute(
    sink: Sink, options: Options, places: Sequence[int], progress: Callable[[float], None] = lambda runs: None
) -> Outcome:
    """Compute runs of a study and hand each block of them to the sink as it ends.

    Ctrl-C is heard at the next look at the clock, a fraction of a second later: runs under way are handed over as far
    as they are, with the status interrupted. A sink that fails ends the computation.

    Args:
        sink: Where results go.
        options: How to compute.
        places: Which of `sink.layout.runs` to compute.
        progress: Told now and then how many runs are done, parts of runs included.
    """
    outcome = Outcome()
    began = time.perf_counter()
    layout = sink.layout
    end = layout.outputs.times[-1]
    blocks = _blocks(layout, options, places)
    done: dict[int, float] = {}

    with interruptible() as interrupted:
        stop = threading.Event()
        workers = _Workers(options, layout)

        def work(n: int) -> tuple[Sequence[int], list[Case], Finished]:
            at = blocks[n][0]
            cases = [layout.study[int(layout.runs[place])] for place in at]

            def go_on(t: float) -> bool:
                done[n] = len(at) * t / end
                return not stop.is_set()

            if stop.is_set():
                raise _StoppedError
            solver = workers.solver(blocks[n][1])
            return at, cases, run_kernels(solver, cases, go_on) if solver else run_reference(cases, go_on)

        with ThreadPoolExecutor(min(options.workers, max(1, len(blocks)))) as pool:
            futures = {pool.submit(work, n): n for n in range(len(blocks))}
            try:
                waiting: set[Future[Any]] = set(futures)
                while waiting:
                    ready, waiting = wait(waiting, timeout=0.2, return_when=FIRST_COMPLETED)
                    if interrupted():
                        stop.set()
                    for future in ready:
                        if isinstance(future.exception(), _StoppedError):
                            continue
                        at, cases, finished = future.result()
                        sink.put(at, layout.rows(cases, finished))
                        account(outcome, layout, at, cases, finished)
                        done[futures.pop(future)] = float(len(at))
                    progress(sum(done.copy().values()))
            finally:
                stop.set()
        outcome.interrupted = interrupted()
    outcome.kernel_seconds /= min(options.workers, max(1, len(blocks)))
    outcome.wall_seconds = time.perf_counter() - began
    return outcome


def account(outcome: Outcome, layout: Layout, at: Sequence[int], cases: Sequence[Case], finished: Finished) -> None:
    """Add a block that has ended to what there is to tell."""
    cells = np.array([case.grid.cells for case in cases])
    outcome.cell_steps += int((finished.steps * cells).sum())
    outcome.kernel_seconds += finished.seconds
    for r, failure in finished.failures.items():
        outcome.failures[int(layout.runs[at[r]])] = str(failure)


def _blocks(layout: Layout, options: Options, places: Sequence[int]) -> list[tuple[tuple[int, ...], Block | None]]:
    """The places of each block, and what its solver must be; no solver for the reference."""
    if options.engine == "numpy":
        return [((place,), None) for place in places]
    from warpgran.blocks import plan
    from warpgran.device import find_devices

    devices = find_devices(options.device)
    on_cpu = devices[0] == "cpu"
    if options.workers < len(devices) or (options.workers > len(devices) and not on_cpu):
        raise OptionError(
            f"threads: {options.workers} for {len(devices)} devices; allowed: one for each, more on the cpu"
        )
    place_of = {int(layout.runs[place]): place for place in places}
    planned = plan(layout.study, list(place_of), layout.outputs, options.precision, on_cpu=on_cpu,
                   threads=options.workers, memory=options.bytes)  # fmt: skip
    return [(tuple(place_of[run] for run in block.runs), block) for block in planned]


class _StoppedError(Exception):
    """A block that was not begun."""


class _Workers:
    """Solvers of this computation, which each thread keeps, on its device, for its next block of the same shape."""

    def __init__(self, options: Options, layout: Layout) -> None:
        self._layout = layout
        self._devices = cycle(options.devices)
        self._kept = threading.local()

    def device(self) -> str:
        """The device of this thread: the next in turn, and from then on the same."""
        if not hasattr(self._kept, "device"):
            self._kept.device = next(self._devices)
        name: str = self._kept.device
        return name

    def solver(self, block: Block | None) -> Solver | None:
        """A solver for a block; None if the reference is to compute it."""
        if block is None:
            return None
        from warpgran.solver import Solver

        shape = block.room, block.padded, block.variant
        if getattr(self._kept, "shape", None) != shape:
            self._kept.solver = None  # gives its memory back before the next takes some
            self._kept.solver = Solver(*shape, self._layout.outputs, self.device())
            self._kept.shape = shape
        solver: Solver = self._kept.solver
        return solver


@contextmanager
def interruptible() -> Iterator[Callable[[], bool]]:
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
