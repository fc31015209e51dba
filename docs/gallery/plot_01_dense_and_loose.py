"""
Dense and loose
===============

The same column at two packings, on four slopes: the deposits differ near the wall, where the mass hardly moved.
"""

import matplotlib.pyplot as plt

import warpgran as wg

base = wg.Case(grid={"right": 1.4, "cells": 640}, time={"end": 4.0, "snapshots": [4.0]})
data = wg.simulate(
    base.sweep({"slope.angle": [0.0, 10.0, 16.0, 22.0], "column.phi": [0.62, 0.55]})
)
fig, axes = plt.subplots(4, sharex=True, figsize=(6.5, 6.5), layout="constrained")
for ax, (angle, runs) in zip(axes, data.groupby("slope.angle"), strict=True):
    for r, line in zip(range(runs.sizes["run"]), ("-", "--"), strict=True):
        run = runs.isel(run=r, time=-1)
        label = rf"$\varphi_0$ = {float(run['column.phi'])}"
        ax.plot(run.x, 100 * run.h, line, color=f"C{r}", label=label)
    ax.set_ylabel("thickness $h$ (cm)")
    ax.text(0.98, 0.8, f"{angle:g}°", transform=ax.transAxes, ha="right")
axes[0].legend(loc="center right")
axes[-1].set_xlabel("position along the slope $x$ (m)")
plt.show()
