"""How a study is cut into blocks."""

from __future__ import annotations

import pytest
from helpers.cases import ON_ONE_GRID, small

from warpgran.case.study import Study
from warpgran.solve.blocks import CACHE, plan
from warpgran.solve.schedule import Outputs
from warpgran.solve.state import bytes_of_run


@pytest.mark.parametrize(("runs", "threads"), [(1, 2), (5, 2), (64, 2), (100, 3), (257, 4)])
def test_every_thread_has_as_many_blocks_and_they_are_alike(runs: int, threads: int) -> None:
    case = small(**ON_ONE_GRID, **{"grid.cells": 1000})
    outputs = Outputs.of(case)
    study = Study.of([case] * runs)
    blocks = plan(study, range(runs), outputs, "float64", on_cpu=True, threads=threads, memory=1e12)
    sizes = [len(block.runs) for block in blocks]
    assert [run for block in blocks for run in block.runs] == list(range(runs))
    assert len(blocks) % threads == 0 or len(blocks) == runs
    assert max(sizes) - min(sizes) <= 1
    assert {block.capacity for block in blocks} == {max(sizes)}
    assert max(sizes) * bytes_of_run(1000, Outputs.none(), blocks[0].variant) <= CACHE


@pytest.mark.parametrize(("levels", "times"), [(0, 1), (1, 2), (2, 4), (3, 4)])
def test_of_blocks_that_start_on_finer_cells_the_part_that_starts_at_a_time_fits_the_cache(
    levels: int, times: int
) -> None:
    case = small(**{"grid.cells": 1000, "scheme.start": levels})
    study = Study.of([case] * 1000)
    blocks = plan(study, range(1000), Outputs.of(case), "float64", on_cpu=True, threads=1, memory=1e12)
    most = times * CACHE // bytes_of_run(blocks[0].padded - 1, Outputs.none(), blocks[0].variant)
    assert len(blocks) == -(-1000 // most)
