"""
A collapse in space and time
============================

Thickness and volume fraction over x and t, from many snapshots.
"""

import matplotlib.pyplot as plt

import warpgran as wg

case = wg.Case().with_(
    **{"slope.angle": 22.0, "grid.right": 1.4, "grid.cells": 800, "time.end": 1.6, "time.snapshots": {"every": 0.01}}
)
run = wg.simulate(case).isel(run=0)
fig, axes = plt.subplots(1, 2, figsize=(7, 3), layout="constrained", sharey=True)
thick = run.h > 1e-3
run.h.where(thick).plot(ax=axes[0], x="x", cbar_kwargs={"label": "h (m)"}, cmap="viridis")
run.phi.where(thick).plot(ax=axes[1], x="x", cbar_kwargs={"label": "phi (-)"}, cmap="cividis")
for ax in axes:
    ax.set(xlabel="x (m)", ylabel="t (s)", title="")
plt.show()
