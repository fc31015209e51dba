"""Blocks of a study computed on the threads of this machine."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from itertools import cycle
from typing import TYPE_CHECKING, Any

from warpgran.case.case import Case
from warpgran.errors import OptionError
from warpgran.results.layout import Layout
from warpgran.run.interrupt import interruptible
from warpgran.run.options import Options
from warpgran.run.outcome import Outcome, Sink, account
from warpgran.solve.engines import run_kernels, run_reference
from warpgran.solve.finished import Finished

if TYPE_CHECKING:
    from warpgran.solve.blocks import Block
    from warpgran.solve.solver import Solver


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


def _blocks(layout: Layout, options: Options, places: Sequence[int]) -> list[tuple[tuple[int, ...], Block | None]]:
    """The places of each block, and what its solver must be; no solver for the reference."""
    if options.engine == "numpy":
        return [((place,), None) for place in places]
    from warpgran.solve.blocks import plan
    from warpgran.solve.device import find_devices

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
        from warpgran.solve.solver import Solver

        shape = block.room, block.padded, block.variant
        if getattr(self._kept, "shape", None) != shape:
            self._kept.solver = None  # gives its memory back before the next takes some
            self._kept.solver = Solver(*shape, self._layout.outputs, self.device())
            self._kept.shape = shape
        solver: Solver = self._kept.solver
        return solver
