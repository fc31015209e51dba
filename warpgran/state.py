"""Device memory of a batch of runs: the only place that allocates it.

Run r owns the elements `row[r] - MARGIN` to `row[r] + padded - 1` of every flat array of cells or interfaces; see
kernels/precision.py for the layout.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import warp as wp

from warpgran.case import Case
from warpgran.kernels.inspect import SCALARS
from warpgran.kernels.precision import BLOCK, MARGIN, Precision

Array = np.ndarray


def _round_up(n: int) -> int:
    return -(-n // BLOCK) * BLOCK


class State:
    """Arrays of a batch on one device.

    Attributes:
        U: conserved state, three arrays: phi h [m], phi h v [m2/s], phi^alpha h [m].
        W: the state after the update and the relaxation, as U.
        h, v, phi, mu: what U decodes to at cells [m, m/s, -, -]; phi_wet: phi, 0 in dry cells; s: U2/U0.
        v_f, Dz, iota: velocity [m/s], jump of the total topography [m] and viscosity [m2/s] at interfaces.
        star: reconstructed h_l, h_r [m], phi_l, phi_r at interfaces.
        F: fluxes F0, F1 as the left and the right cell see it, F2, at interfaces.
        bhat, dbhat: total bed at cells, its jump at interfaces [m].
        lo, hi: window of cells visited, per run; active: whether a run advances.
        t, steps, status, bad_cell: time [s], steps taken, status code, first unsound cell (-1: none), per run.
        t_out, budget, running: of the whole batch, one element: time to reach [s], steps left, whether to go on.
        scalars: (runs, len(SCALARS)), float64.
    """

    def __init__(self, cases: Sequence[Case], precision: Precision, device: Any) -> None:
        self.device = device
        self.cells = [case.grid.cells for case in cases]
        padded = [_round_up(n + 1) for n in self.cells]
        ends = np.cumsum([n + MARGIN for n in padded])
        self.rows = [int(end) - n for end, n in zip(ends, padded, strict=True)]
        self.size = int(ends[-1]) + MARGIN
        runs, real = len(cases), precision.Real

        def cells(host: Array | None = None) -> Any:
            if host is None:
                return wp.zeros(self.size, dtype=real, device=device)
            return wp.array(host, dtype=real, device=device)

        def per_run(dtype: Any, n: int = runs) -> Any:
            return wp.zeros(n, dtype=dtype, device=device)

        h, phi = (self.gather(values) for values in zip(*(case.initial_state() for case in cases), strict=True))
        alpha = self.gather([np.full(case.grid.cells, case.scheme.alpha) for case in cases])
        U0 = phi * h
        self.U = (cells(U0), cells(), cells(phi**alpha * h))
        self.W = (cells(), cells(), cells())
        self.saved = (cells(), cells(), cells())

        # Cells outside the window are read by their neighbours within: they must look dry.
        stat = np.concatenate([np.full(n + MARGIN, c.rheology.phi_stat) for n, c in zip(padded, cases, strict=True)])
        self.h, self.v, self.mu, self.phi_wet, self.s = (cells() for _ in range(5))
        self.phi = cells(np.concatenate([stat, stat[-1:].repeat(MARGIN)]))
        self.v_f, self.Dz, self.iota = cells(), cells(), cells()
        self.star = (cells(), cells(), cells(), cells())
        self.F = (cells(), cells(), cells(), cells())
        self.bhat = cells(self.gather([case.bhat for case in cases]))
        self.dbhat = cells(self.gather([np.concatenate(([0.0], np.diff(case.bhat))) for case in cases]))

        windows = np.array([
            _window(U0[row : row + n], n_padded, case.scheme.window)
            for row, n, n_padded, case in zip(self.rows, self.cells, padded, cases, strict=True)
        ]).reshape(runs, 2)  # fmt: skip
        self.lo = wp.array(windows[:, 0], dtype=int, device=device)
        self.hi = wp.array(windows[:, 1], dtype=int, device=device)
        params = [_parameters(case, row, n, precision) for case, row, n in zip(cases, self.rows, padded, strict=True)]
        self.params = wp.array(params, dtype=precision.RunParams, device=device)
        self.left = wp.array([case.grid.left for case in cases], dtype=wp.float64, device=device)

        self.active, self.status, self.steps, self.bad_cell = (per_run(wp.int32) for _ in range(4))
        self.all_active = wp.ones(runs, dtype=wp.int32, device=device)
        self.t, self.dt_exact, self.saved_t = (per_run(wp.float64) for _ in range(3))
        self.saved_steps = per_run(wp.int32)
        self.dt, self.max_speed, self.max_viscosity = (per_run(real) for _ in range(3))
        self.t_out, self.budget, self.running = per_run(wp.float64, 1), per_run(wp.int32, 1), per_run(wp.int32, 1)
        self.scalars = wp.zeros((runs, len(SCALARS)), dtype=wp.float64, device=device)

    def gather(self, values: Sequence[Array]) -> Array:
        """Values at cells, one array a run, laid out as the flat arrays are; zeros elsewhere."""
        flat = np.zeros(self.size)
        for row, run in zip(self.rows, values, strict=True):
            flat[row : row + run.size] = run
        return flat

    def scatter(self, array: Any) -> list[Array]:
        """The cells of each run, from a flat array on the device; copies."""
        flat = array.numpy()
        return [flat[row : row + n].copy() for row, n in zip(self.rows, self.cells, strict=True)]


def _window(U0: Array, padded: int, limited: bool) -> tuple[int, int]:
    """First and one-past-last cell to visit: all that holds mass and an empty cell on either side, in whole blocks."""
    wet = np.flatnonzero(U0)
    if not limited or wet.size == 0:
        return 0, padded
    return max(int(wet[0]) - 1, 0) // BLOCK * BLOCK, min(_round_up(int(wet[-1]) + 2), padded)


def _parameters(case: Case, row: int, padded: int, precision: Precision) -> Any:
    """The struct that the kernels read."""
    p, r, scheme = precision.RunParams(), case.rheology, case.scheme
    ghost = {"wall": -1.0, "open": 1.0}
    values = {
        "cells": case.grid.cells, "row": row, "padded": padded, "step_limit": case.time.step_limit,
        "dx": case.dx, "per_dx": 1.0 / case.dx, "g_c": case.g_c, "cfl": scheme.cfl,
        "mu1": r.mu1, "dmu": r.mu2 - r.mu1, "I0": r.I0, "d": r.grain_diameter,
        "K": r.K, "K_tilde": r.K_tilde, "phi_stat": r.phi_stat, "N": r.phi_eq_N,
        "wall": r.mu_wall / r.channel_width, "h_min": case.h_min, "h_front": scheme.h_front,
        "alpha": scheme.alpha, "a": scheme.alpha - 1.0, "root": 1.0 / (scheme.alpha - 1.0),
        "per_2a": 0.5 / (scheme.alpha - 1.0), "per_2alpha_1": 1.0 / (2.0 * scheme.alpha - 1.0),
        "head": scheme.lambda_ / case.g_c,
        "xi1": scheme.xi[0], "xi2": scheme.xi[1], "xi3": scheme.xi[2], "xi_max": max(scheme.xi),
        "v_left": ghost[scheme.left], "v_right": ghost[scheme.right],
    }  # fmt: skip
    for name, value in values.items():
        setattr(p, name, value)
    return p


def memory(case: Case, precision: Precision) -> int:
    """Bytes of device memory that one run of a case takes, about."""
    per_cell = 27
    return math.ceil((_round_up(case.grid.cells + 1) + MARGIN) * per_cell * (8 if precision.name == "float64" else 4))
