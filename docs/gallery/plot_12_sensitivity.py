"""
Which parameters matter, and when
=================================

Total Sobol indices of the front over time: ``wg.sensitivity``, 768 runs.
"""

import matplotlib.pyplot as plt

import warpgran as wg

case = wg.Case(
    grid={"right": 1.4, "cells": 400},
    time={"end": 1.0, "snapshots": [], "series": {"every": 0.02}},
)
over = {
    "rheology.mu1": {"low": 0.40, "high": 0.55},
    "slope.angle": {"low": 5.0, "high": 15.0},
    "column.height": {"mean": 0.14, "sd": 0.01, "low": 0.10, "high": 0.18},
    "rheology.K": {"low": 0.0, "high": 8.0},
}
found = wg.sensitivity(case, over, of=["front"], samples=128)
fig, ax = plt.subplots(figsize=(6.5, 3.5), layout="constrained")
for p, key in enumerate(over):
    one = found.isel(parameter=p).squeeze()
    ax.plot(one.series_time, one.total_order_over_time, label=key)
ax.set(xlabel="time $t$ (s)", ylabel="share of the variance of the front (-)")
ax.set_ylim(0, None)
ax.legend()
plt.show()
