"""
A collapse in space and time
============================

Thickness and volume fraction over x and t, from many snapshots.
"""

import matplotlib.pyplot as plt

import warpgran as wg

case = wg.Case(
    slope={"angle": 22.0},
    grid={"right": 1.4, "cells": 800},
    time={"end": 1.6, "snapshots": {"every": 0.01}},
)
run = wg.simulate(case).isel(run=0)
fig, axes = plt.subplots(1, 2, figsize=(7.5, 3), layout="constrained", sharey=True)
thick = run.h > 1e-3
bar = {"label": "thickness $h$ (cm)"}
(100 * run.h).where(thick).plot(ax=axes[0], x="x", cbar_kwargs=bar, cmap="viridis")
bar = {"label": r"volume fraction $\varphi$ (-)"}
run.phi.where(thick).plot(ax=axes[1], x="x", cbar_kwargs=bar, cmap="cividis")
for ax in axes:
    ax.set(xlabel="position along the slope $x$ (m)", title="")
axes[0].set_ylabel("time $t$ (s)")
axes[1].set_ylabel("")
plt.show()
