"""Do the intervals of `warpgran calibrate` contain the truth as often as they say?

    python benchmarks/intervals.py [--experiments 50] [--noise 0.05] [--sigma | --no-sigma] [--cells 80]

Draws truths from the prior, makes measurements on two slopes of a coarse grid with noise, calibrates each, and prints
the ranks of the truths among the draws of the posteriors: uniform if the posteriors are right (Talts et al. 2018,
Validating Bayesian inference algorithms with simulation-based calibration). Some ten seconds an experiment on 2 cores.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

import numpy as np

import warpgran as wg

ANGLES = (10.0, 22.0)
PRIORS = {
    "rheology.mu1": {"low": 0.3, "high": 0.6},
    "rheology.K": {"low": 1.0, "high": 8.0},
    "rheology.phi_stat": {"low": 0.54, "high": 0.61},
}
SNAPSHOTS = [0.15, 0.35, 0.7]
SAMPLES = [round(0.1 * k, 1) for k in range(1, 10)]
BINS = 10


def base_case(cells: int) -> wg.Case:
    """A column on a coarse grid."""
    grid = {"left": -0.2, "right": 1.4, "cells": cells}
    return wg.Case.from_dict({"grid": grid, "time": {"end": 0.9, "snapshots": SNAPSHOTS, "series": SAMPLES}})


def measure(
    case: wg.Case, truth: dict[str, float], noise: float, sigma: bool, in_proportion: bool, folder: Path, seed: int
) -> None:
    """Write measurements of runs with the true parameters, on every slope.

    Args:
        case: What the slopes share.
        truth: Parameters by dotted key.
        noise: Its size over the greatest value of its kind, or in proportion over each value.
        sigma: Whether the files say how large it is.
        in_proportion: Whether it is in proportion to each value.
        folder: Where the files are written.
        seed: Of the noise.
    """
    rng = np.random.default_rng(seed)
    data = wg.simulate([case.with_(**{"slope.angle": angle}, **truth) for angle in ANGLES])
    x = np.linspace(-0.18, 1.0, 30)
    h = np.array([[np.interp(x, data["x"].values, at) for at in run] for run in data["h"].values])
    rows: dict[str, list[tuple[float, ...]]] = {"profiles": [], "front": [], "volume": []}
    for a, angle in enumerate(ANGLES):
        rows["profiles"] += [(angle, t, x[i], h[a, k, i]) for k, t in enumerate(SNAPSHOTS) for i in range(x.size)]
        rows["front"] += [(angle, t, data["front"].values[a, k]) for k, t in enumerate(SAMPLES)]
        rows["volume"] += [(angle, t, data["volume_change"].values[a, k]) for k, t in enumerate(SAMPLES)]
    headings = {"profiles": "angle,t,x,h", "front": "angle,t,x", "volume": "angle,t,change"}
    folder.mkdir(parents=True)
    for name, table in rows.items():
        values = np.array([row[-1] for row in table])
        size = noise * (
            abs(values) + 1e-3 * abs(values).max() if in_proportion else np.full(values.size, abs(values).max())
        )
        values = values + size * rng.standard_normal(values.size)
        values = values if sigma or name != "profiles" else np.maximum(values, 0.0)
        lines = [headings[name] + (",sigma" if sigma else "")]
        for row, value, s in zip(table, values, size, strict=True):
            lines.append(",".join(f"{v:.6g}" for v in (*row[:-1], value, *((s,) if sigma else ()))))
        (folder / f"{name}.csv").write_text("\n".join(lines) + "\n")


def main() -> None:
    """Calibrate every experiment, and print the ranks."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--experiments", type=int, default=50)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--noise", type=float, default=0.05)
    parser.add_argument("--sigma", action=argparse.BooleanOptionalAction, default=True)
    parser.add_argument("--in-proportion", action="store_true")
    parser.add_argument("--cells", type=int, default=80)
    asked = parser.parse_args()
    case = base_case(asked.cells)
    ranks, scores, unconverged = [], [], 0
    for number in range(asked.first, asked.first + asked.experiments):
        rng = np.random.default_rng([7, number])
        truth = {key: float(rng.uniform(prior["low"], prior["high"])) for key, prior in PRIORS.items()}
        with tempfile.TemporaryDirectory() as folder:
            data = Path(folder) / "data"
            measure(case, truth, asked.noise, asked.sigma, asked.in_proportion, data, number)
            found = wg.calibrate(case, PRIORS, data, output=Path(folder) / "out", stage="posterior", seed=number)
        draws = found.stages.posterior.samples.theta.reshape(-1, len(truth))
        true = np.array(list(truth.values()))
        ranks.append((draws < true).mean(axis=0))
        values, vectors = np.linalg.eigh(np.cov(draws.T / found.stages.fit.units[:, None]))
        scores.append(((draws.mean(axis=0) - true) / found.stages.fit.units @ vectors) / np.sqrt(values))
        unconverged += not found.converged
        print(number, np.round(ranks[-1], 3), np.round(scores[-1], 2), f"{found.seconds:.1f} s", flush=True)
    report(np.array(ranks), np.array(scores), unconverged)


def report(ranks: np.ndarray, scores: np.ndarray, unconverged: int) -> None:
    """Print the histogram of the ranks, the coverage and the scores of the combinations."""
    from scipy.stats import kstest

    for key, column in zip(PRIORS, ranks.T, strict=True):
        counts = np.histogram(column, BINS, (0.0, 1.0))[0]
        inside = {p: float((abs(column - 0.5) < p / 2).mean()) for p in (0.5, 0.9)}
        uniform = kstest(column, "uniform").pvalue
        print(
            f"{key:20} ranks {counts.tolist()}, 50 %: {inside[0.5]:.0%}, 90 %: {inside[0.9]:.0%}, KS p = {uniform:.2f}"
        )
    within = (abs(scores) < 2.0).mean(axis=0)
    print(f"combinations, the best determined first: within two standard deviations {np.round(within, 2).tolist()}")
    print(f"{unconverged} of {len(ranks)} have not converged")


if __name__ == "__main__":
    main()
