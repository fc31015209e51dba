"""Each kernel of a step of order 2 against the same stage of the reference."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from helpers.cases import at_centres
from helpers.second_order import PERIODIC

from warpgran.case.case import Case
from warpgran.kernels.second import ARRAYS
from warpgran.kernels.second.drive import HUGE
from warpgran.physics import second_order
from warpgran.physics.state import with_ghosts
from warpgran.solve.solver import Solver

CELLS = 100
GIVEN = ("U0", "U1", "U2", "bhat", "drop")
"""What a step starts from; all else it must write."""
UNSEEN = ("h", "phi")
"""What is written when something is recorded, which `look` does at output times alone."""
AT_INTERFACES = ("F0", "E_l", "E_r", "F2")
INNER = ("X", "P", "share", "hold", "unused")
"""At two ends that are not one these are what ends.py makes of their neighbours."""
STAGES = tuple(name for name in ARRAYS if name not in ("bhat", "drop", *UNSEEN))


def rough_case(**changes: Any) -> Case:
    """Cells drawn at random on a rough bed, a third of them dry, and beside them a layer that friction holds."""
    rng = np.random.default_rng(7)
    layer = np.arange(CELLS) >= 60
    h = np.where(rng.random(CELLS) < 0.3, 0.0, rng.uniform(1e-4, 0.1, CELLS))
    phi, bed = rng.uniform(0.4, 0.62, CELLS), 0.05 * rng.standard_normal(CELLS)
    case = at_centres(np.where(layer, 0.05, h), np.where(layer, 0.6, phi), np.where(layer, 0.0, bed))
    ends = {"scheme.left": "wall", "scheme.right": "open"}
    return case.with_(**{"scheme.window": False, "slope.angle": 20.0, **ends, **changes})


def expected_stages(case: Case, steps: int) -> dict[str, np.ndarray]:
    """What every array holds after step number `steps` of the reference: those of a stage are of the second one."""
    run, drop = second_order.SecondOrder(case), second_order.bed_drop(case)
    for _ in range(steps - 1):
        run.step()
    before = run.U
    dt = run.step()
    W, _ = second_order.stage(second_order.relax(before, 0.5 * dt, case), dt, drop, case)
    cells = second_order.unknowns(W, case)
    on = second_order.drive(cells, drop, dt, case)
    faces = second_order.face_values(cells, case)
    flux = second_order.interface_flux(second_order.at_interfaces(faces, case), on, dt, case)
    mu = second_order.friction(cells, case)
    beside = with_ghosts(mu, periodic=case.scheme.periodic)
    s_l, s_r = with_ghosts(cells.s, periodic=case.scheme.periodic)
    mu_f = on.share * beside[0] + (1.0 - on.share) * beside[1]
    taken = np.abs(on.P) / (0.5 * (s_l + s_r) * case.dx)
    inner = slice(None) if case.scheme.periodic else slice(1, -1)
    found = {
        "v": cells.v, "phi_wet": np.where(cells.wet, cells.s**2, 0.0), "q": cells.q, "s": cells.s, "c": cells.c,
        "mu": mu, "X": on.X, "P": on.P, "share": on.share, "hold": np.minimum(on.hold, HUGE),
        "unused": np.where(np.abs(on.X) <= 0.5 * (s_l + s_r) * case.dx * mu_f, mu_f - taken, 0.0),
        "SX": on.SX, "SP": on.SP, "allowance": on.allowance,
        "F0": flux.F0, "E_l": flux.E_l, "E_r": flux.E_r, "F2": flux.F2,
    }  # fmt: skip
    found |= {f"{name}_{side}": pair[k] for name, pair in faces._asdict().items() for k, side in enumerate("LR")}
    found |= {f"{name}{k}": state[k] for name, state in (("W", W), ("U", run.U)) for k in range(3)}
    return found | {name: found[name][inner] for name in INNER}


def actual_stages(case: Case, steps: int, device: str) -> dict[str, np.ndarray]:
    """The same from the kernels, every output poisoned before the last step."""
    solver = Solver.holding([case.with_(**{"time.end": 1e3, "time.snapshots": [1e3]})], device=device)
    s = solver.state
    for _ in range(steps - 1):
        solver.step()
    row, n = s.row(0), s.cells[0]
    for array in (array for name, array in s.arrays.items() if name not in GIVEN):
        values = array.numpy()
        values[row : row + n + 1] = np.nan
        array.assign(values)
    solver.step()
    first = 0 if case.scheme.periodic else 1
    places = dict.fromkeys(STAGES, slice(row, row + n)) | dict.fromkeys(AT_INTERFACES, slice(row, row + n + 1))
    places |= dict.fromkeys(INNER, slice(row + first, row + n + 1 - first))
    return {name: s.arrays[name].numpy()[place] for name, place in places.items()}


@pytest.fixture(scope="module", params=[{}, {"scheme.alpha": 1.5, "rheology.mu_wall": 0.18}, PERIODIC])
def stages(request: pytest.FixtureRequest, device: str) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    case = rough_case(**request.param)
    return actual_stages(case, 5, device), expected_stages(case, 5)


@pytest.mark.parametrize("name", STAGES)
def test_stage_agrees_with_the_reference(name: str, stages: tuple[dict[str, np.ndarray], ...]) -> None:
    actual, expected = (each[name] for each in stages)
    scale = np.abs(expected).max() if name != "hold" else 1.0
    assert scale > 0.0
    assert actual.shape == expected.shape
    np.testing.assert_allclose(actual, expected, rtol=1e-11, atol=1e-13 * scale)
