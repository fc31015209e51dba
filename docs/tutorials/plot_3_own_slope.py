"""
A slope of one's own
====================

A bed that is no plane: from 25 degrees onto a gentle run-out, at the scale of a small landslide. What the frame of the
model means, and which warnings to heed.
"""

import warnings

import matplotlib.pyplot as plt
import numpy as np

import warpgran as wg

# %%
# The model lives on a plane: ``h`` is normal to it, and the bed ``b`` is what lies on it. It takes that bed as
# *mild*. So the plane should follow the slope on which the mass moves, not the horizontal. Here the mass starts on 22
# degrees and comes to rest on 8: a plane of 15 degrees halves the difference.
angle, bend = 15.0, 50.0
x = np.linspace(0.0, 140.0, 281)
slope = np.radians(15.0 - 7.0 * np.tanh((x - bend) / 15.0))  # from 22 to 8 degrees
elevation = -np.concatenate(([0.0], np.cumsum(np.tan(0.5 * (slope[1:] + slope[:-1])) * np.diff(x))))
bed = elevation + x * np.tan(np.radians(angle))

# %%
# Lengths are metres, so a landslide is the same file with other numbers: grains of 5 cm, 4 m of debris over 20 m.
case = wg.Case(title="A bend in the slope").with_(
    **{
        "slope.angle": angle,
        "slope.bed": {"x": x, "b": bed - bed.min()},
        "rheology.grain_diameter": 0.05,
        "column.height": 4.0,
        "column.length": 20.0,
        "column.start": 5.0,
        "grid.left": 0.0,
        "grid.right": 140.0,
        "grid.cells": 700,
        "time.end": 25.0,
        "scheme.left": "open",
    }
)
case

# %%
# Times of output, the speed that counts as rest and the thickness that counts as the front scale with the case by
# default.
data = wg.simulate(case)
figure = wg.plot(data)

# %%
# Did it stop, and did anything leave the grid? The table says so; the series ``outflow`` is the share of the solid
# that has left.
wg.summary(data)

# %%
# The deposit as a geologist would draw it: elevations, in a frame that is not inclined.
run = data.isel(run=0)
s, c = np.sin(np.radians(angle)), np.cos(np.radians(angle))
X, Z = run.x * c + run.bed * s, -run.x * s + run.bed * c
fig, ax = plt.subplots(figsize=(7, 3.2))
ax.fill_between(X, Z, float(Z.min()) - 2.0, color="0.8")
for at in (0, 2, -1):
    top = run.isel(time=at)
    ax.plot(X + top.h * s, Z + top.h * c, label=f"{float(top.time):.1f} s")
ax.set(xlabel="horizontal distance (m)", ylabel="elevation (m)", aspect="equal")
ax.legend()
plt.show()

# %%
# **When the frame is wrong.** The same slope given as a bed on a horizontal plane runs too far: 22 degrees are not
# mild. warpgran computes it, and warns.
with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    wg.simulate(case.with_(**{"slope.angle": 0.0, "slope.bed": {"x": x, "b": elevation - elevation.min()}}))
for warning in caught:
    print(warning.message)
