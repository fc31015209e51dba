"""Device memory of a block of runs: the only place that allocates it.

Run r owns the elements `row(r) - MARGIN` to `row(r) + padded - 1` of every flat array of cells or interfaces; see
kernels/__init__.py for the layout. A state is allocated once and loaded with one set of runs after another.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import warp as wp

from warpgran.arrays import Array
from warpgran.case.case import Case
from warpgran.kernels.build import SCHEMES
from warpgran.kernels.clock import OK
from warpgran.kernels.precision import BLOCK, MARGIN, Variant, precision
from warpgran.kernels.record import SCALARS
from warpgran.physics.second_order import bed_drop
from warpgran.solve.checkpoint import PER_RUN, Checkpoint
from warpgran.solve.schedule import Outputs

CONSERVED = ("U0", "U1", "U2")
"""Names of the arrays of the conserved state."""


def padded_cells(cells: int) -> int:
    """Elements of a row: the cells and a ghost cell, in whole blocks."""
    return -(-(cells + 1) // BLOCK) * BLOCK


class State:
    """Arrays of a block of runs on one device.

    Every argument of a kernel is an attribute of that name or one of `arrays`.

    Attributes:
        arrays: The flat arrays of cells and interfaces of the scheme, by name; the pages of kernels/first and
            kernels/second say what they hold.
        cells: of each run; start_surplus: cell-steps of its start beyond as many steps on these cells.
        params: Parameters, per run.
        lo, hi: window of cells visited, per run; active: whether a run advances; due: whether it is to be recorded.
        t_stop: when a run pauses, inactive until it is made active again [s]; infinite in the run proper.
        t, dt_exact, dt, steps: time and time step [s], in float64 and in the precision of the kernels, and steps taken,
            per run.
        output, status, bad_cell: index of the next output, status code and first unsound cell (-1: none), per run.
        x_left: left end of the grid [m], per run; v_flow: of the last sample [m/s], per run.
        max_speed, max_viscosity: what limits the next time step [m/s, m2/s], per run.
        times, snapshot_at, sample_at, snapshots, samples: the outputs.
        budget, running: of the whole block, one element: steps left, whether to advance further.
        scalars: (runs, samples, len(SCALARS)) and h_out, v_out, phi_out: (runs, snapshots, padded), flat.
    """

    def __init__(self, runs: int, padded: int, variant: Variant, outputs: Outputs, device: Any) -> None:
        self.runs, self.padded, self.variant, self.outputs = runs, padded, variant, outputs
        self.pitch = padded + MARGIN
        self.size = runs * self.pitch + MARGIN
        self.cells = [0] * runs
        self.start_surplus = np.zeros(runs, dtype=np.int64)
        self.scheme = SCHEMES[variant.order]
        kinds = precision(variant.precision)
        Real = kinds.Real

        def per_run(dtype: Any) -> Any:
            return wp.zeros(runs, dtype=dtype, device=device)

        # One piece of memory, so that all of it is zeroed at once; from array to array an odd multiple of MARGIN,
        # one or two cache lines, so that equal indices do not all compete for the same places of the cache.
        stride = -(-self.size // MARGIN) * MARGIN + MARGIN
        stride += MARGIN * (stride // MARGIN % 2 == 0)
        names = self.scheme.arrays
        self._slab = wp.zeros(len(names) * stride, dtype=Real, device=device)
        self.arrays = {name: self._slab[k * stride : k * stride + self.size] for k, name in enumerate(names)}

        self.params = per_run(kinds.RunParams)
        self.lo, self.hi, self.active, self.due = (per_run(wp.int32) for _ in range(4))
        self.status, self.bad_cell, self.steps, self.output = (per_run(wp.int32) for _ in range(4))
        self.t, self.t_stop, self.x_left, self.v_flow, self.dt_exact = (per_run(wp.float64) for _ in range(5))
        self.dt, self.max_speed, self.max_viscosity = (per_run(Real) for _ in range(3))
        self.budget, self.running = (wp.zeros(1, dtype=wp.int32, device=device) for _ in range(2))
        self.times = wp.array(outputs.times, dtype=wp.float64, device=device)
        self.snapshot_at = wp.array(outputs.snapshot_at, dtype=wp.int32, device=device)
        self.sample_at = wp.array(outputs.sample_at, dtype=wp.int32, device=device)
        self.snapshots, self.samples = outputs.snapshots, outputs.samples
        self.scalars = wp.zeros(runs * self.samples * len(SCALARS), dtype=wp.float64, device=device)
        self.h_out, self.v_out, self.phi_out = (
            wp.zeros(runs * self.snapshots * padded, dtype=Real, device=device) for _ in range(3)
        )

    def argument(self, name: str) -> Any:
        """What a kernel gets for an argument of that name."""
        return self.arrays[name] if name in self.arrays else getattr(self, name)

    @property
    def U(self) -> tuple[Any, Any, Any]:
        """The conserved state, three flat arrays: phi h [m], phi h v [m2/s], phi^alpha h [m]."""
        U0, U1, U2 = (self.arrays[name] for name in CONSERVED)
        return U0, U1, U2

    def row(self, r: int) -> int:
        """Element of cell 0 of run r."""
        return MARGIN + r * self.pitch

    def load(self, cases: Sequence[Case], checkpoint: Checkpoint | None = None) -> None:
        """Put runs at their initial state, no more than the capacity; the rest of it is idle.

        With a checkpoint there is one run, which is put where it was taken. All that a step reads and a checkpoint has
        not is decoded from U at its beginning; the window may be narrower than it was then, which changes no bit.
        """
        idle = self.runs - len(cases)
        self.cells = [case.grid.cells for case in cases] + [0] * idle
        self.start_surplus[:] = 0
        values: dict[str, Array] = {}
        lo, hi = np.zeros(self.runs, dtype=np.int32), np.zeros(self.runs, dtype=np.int32)
        params = np.zeros(self.runs, dtype=self.params.dtype.numpy_dtype())
        phi = values["phi"] = np.full(self.size, 0.5)  # between rows and in idle ones: anything that can be divided by
        for r, case in enumerate(cases):
            row, padded = self.row(r), padded_cells(case.grid.cells)
            # Cells outside the window are read by their neighbours within: they must look dry.
            phi[row - MARGIN : row + self.padded] = case.rheology.phi_stat
            moved = {} if checkpoint is None else dict(zip(CONSERVED, checkpoint.U, strict=True))
            for name, each in {**_initial(case), **moved}.items():
                if name in self.arrays:
                    values.setdefault(name, np.zeros(self.size))[row : row + each.size] = each
            limited = case.scheme.window and not case.scheme.periodic
            U0 = values["U0"][row : row + case.grid.cells]
            lo[r], hi[r] = _window(U0, padded, self.scheme.empty) if limited else (0, padded)
            for name, value in _parameters(case, row, padded).items():
                params[name][r] = value

        self._slab.zero_()
        for name, each in values.items():
            self.arrays[name].assign(each)
        self.params.assign(params)
        self.lo.assign(lo)
        self.hi.assign(hi)
        present = np.arange(self.runs) < len(cases)
        self.active.assign(present.astype(np.int32))
        self.due.assign((present & (self.outputs.times[0] == 0.0)).astype(np.int32))
        self.x_left.assign(np.array([case.grid.left for case in cases] + [0.0] * idle))
        for array in (self.t, self.steps, self.output, self.max_speed, self.max_viscosity, self.dt_exact):
            array.zero_()
        self.t_stop.fill_(np.inf)
        self.status.fill_(OK)
        self.bad_cell.fill_(-1)
        self.v_flow.fill_(0.0)
        self.scalars.fill_(np.nan)
        for array in (self.h_out, self.v_out, self.phi_out):
            array.fill_(np.nan)
        if checkpoint is not None:
            self._restore(checkpoint)

    def checkpoint(self, seconds: float) -> Checkpoint:
        """Run 0, between two steps, after so many seconds of the time loop."""
        numbers = {name: float(getattr(self, name).numpy()[0]) for name in PER_RUN}
        return Checkpoint(
            np.stack([self.of_run(array, 0) for array in self.U], dtype=np.float64),
            self.recorded_scalars()[0],
            tuple(profile[0, :, : self.cells[0]] for profile in self._profiles()),
            {**numbers, "start_surplus": float(self.start_surplus[0]), "seconds": seconds},
        )

    def _restore(self, checkpoint: Checkpoint) -> None:
        """Set what run 0 has recorded, and its numbers."""
        self.scalars[: checkpoint.scalars.size].assign(checkpoint.scalars.ravel())
        for array, profile in zip((self.h_out, self.v_out, self.phi_out), checkpoint.profiles, strict=True):
            for k, values in enumerate(profile):
                array[k * self.padded : k * self.padded + values.size].assign(values)
        self.start_surplus[0] = checkpoint.numbers["start_surplus"]
        for name in PER_RUN:
            getattr(self, name)[:1].assign(np.array([checkpoint.numbers[name]]))

    def of_run(self, array: Any, r: int) -> Array:
        """The cells of run r, from a flat array; a copy."""
        return np.array(array.numpy()[self.row(r) : self.row(r) + self.cells[r]])

    def recorded_scalars(self) -> Array:
        """The samples so far, shape (runs, samples, len(SCALARS)); NaN where there is none yet."""
        return np.array(self.scalars.numpy()).reshape(self.runs, self.outputs.samples, len(SCALARS))

    def recorded_profiles(self) -> tuple[Array, ...]:
        """h [m], v [m/s], phi of the snapshots so far, each (runs, snapshots, padded); NaN where there is none yet."""
        return tuple(map(np.array, self._profiles()))

    def _profiles(self) -> tuple[Array, ...]:
        """The same; on a CPU without a copy."""
        shape = (self.runs, self.outputs.snapshots, self.padded)
        return tuple(array.numpy().reshape(shape) for array in (self.h_out, self.v_out, self.phi_out))


def _initial(case: Case) -> dict[str, Array]:
    """Arrays that a run starts from, of its cells or interfaces; a scheme takes those that it has."""
    h, phi = case.initial_state()
    U = phi * h, phi * h * case.initial_velocity(), phi**case.scheme.alpha * h
    return {**dict(zip(CONSERVED, U, strict=True)), "bhat": case.bhat, "dbhat": case.dbhat, "drop": bed_drop(case)}


def _window(U0: Array, padded: int, empty: int) -> tuple[int, int]:
    """First and one-past-last cell to visit: all that holds mass and empty cells on either side, in whole blocks."""
    wet = np.flatnonzero(U0)
    if wet.size == 0:
        return 0, padded
    return max(int(wet[0]) - empty, 0) // BLOCK * BLOCK, min(padded_cells(int(wet[-1]) + empty), padded)


def _parameters(case: Case, row: int, padded: int) -> dict[str, float]:
    """The fields of the struct that the kernels read."""
    r, scheme = case.rheology, case.scheme
    ghost = {"wall": -1.0, "open": 1.0, "periodic": 1.0}
    return {
        "cells": case.grid.cells, "row": row, "longest": padded, "step_limit": min(case.time.step_limit, 2**31 - 1),
        "dx": case.dx, "per_dx": 1.0 / case.dx, "g_c": case.g_c, "cfl": scheme.cfl,
        "mu1": r.mu1, "dmu": r.mu2 - r.mu1, "I0": r.I0, "d": r.grain_diameter,
        "K": r.K, "K_tilde": r.K_tilde, "phi_stat": r.phi_stat, "N": r.phi_eq_N,
        "wall": r.mu_wall / r.channel_width, "h_min": case.h_min, "h_front": case.h_front,
        "rest_speed": case.rest_speed if case.time.stop_at_rest else -1.0,
        "a": scheme.alpha - 1.0, "per_a": 1.0 / (scheme.alpha - 1.0),
        "per_2a": 0.5 / (scheme.alpha - 1.0), "per_2alpha_1": 1.0 / (2.0 * scheme.alpha - 1.0),
        "head": scheme.lambda_ / case.g_c,
        "xi1": scheme.xi[0], "xi2": scheme.xi[1], "xi3": scheme.xi[2], "xi_max": max(scheme.xi),
        "v_left": ghost[scheme.left], "v_right": ghost[scheme.right],
    }  # fmt: skip


def bytes_of_run(cells: int, outputs: Outputs, variant: Variant) -> int:
    """Device memory of one run [bytes], with its recorded output."""
    real = 8 if variant.precision == "float64" else 4
    row = padded_cells(cells)
    flat = (row + MARGIN) * len(SCHEMES[variant.order].arrays) + 3 * outputs.snapshots * row
    return real * flat + 8 * outputs.samples * len(SCALARS)


def bytes_of_start(cells: int, levels: int, variant: Variant) -> int:
    """Device memory of the start of one run on that many levels of finer cells [bytes], beside `bytes_of_run`."""
    finer = range(1, levels + 1)
    return sum(bytes_of_run(cells * 2**level, Outputs.none(), variant) for level in finer)


def most_runs(padded: int, outputs: Outputs, variant: Variant) -> int:
    """Largest capacity of a state, whatever the memory: Warp counts the elements of an array in 31 bits.

    Args:
        padded: Elements of a row.
        outputs: The output schedule of the runs.
        variant: What is compiled in.
    """
    arrays = len(SCHEMES[variant.order].arrays)
    elements = 2**31 - 1 - arrays * 5 * MARGIN  # less what lies between the arrays of the slab
    row = arrays * (padded + MARGIN), outputs.snapshots * padded, outputs.samples * len(SCALARS)
    return elements // max(row)
