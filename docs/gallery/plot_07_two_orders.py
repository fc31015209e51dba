"""
Two schemes, one column
=======================

The front at rest, by the paper's scheme of first order and by that of second order, on coarse cells of 4 mm and on
fine ones of 0.5 mm.
"""

import matplotlib.pyplot as plt

import warpgran as wg

base = wg.Case(
    rheology={"K": 0.0}, grid={"right": 0.4}, time={"end": 0.6, "snapshots": [0.6]}
)
fig, ax = plt.subplots(figsize=(6.5, 3.5), layout="constrained")
for order, colour in ((1, "C1"), (2, "C0")):
    for cells, line in ((150, ":"), (1200, "-")):
        case = base.with_(scheme={"order": order}, grid={"cells": cells})
        run = wg.simulate(case).isel(run=0, time=-1)
        label = f"order {order}, {600 / cells:g} mm"
        ax.plot(run.x, 100 * run.h, line, color=colour, label=label)
ax.set(xlabel="position along the slope $x$ (m)", ylabel="thickness $h$ (cm)")
ax.set(xlim=(0.18, 0.38), ylim=(0.0, 2.5))
ax.legend()
plt.show()
