"""
The first collapse
==================

A column of glass beads, 14 cm high and 20 cm long, is let go on a slope of 22 degrees. How far does it run?

On the command line this is all of it::

    pip install .
    warpgran run runs/dense_22deg.toml

which writes ``dense_22deg.h5``, a picture beside it, and prints a table. Here the same from Python.
"""

from pathlib import Path

import matplotlib.pyplot as plt

import warpgran as wg

RUNS = Path.cwd().parents[1] / "runs"

# %%
# A *case* is what a run file says. Everything that the file does not name has the paper's value; the case shows what
# differs from that.
case = wg.Case.from_toml(RUNS / "dense_22deg.toml")
case

# %%
# Computing it takes a tenth of a second, after some seconds of compiling the first time. What comes back is an
# ``xarray.Dataset``: profiles of the thickness ``h``, the velocity ``v`` and the solid volume fraction ``phi`` at
# some instants, and series such as the position of the front, sampled more often.
data = wg.simulate(case)
data

# %%
# The picture that the command line makes. At the top the mass is seen as it slides down and comes to rest; below it
# how fast it is, how densely packed, and its dilatancy angle: where that is positive the grains must dilate to move,
# and friction is greater by its tangent.
figure = wg.plot(data)

# %%
# The table that it prints, a row a run: how far the front ran, how high the deposit is, by how much it dilated, and
# when it stopped.
wg.summary(data)

# %%
# Packing matters: the same column, loose. ``with_`` gives a case that differs, and leaves the first as it was. Both
# are computed as one batch; the key in which they differ becomes a coordinate of the result.
both = wg.simulate([case, case.with_(**{"column.phi": 0.55})])
wg.summary(both)

# %%
# Everything of xarray works on it: the front against time, of both.
fig, ax = plt.subplots()
for r, words in enumerate(("dense, phi = 0.62", "loose, phi = 0.55")):
    both.front.isel(run=r).plot.line(x="series_time", ax=ax, label=words)
ax.legend()
ax.set_title("")
plt.show()

# %%
# Where to go from here: :doc:`a sweep over many parameters <plot_2_sweep>`, :doc:`a slope of your own
# <plot_3_own_slope>`, and :doc:`how fine a grid must be <plot_5_grid>`.
