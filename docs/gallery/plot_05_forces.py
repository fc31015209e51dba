"""
The balance of forces
=====================

The terms of the momentum equation, as in Fig. 15 of the paper: ``wg.forces``.
"""

import matplotlib.pyplot as plt

import warpgran as wg

case = wg.Case(
    slope={"angle": 22.0},
    grid={"right": 1.4, "cells": 800},
    time={"end": 1.0, "snapshots": {"every": 0.01}},
)
data = wg.simulate(case)
terms = wg.forces(data).isel(run=0).sel(time=0.48, method="nearest")
fig, ax = plt.subplots(figsize=(6.5, 3.5), layout="constrained")
for name in terms.data_vars:
    ax.plot(terms.x, terms[name], label=terms[name].attrs["long_name"])
ax.set(
    xlabel="position along the slope $x$ (m)",
    ylabel=r"force per area over $\rho_s$ (m$^2$ s$^{-2}$)",
    title="t = 0.48 s",
    xlim=(-0.2, 0.72),
)
ax.legend(fontsize="small")
plt.show()
