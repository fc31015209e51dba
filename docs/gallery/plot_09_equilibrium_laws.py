"""
Three laws of the critical volume fraction
==========================================

f0, f1 and f2 stay in bounds where the linear law does not; the flow hardly knows the difference.
"""

import matplotlib.pyplot as plt

import warpgran as wg

base = wg.Case().with_(**{"slope.angle": 22.0, "grid.right": 1.4, "grid.cells": 600, "time.end": 1.0})
fig, ax = plt.subplots(figsize=(6.5, 3), layout="constrained")
for law in ("f0", "f1", "f2"):
    run = wg.simulate(base.with_(**{"rheology.phi_eq": law})).isel(run=0)
    ax.plot(run.x, run.phi.isel(time=2).where(run.h.isel(time=2) > 1e-3), label=law)
ax.set(xlabel="x (m)", ylabel="phi (-)", title=f"t = {float(run.time[2]):g} s")
ax.legend()
plt.show()
