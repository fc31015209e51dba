"""Blocks of a study computed on the threads of this machine, each thread on its device."""

from __future__ import annotations

import threading
import time
from collections.abc import Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from itertools import cycle
from typing import TYPE_CHECKING

from warpgran.case.case import Case
from warpgran.errors import OptionError
from warpgran.results.layout import Layout
from warpgran.run.interrupt import interruptible
from warpgran.run.options import Options
from warpgran.run.outcome import Outcome, Progress, Sink, store
from warpgran.solve.engines import run_kernels, run_reference
from warpgran.solve.finished import Finished

if TYPE_CHECKING:
    from warpgran.solve.blocks import Block
    from warpgran.solve.solver import Solver

POLL = 0.2
"""Seconds between two calls of progress while no block ends."""


def compute(sink: Sink, options: Options, runs: Sequence[int], progress: Progress = lambda runs: None) -> Outcome:
    """Compute runs of a study and store each block of them as it ends; see `run.outcome.Compute`.

    Ctrl-C is seen at the next call of `go_on`, a fraction of a second later: runs under way are stored as far as they
    are, with the status interrupted. A run that is the only one of its result goes on from what the sink has kept of
    it. A sink that fails ends the computation.

    Raises:
        OptionError: More or fewer threads than the devices allow.
        DeviceError: No such device.
        MemoryError: A single run takes more than the memory.
    """
    began = time.perf_counter()
    layout = sink.layout
    end = layout.outputs.times[-1]
    blocks = _blocks(layout, options, runs)
    workers = _Workers(options, layout)
    outcome = Outcome(threads=options.workers, resumed_at=_kept_at(sink))
    done: dict[int, float] = {}
    stop = threading.Event()

    def work(n: int) -> tuple[Sequence[int], list[Case], Finished]:
        numbers, block = blocks[n]
        if stop.is_set() and n > 0:  # the first goes on a little, so that what an earlier session kept is kept
            raise _StoppedError
        cases = [layout.study[run] for run in numbers]

        def go_on(t: float) -> bool:
            done[n] = len(numbers) * t / end
            return not stop.is_set()

        solver = workers.solver(block) if block else None
        finished = run_kernels(solver, cases, go_on, sink.keeper) if solver else run_reference(cases, go_on)
        return numbers, cases, finished

    at_once = min(options.workers, max(1, len(blocks)))
    with interruptible() as interrupted, ThreadPoolExecutor(at_once) as pool:
        futures = {pool.submit(work, n): n for n in range(len(blocks))}
        waiting: set[Future[tuple[Sequence[int], list[Case], Finished]]] = set(futures)
        try:
            while waiting:
                ready, waiting = wait(waiting, timeout=POLL, return_when=FIRST_COMPLETED)
                if interrupted():
                    stop.set()
                for future in ready:
                    n = futures.pop(future)  # lets go of the results once they are stored
                    if isinstance(future.exception(), _StoppedError):
                        continue
                    numbers, cases, finished = future.result()
                    store(sink, outcome, numbers, cases, finished, at_once)
                    done[n] = float(len(numbers))
                progress(sum(done.copy().values()))
        finally:
            stop.set()
        outcome.interrupted = interrupted()
    outcome.kept_at = _kept_at(sink)
    outcome.wall_seconds = time.perf_counter() - began
    return outcome


def _kept_at(sink: Sink) -> float | None:
    """Time of the checkpoint that a sink has of its only run [s], None if it has none."""
    return sink.keeper.kept.numbers["t"] if sink.keeper and sink.keeper.kept else None


def _blocks(layout: Layout, options: Options, runs: Sequence[int]) -> list[tuple[Sequence[int], Block | None]]:
    """The runs of each block, and the block that its solver must fit; None for the reference."""
    if options.engine == "numpy":
        return [((run,), None) for run in runs]
    from warpgran.solve.blocks import plan
    from warpgran.solve.device import find_devices

    devices = find_devices(options.device)
    on_cpu = devices[0] == "cpu"
    if options.workers < len(devices) or (options.workers > len(devices) and not on_cpu):
        raise OptionError(
            f"threads: {options.workers} for {len(devices)} devices; allowed: one for each, more on the cpu"
        )
    planned = plan(layout.study, runs, layout.outputs, options.precision, on_cpu=on_cpu,
                   threads=options.workers, memory=options.bytes)  # fmt: skip
    return [(block.runs, block) for block in planned]


class _StoppedError(Exception):
    """A block that was not begun, since the computation ends."""


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

    def solver(self, block: Block) -> Solver:
        """A solver for a block."""
        from warpgran.solve.solver import Solver

        shape = block.capacity, block.padded, block.variant
        if getattr(self._kept, "shape", None) != shape:
            self._kept.solver = None  # gives its memory back before the next takes some
            self._kept.solver = Solver(*shape, self._layout.outputs, self.device())
            self._kept.shape = shape
        solver: Solver = self._kept.solver
        return solver
