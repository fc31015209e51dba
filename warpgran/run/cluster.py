"""A study on many machines: each block of its runs is a task of a dask.distributed cluster.

Scheduling, and computing again what a lost worker had, are the cluster's; here blocks are cut, a bounded number of
them is kept in flight, and rows are stored by the submitting process alone, as they arrive.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from contextlib import nullcontext, suppress
from dataclasses import replace
from functools import cache
from importlib.metadata import version
from itertools import islice
from queue import Empty, SimpleQueue
from typing import TYPE_CHECKING, Any, NamedTuple

from warpgran.case.case import Case
from warpgran.errors import WarpgranError
from warpgran.results.layout import Layout
from warpgran.run.interrupt import interruptible
from warpgran.run.options import Options
from warpgran.run.outcome import Outcome, Sink, account
from warpgran.solve.engines import run_kernels, run_reference
from warpgran.solve.finished import Finished

if TYPE_CHECKING:
    from distributed import Client, Future

AHEAD = 3
"""Blocks in flight for each thread of the workers: one computed, the others on their way there or back."""
BALANCE = 4
"""Least number of blocks for each CPU thread, where there are runs enough, so that fast machines take more."""
LARGEST = 2**28
"""Most bytes of profiles of a block of several runs: they travel as one message."""
RETRIES = 2
"""How often a block that raised is tried again. Lost workers count apart, in the scheduler's allowed-failures."""
RECOUNT = 5.0
"""Seconds between two looks at how many workers there are."""
_NAMED = 8
_gpu = threading.Lock()
"""Held by the thread of a worker that uses its GPU: what others launched would become part of the graph it records."""


class ClusterError(WarpgranError, OSError):
    """No distributed, no scheduler, or a block that failed on a worker; the message says which."""


def connect(address: str, timeout: float = 10.0) -> Client:
    """A client of the scheduler at an address; close it, or use it as a context manager.

    Args:
        address: As `dask scheduler` prints it, "tcp://host:8786".
        timeout: Seconds to wait for an answer.

    Raises:
        ClusterError: distributed is not installed, or no scheduler answers.
    """
    try:
        from distributed import Client
    except ImportError:
        raise ClusterError('a cluster needs distributed: pip install "warpgran[distributed]"') from None
    try:
        return Client(address, timeout=timeout, set_as_default=False)
    except (OSError, ValueError) as error:
        said = str(error).partition("\n")[0]
        message = f"cluster: no scheduler answers at {address!r} ({said}); allowed: tcp://HOST:PORT"
        raise ClusterError(message) from error


def threads_of(client: Client) -> int:
    """Threads of all workers that a cluster has now."""
    return sum(client.nthreads().values())


def compute(
    sink: Sink,
    options: Options,
    places: Sequence[int],
    progress: Callable[[float], None] = lambda runs: None,
    *,
    client: Client,
) -> Outcome:
    """Compute runs of a study on a cluster; else as `run.threads.compute`, whose bits it gives.

    It begins when there is a worker, and uses workers that come later. A worker that dies costs its blocks, which
    others compute again. Ctrl-C keeps what has arrived; blocks that workers have begun they end, for nothing.

    Args:
        sink: Where results go.
        options: How to compute. The device is the workers', memory is that of one worker process, and threads have no
            part: every thread of every worker is used.
        places: Which of `sink.layout.runs` to compute.
        progress: Told now and then how many runs are done.
        client: Of the cluster, not an asynchronous one.

    Raises:
        ClusterError: A block failed on a worker, or the scheduler is gone. What has arrived is in the sink.
    """
    began = time.perf_counter()
    options = replace(options, threads=1)
    outcome, layout, done = Outcome(), sink.layout, 0
    blocks = iter(_blocks(layout, options, places, _room(client, options)) if len(places) else ())
    threads = _Threads(client)
    flight: dict[str, _Flight] = {}
    ready: SimpleQueue[Future] = SimpleQueue()

    with interruptible() as interrupted:
        try:
            while True:
                free = 0 if interrupted() else AHEAD * threads.now() - len(flight)
                for at in islice(blocks, max(0, free)):
                    cases = [layout.study[int(layout.runs[place])] for place in at]
                    future = client.submit(run_block, cases, options, versions(), pure=False, retries=RETRIES)
                    flight[future.key] = _Flight(future, at, cases)
                    future.add_done_callback(ready.put)
                if not flight or (interrupted() and ready.empty()):
                    break
                with suppress(Empty):
                    future = ready.get(timeout=0.2)
                    block = flight[future.key]
                    finished = _result(future, _numbers(layout, block.at))
                    del flight[future.key]
                    sink.put(block.at, layout.rows(block.cases, finished))
                    account(outcome, layout, block.at, block.cases, finished)
                    done += len(block.at)
                progress(done)
        finally:
            if client.status == "running":
                client.cancel([future for future, _, _ in flight.values()])
        outcome.interrupted = interrupted()
    outcome.kernel_seconds /= threads.most
    outcome.wall_seconds = time.perf_counter() - began
    return outcome


class _Flight(NamedTuple):
    """A block that is being computed."""

    future: Future
    at: Sequence[int]
    cases: list[Case]


class _Room(NamedTuple):
    """What there is for blocks: bytes for each thread of a worker, and threads."""

    bytes: float
    threads: int


class _Threads:
    """How many threads the workers have, asked at intervals; at least one, so that a worker to come finds work."""

    def __init__(self, client: Client) -> None:
        self._client = client
        self._asked = float("-inf")
        self._now = self.most = 1

    def now(self) -> int:
        """Threads at the last look."""
        if time.monotonic() > self._asked + RECOUNT:
            with suppress(OSError):  # a scheduler that is gone: the futures tell
                self._now = max(1, threads_of(self._client))
            self.most = max(self.most, self._now)
            self._asked = time.monotonic()
        return self._now


# On the workers


def run_block(cases: list[Case], options: Options, submitter: tuple[str, str]) -> Finished:
    """Compute a block of runs of one variant in this process.

    Args:
        cases: The runs.
        options: How to compute.
        submitter: `versions` of the process that asked.

    Raises:
        ValueError: The versions differ, or the device is not there.
    """
    check_in(options, submitter)
    if options.engine == "numpy":
        return run_reference(cases, lambda t: True)
    from warpgran.solve.solver import Solver

    with nullcontext() if options.device == "cpu" else _gpu:
        solver = Solver.holding(cases, precision_name=options.precision, device=options.device)
        return run_kernels(solver, cases, lambda t: True)


def check_in(options: Options, submitter: tuple[str, str]) -> float:
    """Make sure that this process can compute what the submitter would.

    Returns:
        Bytes that the runs may take here.

    Raises:
        ValueError: The versions differ, or the device is not there.
    """
    if versions() != submitter:
        here, there = (f"warpgran {package} with Warp {warp}" for package, warp in (versions(), submitter))
        raise ValueError(f"the worker has {here}, the submitting machine {there}")
    if options.engine == "numpy":
        return 0.0
    from warpgran.solve.device import find_device

    find_device(options.device)
    return options.bytes


@cache
def versions() -> tuple[str, str]:
    """Versions of warpgran and of Warp, on which the bits depend."""
    return version("warpgran"), version("warp-lang")


# On the submitting machine


def _room(client: Client, options: Options) -> _Room:
    """What the workers have, asked once there is one: memory of the smallest, of a GPU that of the first to answer."""
    asked = client.submit(check_in, options, versions(), pure=False, retries=RETRIES)
    memory: float = _result(asked, "the first worker")
    workers = client.scheduler_info(n_workers=-1)["workers"].values()
    if options.memory is None and options.device == "cpu":
        memory = min([memory, *(worker["memory_limit"] / 4 for worker in workers if worker["memory_limit"])])
    threads = [worker["nthreads"] for worker in workers]
    return _Room(memory / max(threads, default=1), max(1, sum(threads)))


def _blocks(layout: Layout, options: Options, places: Sequence[int], room: _Room) -> list[tuple[int, ...]]:
    """The places of each block: what one thread has memory for, and no more than gives every thread its share."""
    if options.engine == "numpy":
        return [(place,) for place in places]
    from warpgran.solve.blocks import plan

    on_cpu = options.device == "cpu"
    place_of = {int(layout.runs[place]): place for place in places}
    planned = plan(layout.study, list(place_of), layout.outputs, options.precision,
                   on_cpu=on_cpu, threads=1, memory=room.bytes)  # fmt: skip
    share = -(-len(places) // (room.threads * (BALANCE if on_cpu else 1)))
    blocks = []
    for block in planned:
        profiles = 3 * 8 * layout.outputs.snapshots * block.padded
        runs = max(1, min(share, LARGEST // max(1, profiles)))
        blocks += [block.runs[first : first + runs] for first in range(0, len(block.runs), runs)]
    return [tuple(place_of[run] for run in block) for block in blocks]


def _result(future: Future, who: str) -> Any:
    """What a task returned.

    Raises:
        ClusterError: It raised, or will never end.
    """
    if future.status == "cancelled":
        raise ClusterError("cluster: the connection to the scheduler was lost")
    try:
        return future.result()
    except Exception as error:
        said = f"{type(error).__name__}: {error}".partition("\n")[0]
        raise ClusterError(f"cluster: {who}: {said}") from error


def _numbers(layout: Layout, at: Sequence[int]) -> str:
    """The runs at these places in words."""
    runs = [int(layout.runs[place]) for place in at]
    more = f" and {len(runs) - _NAMED} more" if len(runs) > _NAMED else ""
    return f"run{'s' if len(runs) > 1 else ''} {', '.join(map(str, runs[:_NAMED]))}{more}"
