"""
Where the energy goes
=====================

Friction takes it. The loss since the start of the kinetic and potential energy (2.7), per unit width and grain density.
"""

import matplotlib.pyplot as plt

import warpgran as wg

base = wg.Case(grid={"right": 1.6, "cells": 600}, time={"end": 1.6})
data = wg.simulate(base.sweep({"slope.angle": [0.0, 10.0, 16.0, 22.0]}))
fig, ax = plt.subplots(figsize=(6.5, 3.5), layout="constrained")
for r in range(data.sizes["run"]):
    run = data.isel(run=r)
    lost = run.energy.isel(series_time=0) - run.energy
    ax.plot(run.series_time, lost, label=f"{float(run['slope.angle']):g}°")
ax.set(xlabel="time $t$ (s)", ylabel=r"energy lost (m$^4$ s$^{-2}$)")
ax.legend(title="slope")
plt.show()
