"""
What dilatancy does
===================

K = 0 switches it off: friction is mu(I) alone, and phi is only carried along.
"""

import matplotlib.pyplot as plt

import warpgran as wg

base = wg.Case(
    slope={"angle": 16.0}, grid={"right": 1.4, "cells": 800}, time={"end": 1.2}
)
data = wg.simulate(base.sweep({"rheology.K": [0.0, 4.09, 8.0]}))
fig, (front, volume) = plt.subplots(1, 2, figsize=(7.5, 3), layout="constrained")
for r in range(data.sizes["run"]):
    run = data.isel(run=r)
    label = f"K = {float(run['rheology.K']):g}"
    front.plot(run.series_time, run.front, label=label)
    volume.plot(run.series_time, 100 * run.volume_change, label=label)
front.set(xlabel="time $t$ (s)", ylabel=r"front position $x_\mathrm{f}$ (m)")
volume.set(xlabel="time $t$ (s)", ylabel=r"volume change $\Delta V/V_0$ (%)")
front.legend()
plt.show()
