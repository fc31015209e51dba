"""
Two schemes, one column
=======================

The paper's scheme of first order, and that of second order, on the same coarse cells and on fine ones.
"""

import matplotlib.pyplot as plt

import warpgran as wg

base = wg.Case().with_(**{"rheology.K": 0.0, "grid.right": 0.4, "time.end": 0.6, "time.snapshots": [0.6]})
fig, ax = plt.subplots(figsize=(6.5, 3), layout="constrained")
for order, colour in ((1, "C1"), (2, "C0")):
    for cells, line in ((150, ":"), (1200, "-")):
        run = wg.simulate(base.with_(**{"scheme.order": order, "grid.cells": cells})).isel(run=0, time=-1)
        ax.plot(run.x, 100 * run.h, line, color=colour, label=f"order {order}, {cells} cells")
ax.set(xlabel="x (m)", ylabel="h (cm)")
ax.legend()
plt.show()
