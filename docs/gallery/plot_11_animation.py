"""
An animation
============

The collapse on its slope, coloured by volume fraction; ``warpgran animate`` makes one of a result file.
"""

import warpgran as wg

case = wg.Case(
    slope={"angle": 22.0},
    grid={"right": 1.2, "cells": 500},
    time={"end": 1.6, "snapshots": {"every": 0.05}},
)
movie = wg.animate(wg.simulate(case))
