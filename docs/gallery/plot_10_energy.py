"""
Where the energy goes
=====================

Per unit width and grain density (2.7), against the first: a collapse on the flat and on slopes.
"""

import matplotlib.pyplot as plt

import warpgran as wg

base = wg.Case().with_(**{"grid.right": 1.6, "grid.cells": 600, "time.end": 1.6})
data = wg.simulate(base.sweep({"slope.angle": [0.0, 10.0, 16.0, 22.0]}))
fig, ax = plt.subplots(figsize=(6.5, 3), layout="constrained")
for r in range(data.sizes["run"]):
    run = data.isel(run=r)
    lost = run.energy.isel(series_time=0) - run.energy
    ax.plot(run.series_time, lost, label=f"{float(run['slope.angle']):g} degrees")
ax.set(xlabel="t (s)", ylabel="energy lost (m4 s-2)")
ax.legend()
plt.show()
