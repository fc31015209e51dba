"""
The picture of a batch
======================

What the command line draws of a sweep: results over what was swept, and the front of all runs.
"""

import warpgran as wg

base = wg.Case(
    title="64 columns",
    grid={"right": 1.6, "cells": 400},
    time={"end": 3.0, "snapshots": [3.0]},
)
over = {
    "slope.angle": {"low": 0.0, "high": 18.0},
    "column.phi": {"low": 0.55, "high": 0.62},
}
figure = wg.plot(wg.simulate(base.sweep(over, mode="latin", samples=64)))
