"""
Parameters from an experiment
=============================

Friction and dilation coefficient of a material, from what was measured of its collapses. ``warpgran calibrate FILE
--data FOLDER`` does this for a run file with a section ``[calibration]``; here the same from Python.

The measurements are columns of numbers in CSV files. These are *made*: runs with mu1 = 0.46 and K = 4 on 10 and 22
degrees, and 5 % of noise. So the answer is known, as it is not of an experiment.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd

import warpgran as wg

folder = Path("../../runs/calibrate_two_slopes")
front = pd.read_csv(folder / "front.csv", comment="#")
front.groupby("angle").head(2)

# %%
# What is fitted, and where it may lie before anything is measured: the priors. Everything else is taken as known.
case = wg.Case.from_toml("../../runs/calibrate_two_slopes.toml").with_(
    rheology={"phi_stat": 0.585}, grid={"cells": 230}
)
priors = {
    "rheology.mu1": {"low": 0.3, "high": 0.6},
    "rheology.K": {"low": 0.0, "high": 8.0},
}

# %%
# A screening of the priors, least squares from its best points, and the posterior: what can be said of the parameters
# after the measurements. It takes some thousand runs, each of some milliseconds. They are kept in a folder, so that an
# interrupted calibration goes on from there. The table: 5 and 95 % of the prior; the best fit and its standard
# deviation; mean, standard deviation and quantiles of the posterior. ``r_hat`` near 1 and a hundred ``effective`` draws
# or more say that the sampler has converged.
kept = tempfile.TemporaryDirectory()
sizes = {"screening": 64, "starts": 1, "chains": 2, "particles": 24}
found = wg.calibrate(case, priors, folder, output=kept.name, stage="posterior", **sizes)
found.table().T

# %%
# What these numbers must not be read without:
print(*found.told(), sep="\n")

# %%
# The draws from the posterior. Two slopes fix the friction to some percent and K to about a quarter, as the lines above
# have it.
draws = found.stages.posterior.samples.theta.reshape(-1, 2)
fig, ax = plt.subplots(layout="constrained")
ax.plot(*draws.T, ".", markersize=3, label="posterior")
ax.plot(0.46, 4.0, "k+", markersize=14, label="made with")
ax.set(xlabel=r"friction at rest $\mu_1$ (-)", ylabel="dilation coefficient $K$ (-)")
ax.legend()
plt.show()

# %%
# The best fit beside the measured fronts. They end while the mass on 22 degrees still moves, as the warning says.
best = case.with_(**found.table()["fit"])
angles = sorted(front["angle"].unique())
data = wg.simulate(best.sweep({"slope.angle": angles}))
fig, ax = plt.subplots(figsize=(6.5, 3), layout="constrained")
for r, angle in enumerate(angles):
    measured = front[front["angle"] == angle]
    t, x, sigma = (measured[name] for name in ("t", "x", "sigma"))
    ax.errorbar(t, x, sigma, fmt="o", markersize=4, color=f"C{r}")
    ax.plot(data.series_time, data.front[r], color=f"C{r}", label=f"{angle:g}°")
ax.set(xlabel="time $t$ (s)", ylabel=r"front position $x_\mathrm{f}$ (m)")
ax.legend(title="slope")
plt.show()
kept.cleanup()

# %%
# What to ask of data, how the error of the model is treated, and what the numbers do not say: :doc:`/calibration`.
