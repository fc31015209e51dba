"""
An animation
============

The collapse as it moves, with matplotlib; ``warpgran animate`` makes one of a result file.
"""

import matplotlib.pyplot as plt
from matplotlib.animation import FuncAnimation

import warpgran as wg

case = wg.Case(
    slope={"angle": 22.0}, grid={"right": 1.2, "cells": 500}, time={"end": 1.6, "snapshots": {"every": 0.05}}
)
run = wg.simulate(case).isel(run=0)
fig, ax = plt.subplots(figsize=(6.5, 2.8), layout="constrained")
(surface,) = ax.plot(run.x, 100 * run.h[0])
clock = ax.text(0.98, 0.9, "", transform=ax.transAxes, ha="right")
ax.set(xlabel="position along the slope $x$ (m)", ylabel="thickness $h$ (cm)", ylim=(0, 15))


def show(at: int) -> None:
    """Draw one snapshot."""
    surface.set_ydata(100 * run.h[at])
    clock.set_text(f"t = {float(run.time[at]):.2f} s")


movie = FuncAnimation(fig, show, frames=run.sizes["time"], interval=80)
plt.show()
