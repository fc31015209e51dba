"""How a study is cut into blocks."""

from __future__ import annotations

import pytest
from helpers.cases import small

from warpgran.case.study import Study
from warpgran.solve.blocks import CACHE, plan
from warpgran.solve.schedule import Outputs
from warpgran.solve.state import bytes_of_run


@pytest.mark.parametrize(("runs", "threads"), [(1, 2), (5, 2), (64, 2), (100, 3), (257, 4)])
def test_every_thread_has_as_many_blocks_and_they_are_alike(runs: int, threads: int) -> None:
    case = small(**{"grid.cells": 1000})
    outputs = Outputs.of(case)
    study = Study.of([case] * runs)
    blocks = plan(study, range(runs), outputs, "float64", on_cpu=True, threads=threads, memory=1e12)
    sizes = [len(block.runs) for block in blocks]
    assert [run for block in blocks for run in block.runs] == list(range(runs))
    assert len(blocks) % threads == 0 or len(blocks) == runs
    assert max(sizes) - min(sizes) <= 1
    assert {block.capacity for block in blocks} == {max(sizes)}
    assert max(sizes) * bytes_of_run(1000, Outputs.none(), blocks[0].variant) <= CACHE
