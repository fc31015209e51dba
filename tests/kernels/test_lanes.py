"""Blocks of many lanes, as on a GPU, give the bits of the plain loops of the CPU: by Warp's emulation of blocks."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from helpers.cases import small
from helpers.places import TESTS

from warpgran.schema import Status
from warpgran.solve.finished import SCALARS
from warpgran.solve.schedule import Outputs
from warpgran.solve.solver import Solver
from warpgran.solve.state import padded_cells
from warpgran.solve.variant import variant_of

COMPARED = [
    (0, "32 lanes"), (0, "64 lanes"), (0, "256 lanes"), (1, "256 lanes"), (2, "64 lanes"), (0, "one block"),
    (3, "64 lanes"), (4, "64 lanes"), (5, "64 lanes"),
]  # fmt: skip
"""Ways of tests/helpers/lanes.py, and the shapes compared with their plain loops; for one block see
benchmarks/parts/one_block.py."""

Found = dict[str, np.ndarray]


pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> Found:
    file = tmp_path_factory.mktemp("lanes") / "found.npz"
    program = TESTS / "helpers" / "lanes.py"
    done = subprocess.run([sys.executable, str(program), str(file)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    with np.load(file) as data:
        return dict(data)


@pytest.mark.parametrize("way", range(6))
def test_runs_end_in_every_way_there_is(found: Found, way: int) -> None:
    expected = [Status.OK, Status.AT_REST, Status.STEP_LIMIT, Status.DIVERGED if way == 5 else Status.OK, Status.OK]
    assert list(found[f"{way}/plain loop/status"]) == expected


@pytest.mark.parametrize(("way", "shape"), COMPARED)
def test_lanes_give_the_bits_of_a_plain_loop(found: Found, way: int, shape: str) -> None:
    for key in ("status", "steps", "t", "bad_cell", "lo", "hi", "h", "v", "phi"):
        np.testing.assert_array_equal(found[f"{way}/{shape}/{key}"], found[f"{way}/plain loop/{key}"], key)


@pytest.mark.parametrize(("way", "shape"), COMPARED)
def test_sums_of_lanes_differ_by_their_order_alone(found: Found, way: int, shape: str) -> None:
    ours, theirs = (found[f"{way}/{each}/scalars"] for each in (shape, "plain loop"))
    for k, name in enumerate(SCALARS):
        if name in ("front", "h_max", "v_max", "v_flow"):
            np.testing.assert_array_equal(ours[..., k], theirs[..., k], name)
        else:
            np.testing.assert_allclose(ours[..., k], theirs[..., k], rtol=1e-13, err_msg=name)


def test_lanes_are_refused_where_there_are_none() -> None:
    case = small()
    with pytest.raises(ValueError, match="lanes: 32 on the cpu; allowed: 1"):
        Solver(1, padded_cells(case.grid.cells), variant_of(case, "float64"), Outputs.of(case), lanes=32)
