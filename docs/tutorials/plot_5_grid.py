"""
How fine a grid
===============

A number from a grid is no number of the model until one knows how far the two are apart. ``warpgran converge FILE``, or
:func:`warpgran.converge`, computes a case on half, the same and twice the cells and says so.
"""

from pathlib import Path

import warpgran as wg

RUNS = Path.cwd().parents[1] / "runs"

# %%
# The dense column on 16 degrees, on 450 cells.
case = wg.Case.from_toml(RUNS / "dense_16deg.toml").with_(**{"grid.cells": 450})
wg.converge(case).table()

# %%
# Each row is something that one reports: its value on the three grids, the order with which they approach each other,
# the limit that Richardson's extrapolation gives, and the error of the middle grid as a fraction of it. The same by
# the paper's scheme of first order, on as many cells:
wg.converge(case.with_(**{"scheme.order": 1, "scheme.start": None})).table()

# %%
# Fronts converge with order one at best, whatever the scheme, for the front is a kink; what the second order changes
# is how small the error is to begin with. :doc:`/limits` has this for the paper's collapses, on grids down to 0.06
# mm.
