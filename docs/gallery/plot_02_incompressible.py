"""
What dilatancy does
===================

K = 0 switches it off: friction is mu(I) alone, and phi is only carried along.
"""

import matplotlib.pyplot as plt

import warpgran as wg

base = wg.Case().with_(**{"slope.angle": 16.0, "grid.right": 1.4, "grid.cells": 800, "time.end": 1.2})
data = wg.simulate(base.sweep({"rheology.K": [0.0, 4.09, 8.0]}))
fig, (front, volume) = plt.subplots(1, 2, figsize=(7, 2.8), layout="constrained")
for r in range(data.sizes["run"]):
    run = data.isel(run=r)
    label = f"K = {float(run['rheology.K']):g}"
    front.plot(run.series_time, run.front, label=label)
    volume.plot(run.series_time, 100 * run.volume_change, label=label)
front.set(xlabel="t (s)", ylabel="front (m)")
volume.set(xlabel="t (s)", ylabel="change of volume (%)")
front.legend()
plt.show()
