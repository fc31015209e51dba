"""What a worker process of a cluster does: compute a block of runs, if it computes as the submitting process would."""

from __future__ import annotations

import threading
from contextlib import nullcontext
from functools import cache
from importlib.metadata import version

from warpgran.case.case import Case
from warpgran.run.options import Options
from warpgran.solve.engines import run_kernels, run_reference
from warpgran.solve.finished import Finished

_gpu = threading.Lock()
"""Held by the thread that uses the GPU: what others launched would become part of the graph it records."""


def run_block(cases: list[Case], options: Options, submitter: tuple[str, str]) -> Finished:
    """Compute a block of runs of one variant in this process.

    Args:
        cases: The runs.
        options: How to compute.
        submitter: `versions` of the submitting process.

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
    """Check that this process gives the bits of the submitting one.

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
