"""
How fine a grid
===============

A number from a grid is no number of the model until one knows how far the two are apart. ``warpgran converge FILE``, or
:func:`warpgran.converge`, computes a case on half, the same and twice the cells and says so.
"""

import warpgran as wg

# %%
# The dense column on a horizontal plane, on 900 cells of 0.9 mm.
case = wg.Case.from_toml("../../runs/dense_0deg.toml").with_(grid={"cells": 900})
found = wg.converge(case)
found.table().round(4)

# %%
# Each row is something that one reports: its value on the three grids, the order with which they approach each other,
# the limit that Richardson's extrapolation gives, the error of the middle grid as a fraction of it, and the cells from
# which that is below one percent. NaN says that these grids show no order or no limit. In a line:
print(found.verdict())

# %%
# And drawn, the errors over the cells; the dotted line marks the case's own grid:
figure = found.plot()

# %%
# The same by the paper's scheme of first order, on as many cells:
first = wg.converge(case.with_(scheme={"order": 1}))
first.table().round(4)

# %%
print(first.verdict())

# %%
# A front is a kink, where no scheme keeps an order above one on finer and finer grids; what the second order changes
# is how small the error is to begin with. :doc:`/limits` has this for the paper's collapses, on grids down to 0.1 mm.
