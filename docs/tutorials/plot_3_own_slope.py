"""
A slope of one's own
====================

A bed that is no plane: from 22 degrees onto a gentle run-out, at the scale of a small landslide. What the frame of the
model means, and which warnings to heed.
"""

import warnings

import matplotlib.pyplot as plt
import numpy as np

import warpgran as wg

# %%
# The terrain, as a map has it: elevation Z over horizontal distance X.
X = np.linspace(-30.0, 120.0, 301)
slope = np.radians(15.0 - 7.0 * np.tanh((X - 45.0) / 15.0))  # from 22 to 8 degrees
drop = 0.5 * (np.tan(slope[1:]) + np.tan(slope[:-1])) * np.diff(X)
Z = -np.concatenate(([0.0], np.cumsum(drop)))

# %%
# The model lives on a plane: ``x`` runs down it, ``h`` is normal to it, and the bed ``b`` is what lies on it. It takes
# that bed as *mild*, so the plane should follow the slope on which the mass moves, not the horizontal. A plane of 15
# degrees halves the difference. The terrain in its frame is the same curve, turned:
angle = 15.0
s, c = np.sin(np.radians(angle)), np.cos(np.radians(angle))
x, b = X * c - Z * s, X * s + Z * c

# %%
# Lengths are metres, so a landslide is the same file with other numbers: grains of 5 cm, 4 m of debris over 20 m.
case = wg.Case(title="A bend in the slope").with_(
    slope={"angle": angle, "bed": {"x": x, "b": b}},
    rheology={"grain_diameter": 0.05},
    column={"height": 4.0, "length": 20.0, "start": 5.0},
    grid={"left": -20.0, "right": 100.0, "cells": 600},
    time={"end": 25.0, "snapshots": [0.0, 1.0, 2.0, 4.0, 25.0]},
    scheme={"left": "open"},
)
case

# %%
# The series, the speed that counts as rest and the thickness that counts as the front scale with the case by default.
data = wg.simulate(case)
figure = wg.plot(data)

# %%
# Did it stop, and did anything leave the grid? The columns ``stop_time``, ``left_grid`` and ``moving`` say so.
wg.summary(data)

# %%
# The deposit as a geologist would draw it, turned back into the frame of the map.
run = data.isel(run=0)
fig, ax = plt.subplots(figsize=(7, 3.2), layout="constrained")
ax.fill_between(X, Z, -40.0, color="0.8")
for at in (0, 2, 4):
    now = run.isel(time=at)
    top = (now.bed + now.h).where(now.h > 0.0)
    ax.plot(now.x * c + top * s, -now.x * s + top * c, label=f"t = {float(now.time):g} s")
ax.set(
    xlabel="horizontal distance (m)",
    ylabel="elevation (m)",
    aspect="equal",
    xlim=(-10, 80),
    ylim=(-35, 0),
)
ax.legend()
plt.show()

# %%
# **When the frame is wrong.** The same terrain given as a bed on a horizontal plane: 22 degrees are not mild, and
# gravity is not split by them. warpgran computes it, and warns. Here the way hardly changes and the time does;
# :doc:`/run_file` has an example in which the way is a third too long.
with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    flat = wg.simulate(case.with_(slope={"angle": 0.0, "bed": {"x": X, "b": Z}}))
for warning in caught:
    print(warning.message)
for words, result, horizontal in (("this", data, c), ("wrong", flat, 1.0)):
    way, time = horizontal * float(result.run_out[0]), float(result.stop_time[0])
    print(f"{words} frame: {way:.1f} m on the map, at rest after {time:.1f} s")
