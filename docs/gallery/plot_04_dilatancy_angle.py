"""
Dilatancy angle and friction along the flow
===========================================

``wg.derive`` computes what follows from h, v and phi. Where the dilatancy angle is positive, the grains must
dilate to move.
"""

import matplotlib.pyplot as plt

import warpgran as wg

case = wg.Case(
    slope={"angle": 16.0},
    grid={"right": 1.2, "cells": 800},
    time={"end": 1.0, "snapshots": [0.1, 0.3, 0.6]},
)
data = wg.simulate(case)
run = data.assign(wg.derive(data, "psi", "mu", "I")).isel(run=0)
fig, axes = plt.subplots(3, sharex=True, figsize=(6.5, 5.5), layout="constrained")
labels = (r"dilatancy angle $\psi$ (°)", r"friction $\mu$ (-)", "inertial number $I$ (-)")
for ax, name, label in zip(axes, ("psi", "mu", "I"), labels, strict=True):
    for at in range(run.sizes["time"]):
        now = run.isel(time=at).where(run.h.isel(time=at) > 2e-3)
        ax.plot(now.x, now[name], label=f"t = {float(now.time):g} s")
    ax.set_ylabel(label)
axes[2].set(yscale="log", ylim=(1e-4, None), xlabel="position along the slope $x$ (m)")
axes[0].legend()
plt.show()
