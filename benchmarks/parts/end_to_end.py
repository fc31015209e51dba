"""Whole computations, as `warpgran run` makes them: what the time loop is of them, and where the rest goes."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from parts.work import Array, Round, Work, column

from warpgran.case.study import Study
from warpgran.results.in_memory import MemoryResults
from warpgran.results.layout import Layout
from warpgran.run.options import Options
from warpgran.run.outcome import Outcome, Sink
from warpgran.run.threads import compute
from warpgran.run.to_file import run_to_file

END = 0.3  # s


def headline(work: Work) -> Round:
    """A round that computes a batch from rest to 0.3 s and returns ns per cell-step by its attributes."""
    case = column(work.cells, work.window, {"time.end": END, "time.snapshots": [END], **work.scheme})
    layout = Layout(Study.of([case] * work.runs))
    options = Options(precision=work.precision, threads=work.threads)

    def round_() -> float:
        outcome = compute(MemoryResults(layout), options, range(work.runs))
        return outcome.kernel_seconds * 1e9 / outcome.cell_steps

    return round_


def study_of(runs: int) -> Study:
    """Runs of 500 cells over angle and K, to 0.5 s, with 51 samples and 5 snapshots."""
    case = column(500, True, {"grid.right": 1.6, "time.end": 0.5, "time.snapshots": [0.1, 0.2, 0.3, 0.4, 0.5],
                          "time.series": {"every": 0.01}})  # fmt: skip
    over = {"slope.angle": np.linspace(0.0, 22.0, runs), "rheology.K": np.linspace(0.0, 8.0, runs)}
    return case.sweep({key: values.tolist() for key, values in over.items()}, mode="zip")


def whole_run(runs: int) -> dict[str, float]:
    """Seconds of a study, from nothing to its file, by what they were spent on; and ns per cell-step, megabytes.

    start: interpreter, imports and Warp, in a process of its own. study: the cases, made and checked. file: from the
    study to the finished file, of which kernels: time loops, averaged over the threads; around: the file opened, and
    brought to its final form at the end; rest: all else, such as the threads' wait for each other. storing: the part of
    the rest, or of the kernels' time, in which rows were written.
    """
    start = _start_up()
    began = time.perf_counter()
    study = study_of(runs)
    made = time.perf_counter() - began
    storing = [0.0]
    with TemporaryDirectory() as folder:
        path = Path(folder) / "study.h5"
        began, processor = time.perf_counter(), time.process_time()
        outcome = run_to_file(study, path, Options(), compute=partial(_compute, storing))
        seconds = time.perf_counter() - began
        size = path.stat().st_size
    return {
        "start": start,
        "study": made,
        "file": seconds,
        "kernels": outcome.kernel_seconds,
        "storing": storing[0],
        "around": seconds - outcome.wall_seconds,
        "rest": outcome.wall_seconds - outcome.kernel_seconds,
        "ns_per_cell_step": outcome.kernel_seconds * 1e9 / outcome.cell_steps,
        "cell_steps": outcome.cell_steps,
        "processors": (time.process_time() - processor) / seconds,
        "megabytes": size / 1e6,
    }


def _start_up() -> float:
    code = "import warpgran.cli.app, warpgran.run.to_file, warpgran.solve.device as device; device.start_quietly()"
    began = time.perf_counter()
    subprocess.run([sys.executable, "-c", code], check=True)
    return time.perf_counter() - began


class _Timed:
    """A sink that measures how long it takes to store."""

    def __init__(self, sink: Sink, seconds: list[float]) -> None:
        self.layout, self._sink, self._seconds = sink.layout, sink, seconds

    def put(self, at: Sequence[int], rows: Mapping[str, Array]) -> None:
        """Store rows."""
        began = time.perf_counter()
        self._sink.put(at, rows)
        self._seconds[0] += time.perf_counter() - began


def _compute(
    seconds: list[float], sink: Sink, options: Options, places: Sequence[int], progress: Callable[[float], None]
) -> Outcome:
    timed: Any = _Timed(sink, seconds)
    return compute(timed, options, places, progress=progress)
