"""
Three laws of the critical volume fraction
==========================================

f0, f1 and f2 (:doc:`/run_file`) stay positive where a linear law does not. They differ at the thin front alone.
"""

import matplotlib.pyplot as plt

import warpgran as wg

base = wg.Case(
    slope={"angle": 22.0},
    grid={"right": 1.4, "cells": 600},
    time={"end": 0.5, "snapshots": [0.48]},
)
data = wg.simulate(base.sweep({"rheology.phi_eq": ["f0", "f1", "f2"]}))
fig, axes = plt.subplots(2, sharex=True, figsize=(6.5, 4.5), layout="constrained")
for r in range(data.sizes["run"]):
    run = data.isel(run=r, time=0)
    law = str(run["rheology.phi_eq"].values)
    axes[0].plot(run.x, 100 * run.phi / 0.582 * run.h, label=law)
    axes[1].plot(run.x, run.phi.where(run.h > 1e-3))
axes[0].set(
    ylabel="compacted thickness\n" r"$\varphi h/\varphi_\mathrm{stat}$ (cm)",
    title="t = 0.48 s",
)
axes[1].set(
    xlabel="position along the slope $x$ (m)",
    ylabel=r"volume fraction $\varphi$ (-)",
    xlim=(-0.2, 0.9),
)
axes[0].legend()
plt.show()
