"""
The picture of a batch
======================

What the command line draws of a sweep: run-out over what was swept, and the series of all runs.
"""

import warpgran as wg

base = wg.Case().with_(**{"grid.right": 1.6, "grid.cells": 400, "time.end": 2.5, "time.snapshots": [2.5]})
study = base.sweep(
    {"slope.angle": {"low": 0.0, "high": 20.0}, "column.phi": {"low": 0.55, "high": 0.62}}, mode="latin", samples=64
)
figure = wg.plot(wg.simulate(study))
