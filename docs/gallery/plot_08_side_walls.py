"""
Side walls of a channel
=======================

Friction of the walls grows with the thickness (4.1): narrow channels hold more.
"""

import matplotlib.pyplot as plt

import warpgran as wg

base = wg.Case(
    slope={"angle": 16.0},
    rheology={"mu_wall": 0.18},
    grid={"right": 1.2, "cells": 600},
    time={"end": 1.5},
)
data = wg.simulate(base.sweep({"rheology.channel_width": [0.05, 0.1, 0.2, 1.0]}))
fig, ax = plt.subplots(figsize=(6.5, 3.5), layout="constrained")
for r in range(data.sizes["run"]):
    run = data.isel(run=r, time=-1)
    width = float(run["rheology.channel_width"])
    ax.plot(run.x, 100 * run.h, label=f"{100 * width:g} cm")
ax.set(
    xlabel="position along the slope $x$ (m)",
    ylabel="thickness $h$ (cm)",
    title=f"t = {float(run.time):g} s",
)
ax.legend(title="channel width")
plt.show()
