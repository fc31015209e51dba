"""`wg.simulate` as a program calls it: silent, with a bar on request, within the memory that it is given."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

import warpgran as wg

CODE = """
import warnings
import warp as wp
import warpgran as wg
warnings.simplefilter("ignore", wg.CaveatWarning)  # that it has not stopped after a tenth of a second
case = wg.Case(grid={"right": 0.3, "cells": 200}, time={"end": 0.1}, title="A small heap")
data = wg.simulate(case, progress=%s)
assert data.sizes["run"] == 1
assert wp.config.log_level == wp.LOG_INFO  # as it was
"""


@pytest.mark.slow
@pytest.mark.parametrize(("progress", "shown"), [(False, ()), (True, ("A small heap", "t = 0.100 of 0.1 s"))])
def test_nothing_is_printed_but_the_bar_that_was_asked_for(progress: bool, shown: tuple[str, ...]) -> None:
    done = subprocess.run([sys.executable, "-c", CODE % progress], capture_output=True, text=True, check=True)
    assert done.stdout == ""
    assert all(words in done.stderr for words in shown)
    assert bool(done.stderr) == progress
    assert "Warp" not in done.stderr and "CUDA" not in done.stderr and "Module" not in done.stderr


def test_memory_bounds_what_is_computed_at_once() -> None:
    case = wg.Case(grid={"right": 0.3, "cells": 200}, time={"end": 0.1})
    study = case.sweep({"slope.angle": [0.0, 10.0, 20.0]})
    with pytest.raises(MemoryError):
        wg.simulate(study, memory=1000.0)
    with pytest.raises(wg.OptionError, match="memory"):
        wg.simulate(study, memory=-1.0)
    assert (wg.simulate(study, memory=1e9)["status"] == 0).all()


def test_beyond_the_cells_of_a_run_on_a_smaller_grid_there_are_no_numbers() -> None:
    case = wg.Case(grid={"right": 0.3}, time={"end": 0.01, "snapshots": [0.0, 0.01]})
    data = wg.simulate(case.sweep({"grid.cells": [40, 60]}))
    for name in ("h", "v", "phi", "x"):
        values = data[name].values
        assert np.isnan(values[0, ..., 40:]).all() and np.isfinite(values[0, ..., :40]).all()
        assert np.isfinite(values[1]).all()
