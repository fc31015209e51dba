"""Blocks of a study computed by the workers of a dask.distributed cluster, a task a block.

The cluster schedules, and computes again what a lost worker had. Here blocks are cut, a bounded number of them is kept
in flight, and rows are stored by the submitting process alone, as they arrive.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import islice
from queue import Empty, SimpleQueue
from typing import TYPE_CHECKING, Any, NamedTuple

from warpgran.case.case import Case
from warpgran.errors import WarpgranError
from warpgran.results.layout import Layout
from warpgran.run.interrupt import interruptible
from warpgran.run.options import Options
from warpgran.run.outcome import Outcome, Progress, Sink, store
from warpgran.run.worker import check_in, run_block, versions

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
"""Seconds between two questions how many workers there are."""
POLL = 0.2
"""Seconds between two calls of progress while no block ends."""
NAMED = 8
"""Most runs that an error names."""


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
    runs: Sequence[int],
    progress: Progress = lambda runs: None,
    *,
    client: Client,
) -> Outcome:
    """Compute runs of a study on a cluster, with the bits of `threads.compute`; see `run.outcome.Compute`.

    It begins when there is a worker, and uses workers that come later. A worker that dies costs its blocks, which
    others compute again. Ctrl-C keeps what has arrived; blocks that workers have begun they end, for nothing.

    Args:
        sink: Where results go.
        options: How to compute. The device is the workers', memory is that of one worker process, and threads have no
            part: every thread of every worker is used.
        runs: Numbers of the runs.
        progress: Called with the number of runs done.
        client: Client of the cluster, not an asynchronous one.

    Raises:
        ClusterError: A block failed on a worker, or the scheduler is gone. What has arrived is in the sink.
    """
    began = time.perf_counter()
    options = replace(options, threads=1)
    outcome, study, done = Outcome(), sink.layout.study, 0
    blocks = iter(_blocks(sink.layout, options, runs, _room(client, options)) if len(runs) else ())
    threads = _Threads(client)
    flight: dict[str, _Flight] = {}
    ready: SimpleQueue[Future] = SimpleQueue()

    with interruptible() as interrupted:
        try:
            while True:
                free = 0 if interrupted() else AHEAD * threads.now() - len(flight)
                for block in islice(blocks, max(0, free)):
                    cases = [study[run] for run in block]
                    future = client.submit(run_block, cases, options, versions(), pure=False, retries=RETRIES)
                    flight[future.key] = _Flight(future, block, cases)
                    future.add_done_callback(ready.put)
                if not flight or (interrupted() and ready.empty()):
                    break
                with suppress(Empty):
                    future = ready.get(timeout=POLL)
                    _, block, cases = flight[future.key]
                    finished = _result(future, _numbers(block))
                    del flight[future.key]
                    store(sink, outcome, block, cases, finished, threads.most)
                    done += len(block)
                progress(done)
        finally:
            if client.status == "running":
                client.cancel([future for future, _, _ in flight.values()])
        outcome.interrupted = interrupted()
    outcome.threads = threads.most
    outcome.wall_seconds = time.perf_counter() - began
    return outcome


class _Flight(NamedTuple):
    """A block that is being computed."""

    future: Future
    runs: tuple[int, ...]
    cases: list[Case]


class _Room(NamedTuple):
    """Memory of each thread of a worker, in bytes, and threads of all workers."""

    bytes: float
    threads: int


class _Threads:
    """Number of threads of the workers, asked at intervals; at least one, so that a worker to come finds work."""

    def __init__(self, client: Client) -> None:
        self._client = client
        self._asked = float("-inf")
        self._now = self.most = 1

    def now(self) -> int:
        """Threads at the last question."""
        if time.monotonic() > self._asked + RECOUNT:
            with suppress(OSError):  # the scheduler is gone, which the futures report
                self._now = max(1, threads_of(self._client))
            self.most = max(self.most, self._now)
            self._asked = time.monotonic()
        return self._now


def _room(client: Client, options: Options) -> _Room:
    """What the workers have, asked once there is one: memory of the smallest, of a GPU that of the first to answer."""
    asked = client.submit(check_in, options, versions(), pure=False, retries=RETRIES)
    memory: float = _result(asked, "the first worker")
    workers = client.scheduler_info(n_workers=-1)["workers"].values()
    if options.memory is None and options.device == "cpu":
        memory = min([memory, *(worker["memory_limit"] / 4 for worker in workers if worker["memory_limit"])])
    threads = [worker["nthreads"] for worker in workers]
    return _Room(memory / max(threads, default=1), max(1, sum(threads)))


def _blocks(layout: Layout, options: Options, runs: Sequence[int], room: _Room) -> list[tuple[int, ...]]:
    """The runs of each block: what one thread has memory for, and no more than gives every thread its share."""
    if options.engine == "numpy":
        return [(run,) for run in runs]
    from warpgran.solve.blocks import plan

    on_cpu = options.device == "cpu"
    planned = plan(layout.study, runs, layout.outputs, options.precision,
                   on_cpu=on_cpu, threads=1, memory=room.bytes)  # fmt: skip
    share = -(-len(runs) // (room.threads * (BALANCE if on_cpu else 1)))
    blocks = []
    for block in planned:
        profiles = 3 * 8 * layout.outputs.snapshots * block.padded
        most = max(1, min(share, LARGEST // max(1, profiles)))
        blocks += [block.runs[first : first + most] for first in range(0, len(block.runs), most)]
    return blocks


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


def _numbers(runs: Sequence[int]) -> str:
    """Runs in words."""
    more = f" and {len(runs) - NAMED} more" if len(runs) > NAMED else ""
    return f"run{'s' if len(runs) > 1 else ''} {', '.join(map(str, runs[:NAMED]))}{more}"
