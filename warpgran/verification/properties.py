"""What holds of any run that validation accepts, over quasi-random points of the space of `space`.

Each run ends soundly, finite, h >= 0, 0 < phi < 1; between closed ends it keeps its mass; nothing is thrown out faster
than pressure and gravity can; and it does not matter what else is in its batch.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np
import xarray as xr
from scipy.stats import qmc

from warpgran.analysis.selection import one_run
from warpgran.case.case import Case
from warpgran.run.options import Precision
from warpgran.run.simulate import simulate_quietly
from warpgran.schema import FIELDS, SERIES, Status
from warpgran.verification.check import CheckOptions, CheckResult, Row
from warpgran.verification.space import AXES, SCALES, case_at

PRECISIONS: tuple[Precision, ...] = ("float64", "float32")
MASS = {"float64": 1e-12, "float32": 1e-4}
"""By how much the mass between closed ends may change, as a fraction; rounding of up to 20,000 steps."""
EXCESS, STEEP = 0.05, 45.0
"""By how much phi may pass the larger of its initial value and phi_stat, on slopes of no more than so many degrees and
with a stabilization of xi >= 1."""
ROUNDING = {"float64": 1e-12, "float32": 3e-4}
"""The same under order 2, in any run of alpha = 2; of another, over alpha - 1: phi is a power 1/(alpha - 1) of what is
rounded, in float32 some 2000 units in the last place over up to 20,000 steps."""
SPEED = 2.0
"""How many times `speed_bound` may be reached."""
COMPANY = 16
"""Every so many runs one is computed again in other company."""


@dataclass
class Findings:
    """Extremes and faults over many runs.

    Attributes:
        runs: Number of runs.
        unfinished: Number of runs that ran out of steps before their end; what they recorded is judged.
        cell_steps: Cell-steps computed.
        mass: Largest change of mass between closed ends, a fraction, by precision.
        excess: Largest phi over max(phi_0, phi_stat), less 1, by precision.
        speed: Largest |v| over `speed_bound`.
        least_phi: Smallest phi of a wet or dry cell.
        faults: Each property that does not hold, with the case and the precision.
    """

    runs: int = 0
    unfinished: int = 0
    cell_steps: int = 0
    mass: dict[str, float] = field(default_factory=lambda: dict.fromkeys(PRECISIONS, 0.0))
    excess: dict[str, float] = field(default_factory=lambda: dict.fromkeys(PRECISIONS, -1.0))
    speed: float = 0.0
    least_phi: float = 1.0
    faults: list[tuple[str, Case, str]] = field(default_factory=list)


def speed_bound(case: Case, t: np.ndarray) -> np.ndarray:
    """Speed [m/s] without dilatancy and friction at times t [s]: 2 sqrt(g_c h_0) + g sin|theta| t.

    The first is the speed of a dam-break wave into the dry, the second what a slope adds.
    """
    pull = case.slope.gravity * np.sin(np.radians(abs(case.slope.angle)))
    return np.asarray(2.0 * np.sqrt(case.g_c * case.column.height) + pull * t)


def points(scale: float, count: int, seed: int) -> np.ndarray:
    """Scrambled Sobol points, shape (count, axes), others for each scale; count is best a power of 2."""
    return np.asarray(qmc.Sobol(len(AXES), seed=seed + SCALES.index(scale)).random(count))


def examine(cases: Sequence[Case], precision: Precision, findings: Findings) -> None:
    """Compute cases of one scale as a batch, some of them again in other company, and add to the findings."""
    data = simulate_quietly(cases, precision=precision)
    findings.runs += len(cases)
    findings.cell_steps += int(data.attrs["cell_steps"])
    for r, case in enumerate(cases):
        run = one_run(data, r)
        findings.faults += [(what, case, precision) for what in _judge(case, run, precision, findings)]
    chosen = list(range(len(cases)))[::-COMPANY]
    again = simulate_quietly([cases[r] for r in chosen], precision=precision, threads=1)
    for k, r in enumerate(chosen):
        if not _same(one_run(data, r), one_run(again, k)):
            findings.faults.append(("its bits depend on the other runs of its batch", cases[r], precision))


def _same(a: xr.Dataset, b: xr.Dataset) -> bool:
    return all(np.array_equal(a[name], b[name], equal_nan=True) for name in (*FIELDS, *SERIES))


def _judge(case: Case, run: xr.Dataset, precision: Precision, findings: Findings) -> Iterable[str]:
    """What does not hold of a run; adds its extremes to the findings."""
    status = Status(int(run["status"]))
    if status == Status.STEP_LIMIT:
        findings.unfinished += 1
    elif status != Status.OK:
        yield str(run["failure"].item())
        return
    sampled = np.isfinite(run["mass"].values)
    t, mass, v_max = (run[name].values[..., sampled] for name in ("series_time", "mass", "v_max"))
    speed = float((v_max / speed_bound(case, t)).max())
    findings.speed = max(findings.speed, speed)
    if not speed <= SPEED:
        yield f"|v| is {speed:.3g} times 2 sqrt(g_c h_0) + g sin|theta| t"
    if "open" not in (case.scheme.left, case.scheme.right):
        change = float(np.abs(mass / mass[0] - 1.0).max())
        findings.mass[precision] = max(findings.mass[precision], change)
        if not change <= MASS[precision]:
            yield f"the mass changes by {change:.3g} of it"
    if status == Status.OK:
        yield from _judge_profiles(case, run, precision, findings)


def _judge_profiles(case: Case, run: xr.Dataset, precision: Precision, findings: Findings) -> Iterable[str]:
    h, v, phi = (run[name].values for name in ("h", "v", "phi"))
    if not np.isfinite([h, v, phi]).all():
        yield "a profile is not finite"
        return
    excess = float(phi.max()) / max(case.column.phi, case.rheology.phi_stat) - 1.0
    findings.excess[precision] = max(findings.excess[precision], excess)
    findings.least_phi = min(findings.least_phi, float(phi.min()))
    if h.min() < 0.0:
        yield f"h falls to {h.min():.3g} m"
    most = _most_excess(case, precision)
    if phi.min() <= 0.0 or phi.max() >= 1.0 or excess > most:
        yield f"phi goes from {phi.min():.3g} to {phi.max():.6g}"


def _most_excess(case: Case, precision: Precision) -> float:
    if case.scheme.order == 2:
        return ROUNDING[precision] / min(1.0, case.scheme.alpha - 1.0)
    return EXCESS if abs(case.slope.angle) <= STEEP and case.scheme.xi[0] >= 1.0 else np.inf


def search(order: int, count: int, seed: int, batch: int = 512) -> Findings:
    """Examine `count` runs of each scale and precision, in batches."""
    findings = Findings()
    for scale in SCALES:
        drawn = points(scale, count, seed)
        for precision in PRECISIONS:
            for first in range(0, count, batch):
                cases = [case_at(point, scale, order, precision) for point in drawn[first : first + batch]]
                examine(cases, precision, findings)
    return findings


def run_files(findings: Findings) -> dict[str, str]:
    """A run file for each fault, which reproduces it, by file name."""
    return {
        f"fault_{n:03}_{precision}.toml": f"# {what}\n# warpgran run THIS --precision {precision}\n{case.to_toml()}"
        for n, (what, case, precision) in enumerate(findings.faults)
    }


def deep(options: CheckOptions, count: int = 2048, seed: int = 2026) -> CheckResult:
    """The properties over 2 x 5 x `count` runs, minutes of computing."""
    found = search(options.order, count, seed)
    text = (
        f"{found.runs} runs, {found.cell_steps / 1e9:.2f} 10^9 cell-steps, at Sobol points of a space of {len(AXES)} "
        f"directions: every parameter of the model and the scheme, columns of 1 mm to 100 m on slopes of -80 to 80 "
        f"degrees, grids of 10 to 300 cells, each in both precisions. {found.unfinished} of them ran out of steps.",
        "Of each is asked that it ends soundly with finite values, h >= 0 and 0 < phi < 1; that mass between closed "
        f"ends changes by rounding alone; that nothing is faster than {SPEED:g} times what a dam-break wave and a "
        f"frictionless slope make, 2 sqrt(g_c h_0) + g sin|theta| t; and, of every {COMPANY}th, that it has the same "
        "bits in other company. The speed is no theorem: where grains dilate, their pressure drives them on. Nor is it "
        f"one that phi stays below its initial maximum; up to {STEEP:g} degrees and with xi >= 1, {EXCESS:.0%} more is "
        "allowed. Under order 2 it is, to rounding, in any run.",
    )
    rows = [
        Row("runs of which something does not hold", len(found.faults), "runs", "0", not found.faults),
        Row(
            "largest |v| over 2 sqrt(g_c h_0) + g sin|theta| t", found.speed, "-", f"<= {SPEED:g}", found.speed <= SPEED
        ),
        Row("smallest phi", found.least_phi, "-", "> 0", found.least_phi > 0.0),
    ]
    for precision in PRECISIONS:
        judged = options.order == 2 and precision == "float64"  # float32: run by run, by its alpha
        most = f"<= {ROUNDING[precision]:g}" if judged else "reported"
        held = found.excess[precision] <= ROUNDING[precision] if judged else None
        compared = f"largest phi over max(phi_0, phi_stat), less 1, {precision}"
        rows.append(Row(compared, found.excess[precision], "-", most, held))
        change, bound = found.mass[precision], MASS[precision]
        rows.append(
            Row(f"change of mass between closed ends, {precision}", change, "-", f"<= {bound:g}", change <= bound)
        )
    return CheckResult("Any run that is accepted", text, tuple(rows), run_files=run_files(found))
