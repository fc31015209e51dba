"""The scheme over a batch of runs: which kernels are launched, in the order of the paper."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import warp as wp

from warpgran.case import Case
from warpgran.kernels.build import build
from warpgran.kernels.clock import DIVERGED, OK
from warpgran.kernels.inspect import SCALARS
from warpgran.kernels.precision import Variant, precision
from warpgran.state import State

Array = np.ndarray

CHUNK = 1024
"""Cells that a block of a GPU walks."""
LANES = 256
"""Threads of such a block."""
REPLAY = 20_000_000
"""Cell-steps between two returns to Python: a fraction of a second, so that an interruption is noticed."""


def variant_of(case: Case, precision_name: str) -> Variant:
    """What must be compiled in for a case."""
    r, scheme = case.rheology, case.scheme
    return Variant(
        precision=precision_name,
        alpha_two=scheme.alpha == 2.0,
        lambda_zero=scheme.lambda_ == 0.0,
        phi_eq="f2_one" if r.phi_eq == "f2" and r.phi_eq_N == 1.0 else r.phi_eq,
        relaxation=scheme.relaxation,
        viscosity=scheme.viscosity,
    )


class Solver:
    """A batch of runs of one variant on one device, all advanced to the same output times."""

    def __init__(self, cases: Sequence[Case], *, device: str = "cpu", precision_name: str = "float64") -> None:
        """Allocate the batch at its initial state.

        Args:
            cases: one or more cases that share a variant.
            device: a Warp device, "cpu" or "cuda:N".
            precision_name: "float64" or "float32".
        """
        variants = {variant_of(case, precision_name) for case in cases}
        if len(variants) != 1:
            raise ValueError("the cases of a batch must share a variant")
        self.device = wp.get_device(device)
        self.kernels = build(variants.pop())
        self.state = State(cases, precision(precision_name), self.device)
        self.runs = len(cases)
        longest = max(self.state.cells)
        self.chunks = 1 if self.device.is_cpu else -(-longest // CHUNK)
        self.lanes = 1 if self.device.is_cpu else LANES
        self.steps_per_replay = max(100, REPLAY // sum(self.state.cells))
        self._given_up = np.zeros(self.runs, dtype=bool)
        self._graph: Any = None

    def prepare(self) -> None:
        """Compile what is not in the cache, record the time loop, and remember the initial state."""
        for kernel in self.kernels:
            wp.load_module(kernel.module, device=self.device)
        with wp.ScopedCapture(device=self.device) as capture:
            wp.capture_while(self.state.running, self.step)
        self._graph = capture.graph
        self.save()

    def step(self) -> None:
        """One step of every active run, each by its own dt, not beyond the output time."""
        s, k = self.state, self.kernels
        self._decode(s.active)
        self._over_cells(k.limits, s.active, [s.h, s.v, s.phi, s.mu, s.dbhat], [s.v_f, s.max_speed, s.max_viscosity])
        self._over_runs(k.time_step, [s.params, s.active, s.t, s.t_out, s.max_speed, s.max_viscosity,
                                      s.dt, s.dt_exact, s.budget, s.running])  # fmt: skip
        self._over_cells(k.reconstruct, s.active, [s.h, s.v, s.phi, s.mu, s.v_f, s.dbhat, s.dt],
                         [*s.star, s.Dz, s.iota])  # fmt: skip
        self._over_cells(k.flux, s.active, [s.h, s.v, s.phi, *s.star, s.Dz], s.F)
        self._over_cells(k.update, s.active, [*s.U, *s.F, s.dt], s.W)
        self._over_cells(k.relax, s.active, [s.W[0], s.W[1], s.dt], [s.W[2], s.s])
        self._over_cells(k.diffuse, s.active, [*s.W, s.s, s.iota, s.dt], s.U)
        self._over_runs(k.tick, [s.U[0], s.dt_exact, s.t_out, s.params, s.budget,
                                 s.t, s.steps, s.status, s.active, s.lo, s.hi, s.running])  # fmt: skip

    def start(self, t_out: float) -> None:
        """Set the time that `replay` or `step` is to reach [s], and wake the runs before it."""
        self.state.t_out.fill_(t_out)
        self._wake(self.steps_per_replay)

    def replay(self) -> bool:
        """Steps of all runs until the output time, without a return to Python; True once all are there or ended.

        False if there is more to do: call again. It comes back now and then, so that Python can look at the clock.
        """
        s = self.state
        wp.capture_launch(self._graph)
        if not s.active.numpy().any():
            return True
        self._wake(self.steps_per_replay)
        return False

    def save(self) -> None:
        """Remember the state, as one known to be sound."""
        for live, saved in self._kept():
            wp.copy(saved, live)

    def diverged(self) -> list[int]:
        """Runs that were sound at the last `save` and are not now: non-finite, negative mass, phi outside (0, 1]."""
        bad = (self._bad_cells() >= 0) | (self.state.status.numpy() == DIVERGED)
        return [int(r) for r in np.flatnonzero(bad & ~self._given_up)]

    def rewind(self, r: int) -> tuple[int, int, tuple[float, float, float]]:
        """Take a diverged run back to its last sound step and leave it there, diverged.

        Repeats the steps since the last `save`, which give the same bits, and looks at the state after each. To be
        called when all runs have reached the output time or ended, so that this one alone is woken.

        Returns:
            The step that spoiled the run, the first bad cell (-1 if it is dt that is bad), and U in that cell.
        """
        s = self.state
        self._set_status(r, OK)
        self._copy_run(r, restore=True)
        cell = -1
        while cell < 0 and s.status.numpy()[r] == OK:
            self._copy_run(r, restore=False)
            self._wake(budget=1)
            wp.capture_launch(self._graph)
            cell = int(self._bad_cells()[r])
        step = int(s.steps.numpy()[r])
        U0, U1, U2 = (float(u.numpy()[s.rows[r] + max(cell, 0)]) for u in s.U)
        self._copy_run(r, restore=True)
        self._set_status(r, DIVERGED)
        self._given_up[r] = True
        return step, cell, (U0, U1, U2)

    def profiles(self) -> tuple[list[Array], list[Array], list[Array]]:
        """h [m], v [m/s], phi [-] of each run, shapes (cells,)."""
        s = self.state
        self._decode(s.all_active)
        return s.scatter(s.h), s.scatter(s.v), s.scatter(s.phi)

    def scalars(self) -> dict[str, Array]:
        """The scalars of kernels/inspect.py, each of shape (runs,)."""
        s = self.state
        self._decode(s.all_active)
        self._over_runs(self.kernels.measure, [s.U[0], s.h, s.v, s.bhat, s.left, s.params, s.scalars])
        return dict(zip(SCALARS, s.scalars.numpy().T.copy(), strict=True))

    def _decode(self, active: Any) -> None:
        s, k = self.state, self.kernels
        self._over_cells(k.decode, active, s.U, [s.h, s.v, s.phi_wet])
        self._over_cells(k.friction, active, [s.h, s.v, s.phi_wet], [s.phi, s.mu])
        self._over_runs(k.boundary, [s.params, active, s.h, s.v, s.phi, s.mu])

    def _over_cells(self, kernel: Any, active: Any, inputs: Sequence[Any], outputs: Sequence[Any]) -> None:
        """Launch a kernel over the windows of all runs."""
        s = self.state
        wp.launch(kernel, dim=self.runs * self.chunks * self.lanes, block_dim=self.lanes, device=self.device,
                  inputs=[*inputs, s.params, s.lo, s.hi, active, self.chunks], outputs=[*outputs])  # fmt: skip

    def _over_runs(self, kernel: Any, arguments: Sequence[Any]) -> None:
        """Launch a kernel with a thread a run."""
        wp.launch(kernel, dim=self.runs, inputs=arguments, device=self.device)

    def _wake(self, budget: int) -> None:
        s = self.state
        s.budget.fill_(budget)
        s.running.zero_()
        self._over_runs(self.kernels.start, [s.t, s.t_out, s.status, s.active, s.running])

    def _bad_cells(self) -> Array:
        """First unsound cell of each run, -1 if none."""
        s = self.state
        self._over_runs(self.kernels.check, [*s.U, s.params, s.bad_cell])
        return np.asarray(s.bad_cell.numpy())

    def _kept(self) -> list[tuple[Any, Any]]:
        """What makes up a state: (live, saved) arrays."""
        s = self.state
        return [*zip(s.U, s.saved, strict=True), (s.t, s.saved_t), (s.steps, s.saved_steps)]

    def _set_status(self, r: int, code: int) -> None:
        status = self.state.status.numpy()
        status[r] = code
        self.state.status.assign(status)

    def _copy_run(self, r: int, *, restore: bool) -> None:
        """Save or restore one run."""
        s = self.state
        for live, saved in self._kept():
            first, count = (s.rows[r], s.cells[r]) if live.size == s.size else (r, 1)
            target, source = (live, saved) if restore else (saved, live)
            wp.copy(target, source, first, first, count)
