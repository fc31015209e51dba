"""What a GPU does, in one visit of a few minutes: whether it is right, then how fast it is and what holds it back.

    python benchmarks/gpu.py [--device cuda] [--minutes 9] [--json gpu.json]

Needs no network. Prints as it goes and a short table last; the JSON file is written anew after every figure, so that
it holds what was measured however the visit ends. What does not fit the memory or the time is left out and named. With
`--device cpu --quick` it goes through the same steps at sizes for a CPU, to try the script itself.
"""

from __future__ import annotations

import argparse
import gc
import os
import signal
import statistics
import sys
import time
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, get_args

import numpy as np
import warp as wp
from parts.counts import ARCH, Count, counts, table, total
from parts.one_block import OneBlock
from parts.report import heading, machine
from parts.right import CHECKS, correctness
from parts.stages import stages
from parts.visit import Visit
from parts.work import Crews, Moving, Precision, Work, column

from warpgran.case.case import Case
from warpgran.files import StorageError
from warpgran.run.simulate import simulate
from warpgran.solve.blocks import Block
from warpgran.solve.device import DeviceError, find_device, free_memory_of, start_quietly
from warpgran.solve.schedule import Outputs
from warpgran.solve.solver import CHUNK, LANES, Solver
from warpgran.solve.state import bytes_of_run, most_runs, padded_cells
from warpgran.solve.variant import variant_of

PRECISIONS: tuple[Precision, ...] = get_args(Precision)
WARM_UP = 20
ROUNDS = 3
STEPS = 200
"""Steps of a launch that does many."""


@dataclass(frozen=True)
class Plan:
    """Sizes.

    Attributes:
        cells, runs: Of the combinations, the most telling first.
        round_seconds: That a round is to take.
        copy: Bytes that are copied to measure the memory.
        on_cpu: Cells of a run and steps of a round on the CPU of the host.
        stages: Runs of 1000 cells by stage.
        shapes: Runs of 1000 cells for which numbers of lanes and cells of a chunk are tried.
        batch: Runs of 1000 cells computed from rest to their end, with outputs; in each precision.
        end: Their time, s.
    """

    cells: tuple[int, ...] = (1000, 500, 4000, 16_000)
    runs: tuple[int, ...] = (1024, 1, 16_384, 64, 4096, 8, 256, 16)
    round_seconds: float = 0.3
    copy: int = 2**30
    on_cpu: tuple[int, int] = (1000, 100)
    stages: int = 4096
    shapes: tuple[int, ...] = (1, 64, 4096)
    batch: int = 4096
    end: float = 1.8


QUICK = Plan((64,), (1, 2), 0.002, 2**20, (64, 20), 2, (), 2, 0.05)


# How fast it is


def copy_rate(device: str, size: int) -> float:
    """Bytes a second, read and written, of a copy within the device."""
    source, target = (wp.zeros(size // 8, dtype=wp.float64, device=device) for _ in range(2))
    best = float("inf")
    for _ in range(ROUNDS + 1):
        wp.synchronize_device(device)
        began = time.perf_counter()
        for _ in range(10):
            wp.copy(target, source)
        wp.synchronize_device(device)
        best = min(best, (time.perf_counter() - began) / 10)
    return 2 * size / best


def steady(solver: Solver, seconds: float) -> float:
    """Seconds a step, median of rounds of about so many seconds."""

    def timed(steps: int) -> float:
        began = time.perf_counter()
        ended = solver.replay(budget=steps)
        seconds = time.perf_counter() - began
        if ended:
            raise RuntimeError("the runs have ended")
        return seconds / steps

    timed(WARM_UP)
    steps = max(WARM_UP, int(seconds / timed(WARM_UP)))
    return statistics.median(timed(steps) for _ in range(ROUNDS))


def endless(cells: int) -> Case:
    """A column, all of whose cells are visited, and whose only output is never reached."""
    return column(cells, False, {"time.end": 1e6, "time.snapshots": [1e6]})


def full(device: str, cells: int, runs: int, precision: str, **shape: int) -> Solver:
    """A solver full of endless columns."""
    gc.collect()  # the memory of the one before
    case = endless(cells)
    solver = Solver(runs, padded_cells(cells), variant_of(case, precision), Outputs.of(case), device, **shape)
    solver.load([case] * runs)
    return solver


def fits(visit: Visit, cells: int, runs: int, precision: str) -> str:
    """Why a combination cannot be held; nothing if it can."""
    case = column(cells, window=False)
    outputs, variant = Outputs.of(case), variant_of(case, precision)
    if runs > most_runs(padded_cells(cells), outputs, variant):
        return "more than an array of Warp holds"
    size, free = runs * bytes_of_run(cells, outputs, variant), free_memory_of(visit.device)
    return f"takes {size / 2**30:.0f} GiB, {free / 2**30:.0f} are free" if size > 0.8 * free else ""


def throughput(visit: Visit, plan: Plan, copied: float, floors: dict[str, Count]) -> None:
    """Cell-steps a second for every combination that fits."""
    heading("Throughput, all cells visited, million cell-steps a second (bytes: every array of a kernel moved once)")
    for cells in plan.cells:
        for runs in plan.runs:
            for precision in PRECISIONS:
                what = f"{runs} x {cells} in {precision}"
                why_not = fits(visit, cells, runs, precision)
                if why_not:
                    visit.leave_out(what, why_not)
                    continue
                seconds = 2.0 + 5 * plan.round_seconds + 2e-7 * runs * cells  # the last: made and loaded by the host
                with visit.trying(what, seconds) as possible:
                    if not possible:
                        continue
                    step = steady(full(visit.device, cells, runs, precision), plan.round_seconds)
                    rate = runs * cells / step
                    moved = rate * total(floors).bytes(precision)
                    figure = {"cells": cells, "runs": runs, "precision": precision, "seconds_a_step": step}
                    figure |= {"cell_steps_a_second": rate, "bytes_a_second": moved, "of_copy": moved / copied}
                    visit.note("throughput", figure, f"{what:28s}{rate / 1e6:12.1f}{step * 1e6:12.1f} us a step"
                               f"{moved / 1e9:10.0f} GB/s{moved / copied:8.0%} of a copy")  # fmt: skip


def by_stage(visit: Visit, plan: Plan, copied: float, floors: dict[str, Count]) -> None:
    """Each kernel alone, and what the launches of a step cost."""
    for precision in PRECISIONS:
        what = f"stages in {precision}"
        with visit.trying(what, 15.0) as possible:
            if not possible:
                continue
            runs = plan.stages
            heading(f"By stage, {runs} x 1000 in {precision}, ns a cell")
            case = column(1000, window=False)
            block = Block(tuple(range(runs)), runs, padded_cells(1000), variant_of(case, precision))
            moving = Moving(case, block, start=1e-3, device=visit.device)
            sum_of_all = 0.0
            for name, round_ in stages(moving, 1000, repeats=20).items():
                round_()
                cost = statistics.median(round_() for _ in range(ROUNDS))
                sum_of_all += cost
                moved = floors[name].bytes(precision) / cost if name in floors else 0.0
                figure = {"precision": precision, "kernel": name, "ns_a_cell": cost, "of_copy": moved * 1e9 / copied}
                words = f"{moved:10.0f} GB/s{moved * 1e9 / copied:8.0%} of a copy" if moved else ""
                visit.note("stages", figure, f"{name:16s}{cost:10.4f}{words}")
            whole = steady(moving.solver, plan.round_seconds) * 1e9 / (runs * 1000)
            visit.note("stages", {"precision": precision, "kernel": "step", "ns_a_cell": whole, "sum": sum_of_all},
                       f"{'step':16s}{whole:10.4f}, the sum of the above {sum_of_all:.4f}")  # fmt: skip
    with visit.trying("launches", 5.0) as possible:
        if possible:
            step = steady(full(visit.device, 32, 1, "float64"), plan.round_seconds)
            visit.note("launches", {"seconds_a_step": step},
                       f"a step of 32 cells, which is its launches alone: {step * 1e6:.2f} us")  # fmt: skip


def shapes(visit: Visit, plan: Plan) -> None:
    """Other lanes of a block and cells of a chunk than the chosen ones."""
    if plan.shapes:
        heading(f"Lanes of a block and cells of a chunk, float64, us a step; chosen are {LANES} and {CHUNK}")
    for runs in plan.shapes:
        for lanes in (64, 128, 256, 512):
            for chunk in (256, 1024, 4096):
                with visit.trying(f"{runs} x 1000, {lanes} lanes, {chunk} cells", 5.0) as possible:
                    if possible:
                        solver = full(visit.device, 1000, runs, "float64", lanes=lanes, chunk=chunk)
                        step = steady(solver, plan.round_seconds / 2)
                        visit.note("shapes", {"runs": runs, "lanes": lanes, "chunk": chunk, "seconds_a_step": step},
                                   f"{runs:6d} runs{lanes:6d} lanes{chunk:6d} cells{step * 1e6:12.1f}")  # fmt: skip


def whole(visit: Visit, plan: Plan) -> None:
    """Batches from rest to their end, with their outputs, on the device; and the same on all cores."""
    heading(f"Collapses of 1000 cells at 22 degrees from rest to {plan.end:g} s, 181 samples, 4 snapshots")
    times = {"time.end": plan.end, "time.snapshots": {"every": plan.end / 4}, "time.series": {"every": plan.end / 180}}
    case = column(1000, True, {**times, "slope.angle": 22.0, "grid.right": 1.6})
    cores = os.cpu_count() or 1
    for where, runs in ((visit.device, plan.batch), ("cpu", min(plan.batch, 16 * cores))):
        for precision in PRECISIONS:
            with visit.trying(f"{runs} collapses on {where} in {precision}", 40 * plan.end) as possible:
                if not possible:
                    continue
                simulate([case] * min(runs, cores), device=where, precision=precision)  # compiles
                data = simulate([case] * runs, device=where, precision=precision)
                seconds, loops = data.attrs["wall_seconds"], data.attrs["kernel_seconds"]
                rate, a_minute = data.attrs["cell_steps"] / loops, 60 * runs / seconds
                figure = {"device": where, "precision": precision, "runs": runs, "wall_seconds": seconds}
                figure |= {"kernel_seconds": loops, "cell_steps_a_second": rate, "a_minute": a_minute}
                words = f"{a_minute:,.0f} a minute; {rate / 1e6:,.0f} million cell-steps a second in time loops"
                visit.note("collapses", figure, f"{where:8s}{precision:10s}{runs:6d} runs{seconds:10.2f} s, {words}")


def one_block(visit: Visit, plan: Plan) -> None:
    """Small runs by a block each, many steps a launch, against the step's launches in a graph."""
    if plan.shapes:
        heading("A block a run and many steps a launch (one_block.py), 1000 cells, us a step; in brackets the graph's")
    for runs in plan.shapes:
        for precision in PRECISIONS:
            for lanes in (256, 512):
                with visit.trying(f"one block a run, {runs} x 1000 in {precision}, {lanes} lanes", 8.0) as possible:
                    if not possible:
                        continue
                    solver = full(visit.device, 1000, runs, precision, lanes=lanes, chunk=padded_cells(1000))
                    graph = steady(solver, plan.round_seconds / 2)
                    solver.load([endless(1000)] * runs)
                    solver.replay(budget=STEPS)
                    expected = [u.numpy().copy() for u in solver.state.U]
                    solver.load([endless(1000)] * runs)
                    blocks = OneBlock(solver)
                    blocks.steps(STEPS)
                    same = all(map(np.array_equal, [u.numpy() for u in solver.state.U], expected))
                    block = statistics.median(timed(blocks, solver) for _ in range(ROUNDS))
                    visit.note("one_block", {"runs": runs, "precision": precision, "lanes": lanes, "same_bits": same,
                                             "seconds_a_step": block, "seconds_a_step_by_graph": graph},
                               f"{runs:6d} runs in {precision}{lanes:6d} lanes{block * 1e6:12.1f} ({graph * 1e6:.1f})"
                               f"{'' if same else ', OTHER BITS'}")  # fmt: skip


def timed(blocks: OneBlock, solver: Solver) -> float:
    """Seconds a step of runs in motion."""
    wp.synchronize_device(solver.device)
    began = time.perf_counter()
    blocks.steps(STEPS)
    wp.synchronize_device(solver.device)
    return (time.perf_counter() - began) / STEPS


def against_cpu(visit: Visit, plan: Plan) -> None:
    """The same work on all cores of this host."""
    cores = os.cpu_count() or 1
    cells, steps = plan.on_cpu
    heading(f"The CPU of this host, {cores} threads, {16 * cores} runs of {cells} cells, all visited")
    for precision in PRECISIONS:
        with visit.trying(f"the CPU in {precision}", 0.02 * cells) as possible:
            if possible:
                round_ = Crews().round_of(Work(cells, 16 * cores, precision, False, cores), steps)
                round_()
                cost = statistics.median(round_() for _ in range(ROUNDS))
                visit.note("cpu", {"precision": precision, "cell_steps_a_second": 1e9 / cost, "threads": cores},
                           f"{precision}: {1e3 / cost:.1f} million cell-steps a second")  # fmt: skip


# The visit


def passed(found: dict[str, Any]) -> int:
    """How many checks found the device right."""
    return sum(check["right"] for check in found.get("correctness", []))


def in_short(found: dict[str, Any]) -> str:
    """The figures that matter, in a few lines."""
    lines = []
    lines.append(f"checks passed         {passed(found)} of {CHECKS}")
    for precision in PRECISIONS:
        best = max((f for f in found.get("throughput", []) if f["precision"] == precision),
                   key=lambda f: f["cell_steps_a_second"], default=None)  # fmt: skip
        if best:
            line = f"{precision:8s}best         {best['cell_steps_a_second'] / 1e6:,.0f} million cell-steps/s, "
            line += f"{best['runs']} x {best['cells']}, {best['of_copy']:.0%} of a copy"
            host = [f["cell_steps_a_second"] for f in found.get("cpu", []) if f["precision"] == precision]
            lines.append(line + (f", {best['cell_steps_a_second'] / host[0]:.1f} times all cores" if host else ""))
    lines += [f"{f['precision']:8s}on {f['device']:10s}{f['a_minute']:,.0f} collapses a minute"
              for f in found.get("collapses", [])]  # fmt: skip
    lines += [f"a step's launches     {f['seconds_a_step'] * 1e6:.1f} us" for f in found.get("launches", [])]
    lines.append(f"left out              {len(found['left_out'])} measurements")
    return "\n".join(lines)


def measure(visit: Visit, plan: Plan) -> None:
    """All there is to find, what matters most first."""
    case = column(1000, window=False)
    floors = counts(variant_of(case, "float64"))
    heading(f"Of a cell and step, counted from the code for sm_{ARCH}, float64")
    visit.note("counts", {name: asdict(count) for name, count in floors.items()}, table(floors))
    copied = copy_rate(visit.device, plan.copy)
    bound = {precision: copied / total(floors).bytes(precision) for precision in PRECISIONS}
    words = ", ".join(f"{rate / 1e6:,.0f} in {precision}" for precision, rate in bound.items())
    visit.note("memory", {"copy_bytes_a_second": copied, "bound": bound},
               f"copy within the device: {copied / 1e9:.0f} GB/s; at that rate, with no cache between\n"
               f"two kernels, so many million cell-steps a second: {words}")  # fmt: skip
    correctness(visit)
    first, *others = plan.cells
    throughput(visit, replace(plan, cells=(first,)), copied, floors)
    by_stage(visit, plan, copied, floors)
    against_cpu(visit, plan)
    whole(visit, plan)
    one_block(visit, plan)
    shapes(visit, plan)
    throughput(visit, replace(plan, cells=tuple(others)), copied, floors)


def facts_of(device: str) -> dict[str, Any]:
    """The device, and the versions of all that has a part."""
    found = wp.get_device(device)
    facts: dict[str, Any] = {**machine(), "device": str(found), "device name": found.name}
    if found.is_cuda:
        facts |= {"compute capability": found.arch, "multiprocessors": found.sm_count,
                  "memory": f"{found.total_memory / 2**30:.1f} GiB", "free": f"{found.free_memory / 2**30:.1f} GiB",
                  "CUDA driver": wp.get_cuda_driver_version(),
                  "CUDA toolkit": wp.get_cuda_toolkit_version()}  # fmt: skip
    return facts


def main() -> None:
    """Measure, print and write; exit status 1 if something is not right or was not checked."""
    parser = argparse.ArgumentParser(description="What a GPU does with warpgran's kernels.")
    parser.add_argument("--device", default="cuda", help="cuda, cuda:N, or cpu to try the script")
    parser.add_argument("--minutes", type=float, default=9.0, help="after which nothing more is begun")
    parser.add_argument("--quick", action="store_true", help="sizes for a CPU")
    parser.add_argument("--json", type=Path, metavar="FILE", help="written anew after every figure")
    chosen = parser.parse_args()
    start_quietly()
    try:
        visit = Visit(find_device(chosen.device), chosen.minutes, chosen.json)
        visit.write()
    except (DeviceError, StorageError) as error:
        parser.error(str(error))
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, visit.stop)
    facts = facts_of(visit.device)
    visit.found["machine"] = facts
    print("\n".join(f"{name}: {value}" for name, value in facts.items()))
    try:
        measure(visit, QUICK if chosen.quick else Plan())
        visit.found["complete"] = True
    except KeyboardInterrupt:
        visit.leave_out("the rest", "interrupted")
    finally:
        visit.write()
        heading("In short")
        print(in_short(visit.found))
    sys.exit(0 if passed(visit.found) == CHECKS else 1)


if __name__ == "__main__":
    main()
