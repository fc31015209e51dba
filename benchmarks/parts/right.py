"""Whether a device is right: against the kernels on the CPU, the reference, and itself."""

from __future__ import annotations

import time
from typing import get_args

import numpy as np
from parts.report import heading
from parts.visit import Visit
from parts.work import Precision, column

from warpgran.case.case import Case
from warpgran.solve.engines import run_kernels, run_reference
from warpgran.solve.solver import Solver

TOLERANCE: dict[Precision, float] = {"float64": 1e-10, "float32": 1e-4}
"""Largest difference allowed of h/h0, v/sqrt(g h0) and phi over a short collapse."""
REPEATS = 3
CHECKS = 6
"""Number of checks, three of each precision."""


def collapse(end: float = 0.1) -> list[Case]:
    """A batch of short collapses that differ in slope, packing and grid."""
    times = {"time.end": end, "time.snapshots": [end / 2, end], "time.series": {"every": end / 4}}
    changes = [(0.0, 0.55, 401), (10.0, 0.62, 500), (22.0, 0.58, 320)]
    return [column(n, True, {**times, "slope.angle": a, "column.phi": phi}) for a, phi, n in changes]


Results = tuple[list[np.ndarray], np.ndarray]


def results(device: str, precision: Precision, cases: list[Case]) -> Results:
    """Snapshots of every run on a device ("numpy": by the reference), h/h0, v/sqrt(g h0), phi; and steps."""
    if device == "numpy":
        finished = run_reference(cases, lambda t: True)
    else:
        solver = Solver.holding(cases, precision_name=precision, device=device)
        finished = run_kernels(solver, cases, lambda t: True)
    height = cases[0].column.height
    scales = height, (9.81 * height) ** 0.5, 1.0
    scaled = [np.nan_to_num(profile) / scale for profile, scale in zip(finished.profiles, scales, strict=True)]
    return scaled, finished.steps


def differ(a: Results, b: Results, cases: list[Case]) -> float:
    """Largest difference between the snapshots of two results, over the cells of each run."""
    return max(
        float(np.abs(p[r, :, : case.grid.cells] - q[r, :, : case.grid.cells]).max())
        for p, q in zip(a[0], b[0], strict=True)
        for r, case in enumerate(cases)
    )


def correctness(visit: Visit) -> None:
    """Against the CPU kernels, the reference, and itself."""
    heading("Correctness: largest difference of h/h0, v/sqrt(g h0), phi of three collapses to 0.1 s")
    cases = collapse()
    reference = results("numpy", "float64", cases)
    for precision in get_args(Precision):
        with visit.trying(f"correctness in {precision}"):
            began = time.perf_counter()
            ours = results(visit.device, precision, cases)
            seconds = time.perf_counter() - began
            for other in ("cpu", "numpy"):
                theirs = reference if other == "numpy" else results(other, precision, cases)
                apart, steps = differ(ours, theirs, cases), bool((ours[1] == theirs[1]).all())
                right = apart <= TOLERANCE[precision]
                figure = {"precision": precision, "against": other, "difference": apart, "same_steps": steps}
                words = f"steps {'equal' if steps else 'DIFFER'}: {'right' if right else 'WRONG'}"
                visit.note("correctness", {**figure, "right": right}, f"{precision}, {other}: {apart:.1e}, {words}")
            same = all(
                np.array_equal(p, q)
                for _ in range(REPEATS)
                for p, q in zip(results(visit.device, precision, cases)[0], ours[0], strict=True)
            )
            visit.note("correctness", {"precision": precision, "against": "itself", "right": same},
                       f"{precision} four times: {'the same bits' if same else 'DIFFERENT BITS'}; "
                       f"the first took {seconds:.1f} s with compilation")  # fmt: skip
