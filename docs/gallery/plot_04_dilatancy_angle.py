"""
Dilatancy angle and friction along the flow
===========================================

``wg.derive`` computes what follows from h, v and phi.
"""

import matplotlib.pyplot as plt

import warpgran as wg

case = wg.Case().with_(
    **{"slope.angle": 16.0, "grid.right": 1.2, "grid.cells": 800, "time.end": 1.0, "time.snapshots": [0.1, 0.3, 0.6]}
)
data = wg.simulate(case)
run = data.assign(wg.derive(data, "psi", "mu", "I")).isel(run=0)
fig, axes = plt.subplots(3, sharex=True, figsize=(6.5, 5), layout="constrained")
for ax, name, label in zip(axes, ("psi", "mu", "I"), ("psi (degrees)", "mu (-)", "I (-)"), strict=True):
    for at in range(run.sizes["time"]):
        now = run.isel(time=at).where(run.h.isel(time=at) > 2e-3)
        ax.plot(now.x, now[name], label=f"{float(now.time):g} s")
    ax.set_ylabel(label)
axes[2].set_yscale("log")
axes[0].legend()
axes[2].set_xlabel("x (m)")
plt.show()
