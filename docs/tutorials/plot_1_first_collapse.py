"""
The first collapse
==================

A column of glass beads, 14 cm high and 20 cm long, is let go on a slope of 22 degrees. How far does it run?

On the command line, in a copy of the repository, this is all of it::

    pip install .
    warpgran run runs/dense_22deg.toml

which writes ``dense_22deg.h5``, a picture beside it, and prints :doc:`a table </reference/printed_table>`; then
``warpgran view dense_22deg.h5 --open`` makes :doc:`a page to click in </viewer>`. Here the same from Python.
"""

import matplotlib.pyplot as plt

import warpgran as wg

# %%
# A *case* is what a run file says. Everything that the file does not name has the paper's value; the case shows what
# differs from that. (The path starts from the folder of this script.)
case = wg.Case.from_toml("../../runs/dense_22deg.toml")
case

# %%
# Computing it takes two tenths of a second, after some seconds of compiling the first time. What comes back is an
# ``xarray.Dataset``: profiles of the thickness ``h``, the velocity ``v`` and the solid volume fraction ``phi`` at
# some instants, and series such as the position of the front, sampled more often.
data = wg.simulate(case)
data

# %%
# It warns: at the end of the run, 1.8 s, a thin front still creeps, so that its run-out is not final. Four seconds
# are enough. ``with_`` gives a case that differs, and leaves the first as it was.
case = case.with_(time={"end": 4.0, "snapshots": [0.06, 0.48, 1.38, 4.0]})
data = wg.simulate(case)

# %%
# This is the picture that the command line makes. On the left the mass slides down and comes to rest: its thickness,
# how fast it is, how densely packed, and its dilatancy angle. Where that is positive the grains must dilate to move,
# and friction is greater by its tangent.
figure = wg.plot(data)

# %%
# The table, a row a run, in SI units: how far the front ran, how high the deposit is, by how much it dilated, when it
# stopped, and whether these are to be read with a reserve. :func:`warpgran.summary` says what each column is.
wg.summary(data)

# %%
# Packing matters: the same column, loose. Both are computed as one batch; the key in which they differ becomes a
# coordinate of the result.
both = wg.simulate([case, case.with_(column={"phi": 0.55})])
wg.summary(both)

# %%
# Everything of xarray works on it: the front against time, of both.
fig, ax = plt.subplots(layout="constrained")
fronts = both.front.assign_coords(run=["dense, 0.62", "loose, 0.55"])
fronts.plot.line(x="series_time", ax=ax)
ax.set(xlabel="time $t$ (s)", ylabel=r"front position $x_\mathrm{f}$ (m)")
ax.get_legend().set_title("packing")
plt.show()

# %%
# Where to go from here: :doc:`a sweep over many parameters <plot_2_sweep>`, :doc:`a slope of one's own
# <plot_3_own_slope>`, :doc:`parameters from an experiment <plot_4_fit>`, and :doc:`how fine a grid must be
# <plot_5_grid>`.
