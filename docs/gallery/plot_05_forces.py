"""
The balance of forces
=====================

The terms of the momentum equation, as in Fig. 15 of the paper: ``wg.forces``.
"""

import matplotlib.pyplot as plt

import warpgran as wg

case = wg.Case().with_(
    **{"slope.angle": 22.0, "grid.right": 1.4, "grid.cells": 800, "time.end": 1.0, "time.snapshots": {"every": 0.01}}
)
data = wg.simulate(case)
terms = wg.forces(data).isel(run=0).sel(time=0.48, method="nearest")
fig, ax = plt.subplots(figsize=(6.5, 3), layout="constrained")
for name in terms.data_vars:
    ax.plot(terms.x, terms[name], label=terms[name].attrs.get("long_name", name))
ax.set(xlabel="x (m)", ylabel="force per unit area over rho_s (m2 s-2)", xlim=(-0.2, 0.75))
ax.legend(fontsize="small")
plt.show()
