"""A study on a cluster: the same bits as on one machine, workers that are killed, and what goes wrong told."""

from __future__ import annotations

import os
import signal
import socket
import sys
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from helpers.cases import VIOLENT, small

import warpgran as wg
from warpgran.case.study import Study
from warpgran.results.in_memory import MemoryResults
from warpgran.results.layout import Layout
from warpgran.run import cluster
from warpgran.run import outcome as outcomes
from warpgran.run.cluster import ClusterError
from warpgran.run.options import Options
from warpgran.run.outcome import Outcome
from warpgran.run.to_file import run_to_file
from warpgran.schema import Status

distributed = pytest.importorskip("distributed")

pytestmark = pytest.mark.slow

OVER = {"slope.angle": [0.0, 10.0, 20.0, 25.0], "column.phi": [0.55, 0.58, 0.60, 0.62]}
RUNS = 16
MEASURED = ("date", "history", "wall_seconds", "kernel_seconds", "threads")
"""Attributes that depend on when and where a result was computed."""


@pytest.fixture(scope="module")
def client(whole: xr.Dataset) -> Iterator[Any]:
    """A client of two worker processes of one thread each, on this machine; kernels are compiled by then."""
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, host="127.0.0.1", dashboard_address=":0"
        ) as local,
        distributed.Client(local, set_as_default=False) as client,
    ):
        yield client


@pytest.fixture(scope="module")
def whole() -> xr.Dataset:
    """`study`, computed here."""
    return wg.simulate(study())


def study() -> Study:
    """Sixteen runs, of a tenth of a second each: eight blocks for two threads."""
    return small(**{"grid.cells": 600, "time.series": {"every": 0.02}}).sweep(OVER)


def computed(cases: Any, client: Any, options: Options | None = None, **how: Any) -> tuple[xr.Dataset, Outcome]:
    sink = MemoryResults(Layout(Study.of(cases)))
    options = options or Options()
    outcome = cluster.compute(sink, options, range(len(cases)), client=client, **how)
    return sink.to_dataset(**outcomes.attributes(options, outcome)), outcome


def assert_same(a: xr.Dataset, b: xr.Dataset) -> None:
    """All of two results but MEASURED, to the bit."""
    for data in (a, b):
        for name in MEASURED:
            data.attrs.pop(name, None)
    xr.testing.assert_identical(a, b)


def once(act: Callable[[], None]) -> Callable[[float], None]:
    """A progress that acts when the first runs have arrived."""
    waiting = [act]

    def progress(runs: float) -> None:
        if runs > 0 and waiting:
            waiting.pop()()

    return progress


def test_a_cluster_changes_no_bit(client: Any, whole: xr.Dataset) -> None:
    done: list[float] = []
    data, outcome = computed(study(), client, progress=done.append)
    assert_same(data, whole)
    assert done == sorted(done)
    assert done[-1] == RUNS
    assert 0.0 < outcome.kernel_seconds < outcome.wall_seconds


@pytest.mark.parametrize("how", [{"precision": "float32"}, {"engine": "numpy"}])
def test_so_it_is_in_single_precision_and_with_the_reference(client: Any, how: dict[str, Any]) -> None:
    cases = [small(**{"slope.angle": angle, "grid.cells": cells}) for angle, cells in ((5.0, 100), (22.0, 60))]
    data, _ = computed(cases, client, Options(**how))
    assert_same(data, wg.simulate(cases, **how))


def test_the_file_is_that_of_one_machine(client: Any, tmp_path: Path) -> None:
    here, there = tmp_path / "here.h5", tmp_path / "there.h5"
    run_to_file(study(), here, Options(), runs=[1, 5, 6, 14])
    run_to_file(study(), there, Options(), runs=[1, 5, 6, 14], compute=partial(cluster.compute, client=client))
    assert_same(wg.open_dataset(there).load(), wg.open_dataset(here).load())


def test_a_killed_worker_costs_no_run(client: Any, whole: xr.Dataset) -> None:
    pids = set(client.run(os.getpid).values())
    data, outcome = computed(study(), client, progress=once(lambda: os.kill(min(pids), signal.SIGKILL)))
    assert_same(data, whole)
    assert not outcome.failures
    client.wait_for_workers(2, timeout=30)
    assert set(client.run(os.getpid).values()) != pids


def test_runs_that_kill_their_workers_are_named(client: Any) -> None:
    def allow(failures: int, dask_scheduler: Any) -> None:
        dask_scheduler.allowed_failures = failures

    def kill() -> None:
        for pid in client.run(os.getpid).values():
            os.kill(pid, signal.SIGKILL)

    client.run_on_scheduler(allow, 0)
    try:
        with pytest.raises(ClusterError, match=r"^cluster: runs \d+, \d+: KilledWorker: "):
            computed(study(), client, progress=once(kill))
    finally:
        client.run_on_scheduler(allow, 3)
        client.wait_for_workers(2, timeout=30)


def test_a_diverged_run_is_named_and_leaves_the_others_alone(client: Any) -> None:
    cases = [small(), small(**VIOLENT), small(**{"slope.angle": 10.0})]
    data, outcome = computed(cases, client)
    assert list(data.status.values) == [Status.OK, Status.DIVERGED, Status.OK]
    assert list(outcome.failures) == [1]
    assert outcome.failures[1].startswith("diverged after t = 0 s")
    assert_same(data, wg.simulate(cases))


def test_ctrl_c_keeps_what_has_arrived(client: Any, whole: xr.Dataset) -> None:
    data, outcome = computed(study(), client, progress=once(lambda: signal.raise_signal(signal.SIGINT)))
    assert outcome.interrupted
    arrived = np.flatnonzero(data.status == Status.OK)
    assert 0 < arrived.size < RUNS
    assert set(np.delete(data.status.values, arrived)) == {Status.PENDING}
    np.testing.assert_array_equal(data.h[arrived], whole.h[arrived])
    assert_same(computed(study(), client)[0], whole)  # the cluster can be used again


def test_other_versions_on_a_worker_are_refused(client: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "versions", lambda: ("0.0", "1.0"))
    with pytest.raises(ClusterError, match=r"^cluster: the first worker: ValueError: the worker has warpgran "):
        computed(study(), client)
    monkeypatch.setattr(cluster, "_room", lambda client, options: cluster._Room(1e9, 2))  # a worker that came later
    with pytest.raises(ClusterError, match=r"^cluster: runs \d+, \d+: ValueError: the worker has warpgran "):
        computed(study(), client)


def test_blocks_hold_every_run_once_and_leave_none_idle() -> None:
    layout = Layout(study(), list(range(1, 16)))
    for room, most in ((cluster._Room(1e9, 1), 4), (cluster._Room(1e9, 2), 2), (cluster._Room(1e9, 100), 1)):
        blocks = cluster._blocks(layout, Options(), range(2, 15), room)
        assert sorted(run for block in blocks for run in block) == list(range(2, 15))
        assert max(map(len, blocks)) == most
    with pytest.raises(MemoryError):
        cluster._blocks(layout, Options(), range(15), cluster._Room(1e3, 1))


def test_no_scheduler_is_told() -> None:
    with socket.socket() as unused:
        unused.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{unused.getsockname()[1]}"
        with pytest.raises(ClusterError, match=rf"^cluster: no scheduler answers at '{address}'"):
            cluster.connect(address, timeout=0.5)
    with pytest.raises(ClusterError, match=r"^cluster: no scheduler answers at 'no such thing'"):
        cluster.connect("no such thing", timeout=0.5)


def test_the_extra_is_named_where_it_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ClusterError, match=r'pip install "warpgran\[distributed\]"'):
        cluster.connect("tcp://127.0.0.1:8786")
