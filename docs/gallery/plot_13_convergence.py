"""
How fine a grid
===============

The error of what one reports over the number of cells: ``wg.converge``, on five grids, by both schemes.
"""

import matplotlib.pyplot as plt

import warpgran as wg

case = wg.Case(
    slope={"angle": 10.0},
    grid={"right": 1.0, "cells": 240},
    time={"end": 1.2, "snapshots": [1.2]},
)
fig, ax = plt.subplots(figsize=(6.5, 3.5), layout="constrained")
for order, marker in ((1, "s--"), (2, "o-")):
    found = wg.converge(case.with_(scheme={"order": order}), levels=5)
    for n, quantity in enumerate(found.quantities[:2]):
        label = f"{quantity.name}, order {order}"
        ax.loglog(found.cells, 100 * quantity.errors, marker, color=f"C{n}", label=label)
ax.axhline(1.0, color="0.6", linewidth=0.8)
ax.set_xticks(found.cells, [str(cells) for cells in found.cells])
ax.minorticks_off()
ax.set_yticks([0.1, 1, 10], ["0.1", "1", "10"])
ax.set(xlabel="cells", ylabel="error (%)")
ax.legend(fontsize="small")
plt.show()
