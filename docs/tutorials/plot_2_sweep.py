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
    "slope.angle" = { low = 0.0, high = 18.0 }
"""

import matplotlib.pyplot as plt
import numpy as np

import warpgran as wg

# %%
# Coarse cells will do for that: 450 cells of 4 mm are within some percent (:doc:`how to know <plot_5_grid>`). Each
# run ends when its mass has stopped, for which four seconds are enough.
base = wg.Case.from_toml("../../runs/dense_22deg.toml").with_(
    title="128 columns",
    grid={"cells": 450},
    time={"end": 4.0, "snapshots": [], "stop_at_rest": True},
)
over = {
    "rheology.mu1": {"low": 0.40, "high": 0.55},
    "rheology.K": {"low": 0.0, "high": 8.0},
    "column.phi": {"low": 0.55, "high": 0.62},
    "slope.angle": {"low": 0.0, "high": 18.0},
}
data = wg.simulate(base.sweep(over, mode="sobol", samples=128))
table = wg.summary(data)
table[[*over, "run_out", "h_max", "dilation_max", "stop_time"]].head()

# %%
# The picture of a batch: results against each key, and the front of all runs.
figure = wg.plot(data)

# %%
# The slope decides how far the mass runs, and how steep it is decides how much friction matters:
fig, ax = plt.subplots(layout="constrained")
points = ax.scatter(
    table["slope.angle"], table["run_out"], c=table["rheology.mu1"], cmap="viridis"
)
fig.colorbar(points, label=r"friction at rest $\mu_1$ (-)")
ax.set(xlabel=r"slope angle $\theta$ (°)", ylabel="run-out (m)")
plt.show()

# %%
# How much of the variance of a result is due to each parameter? That takes a design of its own, which
# :func:`warpgran.sensitivity` makes and computes: 64 base samples, 384 runs. The first-order index is the share that a
# parameter has by itself, the total index what it has together with the others.
found = wg.sensitivity(base, over, of=["run_out", "dilation_max"], samples=64)
found.total_order.to_pandas().round(2)

# %%
# The lines are intervals of 95 %: with so few samples they are wide, and say so.
fig, axes = plt.subplots(1, 2, figsize=(7.5, 3), sharey=True, layout="constrained")
for ax, output in zip(axes, found.output, strict=True):
    one = found.sel(output=output)
    for shift, order in ((-0.2, "first_order"), (0.2, "total_order")):
        at = np.arange(one.sizes["parameter"]) + shift
        low, high = one[f"{order}_low"], one[f"{order}_high"]
        ax.barh(at, one[order], 0.35, label=order.replace("_", " "))
        ax.hlines(at, low, high, color="black", linewidth=1.0)
    ax.set(xlabel="share of the variance (-)", title=str(one.output_words.item()))
axes[0].set_yticks(range(one.sizes["parameter"]), one.parameter.values)
axes[0].invert_yaxis()
axes[0].legend()
plt.show()

# %%
# Packing makes a mass dilate, and hardly changes where it stops. What the indices say and what they do not, other
# distributions, indices over time, and screening of many parameters: :doc:`/sensitivity`.
