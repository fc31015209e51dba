"""
Dense and loose
===============

The same column at two packings, on four slopes: deposits.
"""

import matplotlib.pyplot as plt

import warpgran as wg

base = wg.Case().with_(**{"grid.right": 1.8, "grid.cells": 800, "time.end": 3.0, "time.snapshots": [3.0]})
data = wg.simulate(base.sweep({"slope.angle": [0.0, 10.0, 16.0, 22.0], "column.phi": [0.55, 0.62]}))
fig, axes = plt.subplots(4, sharex=True, figsize=(6.5, 6))
for ax, (angle, runs) in zip(axes, data.groupby("slope.angle"), strict=True):
    for r, line in zip(range(runs.sizes["run"]), "-:", strict=True):
        run = runs.isel(run=r, time=-1)
        ax.plot(run.x, 100 * run.h, line, color="C0", label=f"phi = {float(run['column.phi'])}")
    ax.set_ylabel("h (cm)")
    ax.text(0.98, 0.8, f"{angle:g} degrees", transform=ax.transAxes, ha="right")
axes[0].legend(loc="center right")
axes[-1].set_xlabel("x (m)")
plt.show()
