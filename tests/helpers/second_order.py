"""What the tests of order 2 share: its table of numbers, and states that friction holds."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from helpers.cases import COMPILED, at_centres
from warpgran.case.case import Case

WALLS: dict[str, Any] = {"scheme.left": "wall", "scheme.right": "wall"}
PERIODIC: dict[str, Any] = {"scheme.left": "periodic", "scheme.right": "periodic"}
OPEN: dict[str, Any] = {"scheme.left": "open", "scheme.right": "open"}
CELLS = 128  # so that centres, and with them the interpolation of the tables, are exact


def _grid(left: float, right: float, cells: int) -> dict[str, Any]:
    return {"grid.left": left, "grid.right": right, "grid.cells": cells}


_FLAT, _STEEP = {"slope.angle": 0.0, **_grid(-0.2, 0.6, 800)}, {"slope.angle": 22.0, **_grid(-0.2, 1.4, 1600)}
_F0, _F1, _THIN = {"rheology.phi_eq": "f0"}, {"rheology.phi_eq": "f1"}, {"scheme.h_bed": 1e-4}
_X = -0.6 + (np.arange(600) + 0.5) * 2e-3
_BUMP = {"slope.bed": {"x": _X, "b": 0.02 * np.exp(-((_X / 0.1) ** 2))}}

TABLE: list[Any] = [
    # changes; rows: t (s), steps, "max h (cm), front at 1.4 mm and at 5 mm (cm), max v (m/s), volume change (%)"
    pytest.param(_FLAT, [
        (0.36, None, "14.000837 34.14735 30.26733 0.07822250 3.8885"),
        (0.50, 1777, "14.000803 34.14777 30.32955 0.00000000 3.8709")], id="0"),
    pytest.param({**_FLAT, "grid.cells": 400}, [
        (0.36, None, "14.001682 33.96151 30.15251 0.07910935 3.8879"),
        (0.50, 860, "14.010570 33.96219 30.21777 0.00000000 3.8698")], id="0, 400 cells"),
    pytest.param({**_FLAT, "rheology.K": 0.0}, [
        (0.36, 1172, "13.595333 32.66136 29.96598 0.06720519 -0.0745")], id="0, K = 0"),
    pytest.param({**_FLAT, "column.phi": 0.55}, [
        (0.36, 1368, "12.336304 32.90246 29.38478 0.08038617 -3.7854")], id="0, loose"),
    pytest.param(_STEEP, [
        (0.48, None, "6.235222 68.91307 61.62973 0.96972251 9.5846"),
        (1.38, 4168, "4.458798 107.44364 105.46672 0.25650282 7.0510")], id="22"),
    pytest.param({**_STEEP, "scheme.alpha": 3.0}, [
        (0.48, 2221, "6.235221 68.91150 61.62926 0.96981532 9.5845")], id="22, alpha = 3"),
    pytest.param({**_STEEP, "scheme.alpha": 1.7, "rheology.phi_eq_N": 3.0}, [
        (0.48, 2993, "6.235387 68.80398 61.54418 0.98294965 9.7811")], id="22, alpha = 1.7, N = 3"),
    pytest.param({**_STEEP, "scheme.h_bed": 1e-5}, [
        (0.48, None, "6.235217 70.41096 61.67539 0.95639733 9.8801"),
        (1.38, 3814, "4.458802 107.47542 105.58434 0.25322921 7.1049")], id="22, layer"),
    pytest.param({**_STEEP, "rheology.mu_wall": 0.18}, [
        (0.48, 2213, "7.558549 67.08500 58.95012 0.91338784 9.0772")], id="22, walls"),
    pytest.param({**_STEEP, **_F1, **_THIN}, [
        (0.48, 1790, "6.235447 65.67258 63.53013 0.93945600 9.8924")], id="22, f1"),
    pytest.param({"slope.angle": 15.0, **_grid(-0.2, 0.8, 500), **_F0, **_THIN, "scheme.h_min": 7e-3}, [
        (0.40, 694, "9.659118 50.28914 47.17859 0.65794116 7.8790")], id="15, f0"),
    pytest.param({"slope.angle": -10.0, **_grid(-0.6, 0.6, 600), "column.start": -0.1, **_BUMP, **WALLS}, [
        (0.40, 800, "7.042329 37.94324 34.79745 0.50294375 7.3727")], id="-10, bump"),
    pytest.param({"slope.angle": -30.0, **_grid(-0.05, 0.55, 240), "column.start": 0.0, **OPEN}, [
        (0.25, 381, "8.017372 37.40611 34.81012 0.88868732 -26.4920")], id="-30, open"),
    pytest.param({**_FLAT, "grid.cells": 400, "scheme.start": 2}, [
        (0.02, None, "14.000000 3.82230 3.24530 2.01748064 0.4527"),
        (0.20, None, "14.000576 28.20426 23.93575 0.90963381 3.9613"),
        (0.50, 984, "14.012367 34.15542 30.30962 0.00000000 3.8682")], id="0, start"),
    pytest.param({"slope.angle": 22.0, **_grid(-0.2, 1.6, 450), "scheme.start": 2}, [
        (0.48, None, "6.219809 68.82986 61.54447 0.97241217 9.5632"),
        (1.38, 1145, "4.445712 107.43599 105.52569 0.26512262 7.0583")], id="22, start"),
]  # fmt: skip
"""Numbers of an independent implementation."""


def measured(case: Case, h: np.ndarray, v: np.ndarray, phi: np.ndarray) -> list[float]:
    """What a row of the table says of a profile.

    Fronts are of the compacted thickness phi h/phi_stat; speed and volume are of what is compacted to more than 1.4 mm.
    """
    h_c = phi * h / case.rheology.phi_stat

    def front(level: float) -> float:
        i = np.flatnonzero(h_c > level)[-1]
        return float(case.x[i] + (h_c[i] - level) / (h_c[i] - h_c[i + 1]) * case.dx)

    thick = h_c > 1.4e-3
    volume = float(h[thick].sum() * case.dx)
    speed = float(np.abs(v[thick]).max())
    return [100 * float(h.max()), 100 * front(1.4e-3), 100 * front(5e-3), speed, 100 * (volume / 0.028 - 1)]


HELD = {("f2", True, True)} | {
    (each.law.removesuffix("_one"), each.alpha_two, each.periodic) for each in COMPILED if each.law != "f2"
}
"""Laws (f2 with N = 1), whether alpha = 2, and whether periodic: those whose kernels other tests have compiled too."""


def held_heap(seed: int) -> Case:
    """A heap that friction can hold, |X| < M at every interface, drawn at random; all else is drawn too.

    Ends and ground alternate: dry land beside the heap or none, any bed under it, phi that jumps from cell to cell.
    """
    rng = np.random.default_rng(seed)
    ends = (WALLS, OPEN, {"scheme.left": "open", "scheme.right": "wall"}, PERIODIC)[seed % 4]
    periodic, layer = ends is PERIODIC, seed % 8 >= 4  # a layer has no dry land
    changes: dict[str, Any] = {
        "rheology.K": float(rng.choice([0.0, 1.0, 4.09])),
        "rheology.phi_eq": str(rng.choice(["f0", "f1", "f2"])),
        "rheology.mu_wall": float(rng.choice([0.0, 0.18])),
        "scheme.alpha": float(rng.choice([1.5, 2.0, 3.0])),
        "slope.angle": float(rng.uniform(-5.0, 5.0)),
        **ends,
    }
    if (changes["rheology.phi_eq"], changes["scheme.alpha"] == 2.0, periodic) not in HELD:
        changes["scheme.alpha"] = 3.0 if changes["scheme.alpha"] == 2.0 else 2.0
    dx, tan = 1.0 / CELLS, np.tan(np.radians(changes["slope.angle"]))
    phi = rng.uniform(0.54, 0.62, CELLS)
    s = np.sqrt(phi)
    M = 0.5 * dx * (0.48 + changes["rheology.K"] * (phi.min() - 0.582)) * (s + np.roll(s, 1))  # M[i]: cells i-1 and i
    share = rng.uniform(-0.85, 0.85, CELLS)  # of it that X is to take
    if layer:
        bed = 0.02 * rng.standard_normal(CELLS)
        driven = 0.5 * (s + np.roll(s, 1)) * (bed - np.roll(bed, 1) - dx * tan)
        share = 0.5 * share
        share -= (share @ M + driven.sum()) / M.sum()  # what is climbed is descended: the ends fit together
        q = np.cumsum(-driven - share * M)
        q += rng.uniform(0.001, 0.05) - q.min()
    else:
        bed, q = np.zeros(CELLS), np.zeros(CELLS)
        q[0] = 0.0 if periodic else rng.uniform(0.0, 0.03)
        gentle = 0.1 * dx * np.sin(2.0 * np.pi * np.arange(CELLS) / CELLS + rng.uniform(0.0, 6.0))
        share = np.abs(share)
        share = np.where(np.arange(CELLS) < CELLS // 5, -share, 0.5 + 0.4 * share)  # up, and all the way down
        for i in range(1, CELLS):
            s_f = 0.5 * (s[i - 1] + s[i])
            for rise in (gentle[i] if periodic else 0.004 * rng.standard_normal(), gentle[i]):  # gentle if it gets dry
                q[i] = q[i - 1] - s_f * (rise - dx * tan) - share[i] * M[i]
                bed[i] = bed[i - 1] + rise
                if q[i] > 0.0:
                    break
            q[i] = max(q[i], 0.0)
    return at_centres(q / s, phi, bed, **changes)
