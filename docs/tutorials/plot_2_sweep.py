"""
A sweep, and which parameter matters
====================================

One run answers one question. A batch answers which of them is worth asking: here 128 collapses over friction, dilation,
packing and slope, as one call.

On the command line a sweep is a section of the run file::

    [sweep]
    mode = "sobol"
    samples = 128

    [sweep.over]
    "rheology.mu1" = { low = 0.40, high = 0.55 }
    "rheology.K" = { low = 0.0, high = 8.0 }
    "column.phi" = { low = 0.55, high = 0.62 }
    "slope.angle" = { low = 0.0, high = 22.0 }
"""

from pathlib import Path

import matplotlib.pyplot as plt

import warpgran as wg

RUNS = Path.cwd().parents[1] / "runs"

# %%
# Coarse cells will do: with the scheme of second order 4 mm are within a percent or two (:doc:`how to know
# <plot_5_grid>`).
base = wg.Case.from_toml(RUNS / "dense_22deg.toml").with_(**{"grid.cells": 450})
study = base.sweep(
    {
        "rheology.mu1": {"low": 0.40, "high": 0.55},
        "rheology.K": {"low": 0.0, "high": 8.0},
        "column.phi": {"low": 0.55, "high": 0.62},
        "slope.angle": {"low": 0.0, "high": 22.0},
    },
    mode="sobol",
    samples=128,
)
data = wg.simulate(study)
table = wg.summary(data)
table.head()

# %%
# The picture of a batch: the front of every run, and the run-out against each key.
figure = wg.plot(data)

# %%
# How strongly is the run-out tied to each parameter? A rank correlation is a first look.
keys = list(study.keys)
correlation = table[[*keys, "run_out"]].corr(method="spearman")["run_out"].drop("run_out")
correlation.sort_values(key=abs, ascending=False)

# %%
# A correlation says nothing of what parameters do together; :doc:`/sensitivity` does.
fig, ax = plt.subplots()
points = ax.scatter(table["slope.angle"], table["run_out"], c=table["rheology.mu1"], cmap="viridis")
fig.colorbar(points, label="mu1 (-)")
ax.set(xlabel="slope (degrees)", ylabel="run-out (m)")
plt.show()
