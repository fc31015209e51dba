"""The scheme over a block of runs: which kernels are launched, in the order of the paper."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from typing import Any

import warp as wp

from warpgran.case.case import Case
from warpgran.kernels.build import build
from warpgran.kernels.precision import Variant, precision
from warpgran.solve.device import free_memory_of
from warpgran.solve.schedule import Outputs
from warpgran.solve.state import State, bytes_of_run, padded_cells
from warpgran.solve.variant import variant_of

LANES = 256
"""Threads of a block of a GPU."""
CHUNK = 1024
"""Cells that such a block walks."""
REPLAY = 20_000_000
"""Cell-steps between two returns to Python: a fraction of a second, so that an interruption is noticed; 100 times as
many on a GPU."""
MOST_STEPS = 20_000
"""Steps between two returns, since the steps of a few small runs take some 20 microseconds at least on a GPU."""


_calls = threading.RLock()
"""Held while Warp is called. While one thread records a graph, calls of all others would be recorded in it too; replays
alone run side by side."""


class Solver:
    """Room for a block of runs of one variant on one device, and the time loop over them.

    Each run goes through the output times at its own pace and is retired when it reaches the last, comes to rest,
    diverges or is out of steps.
    """

    def __init__(
        self,
        runs: int,
        padded: int,
        variant: Variant,
        outputs: Outputs,
        device: str = "cpu",
        *,
        lanes: int | None = None,
        chunk: int = CHUNK,
    ) -> None:
        """Allocate, compile what is not in the cache, and record the time loop.

        Args:
            runs: How many there is room for.
            padded: Elements of the longest row, `state.padded_cells` of its cells.
            variant: What is compiled in; `variant_of` tells it of a case.
            outputs: When the runs are recorded.
            device: A Warp device, "cpu" or "cuda:N".
            lanes: Threads that walk a chunk of a run's cells side by side; one on the CPU by default, LANES on a GPU.
                More than one on the CPU is for tests, and needs `wp.config.enable_cpu_blocks`.
            chunk: Cells of a chunk, where there are lanes.

        Raises:
            ValueError: The device has no such lanes.
            MemoryError: The device has no room for so many runs; the message says for how many.
        """
        self.device = wp.get_device(device)
        self.lanes = lanes or (1 if self.device.is_cpu else LANES)
        if self.device.is_cpu and self.lanes > 1 and not wp.config.enable_cpu_blocks:
            raise ValueError(f"lanes: {self.lanes} on the cpu; allowed: 1, unless wp.config.enable_cpu_blocks is set")
        self.chunks = 1 if self.lanes == 1 else -(-padded // chunk)
        many = REPLAY if self.device.is_cpu else 100 * REPLAY
        self.steps_per_replay = min(max(100, many // (runs * padded)), MOST_STEPS)
        with _calls:
            self.kernels = build(variant, many_lanes=self.lanes > 1)
            free = free_memory_of(str(self.device))
            try:
                self.state = State(runs, padded, outputs, precision(variant.precision), self.device)
            except RuntimeError as error:  # Warp's, of memory that it does not get
                size = bytes_of_run(padded - 1, outputs, variant.precision)
                message = f"{self.device}: no room for {runs} runs of {padded - 1} cells, {runs * size / 2**30:.2g} GiB"
                fit = f"{free / 2**30:.2g} GiB are free, enough for {free // size:.0f}"
                raise MemoryError(f"{message}; {fit}: give less to a block by --memory") from error
            for kernel in filter(None, self.kernels):
                wp.load_module(kernel.module, device=self.device, block_dim=self.lanes)
            with wp.ScopedCapture(device=self.device) as capture:
                wp.capture_while(self.state.running, self.step)
        self._graph = capture.graph

    @classmethod
    def holding(cls, cases: Sequence[Case], *, precision_name: str = "float64", device: str = "cpu") -> Solver:
        """A solver loaded with cases of one variant, recorded as the first asks."""
        padded = padded_cells(max(case.grid.cells for case in cases))
        solver = cls(len(cases), padded, variant_of(cases[0], precision_name), Outputs.of(cases[0]), device)
        solver.load(cases)
        return solver

    def load(self, cases: Sequence[Case]) -> None:
        """Start anew with other runs, of the same variant."""
        with _calls:
            self.state.load(cases)

    def step(self) -> None:
        """One step of every active run, each by its own dt and not beyond its next output time."""
        s, k = self.state, self.kernels
        self._over_cells(k.decode, s.U, [s.h, s.v, s.phi_wet, s.mu, s.per_mass, s.celerity])
        self._wrap(s.phi_wet)
        self._over_cells(k.fill, [s.phi_wet], [s.phi, s.mu])
        self._over_runs(k.boundary, [s.params, s.active, s.h, s.v, s.phi, s.mu, s.per_mass, s.celerity])
        self._over_runs(k.record, [*s.U, s.h, s.v, s.phi, s.bhat, s.lo, s.hi, s.left, s.params, s.steps, s.snapshot_at,
                                   s.sample_at, s.outputs.snapshots, s.outputs.samples, s.padded, s.due,
                                   s.active, s.status, s.bad_cell, s.output, s.speed, s.scalars, *s.snapshots],
                        self.lanes)  # fmt: skip
        self._over_cells(k.limits, [s.h, s.v, s.phi, s.mu, s.celerity, s.dbhat],
                         [s.v_f, s.X, s.max_speed, s.max_viscosity])  # fmt: skip
        self._over_runs(k.time_step, [s.params, s.active, s.t, s.times, s.output, s.max_speed, s.max_viscosity,
                                      s.dt, s.dt_exact, s.budget, s.running])  # fmt: skip
        self._over_cells(k.reconstruct, [s.h, s.v, s.phi, s.mu, s.per_mass, s.v_f, s.X, s.dbhat, s.dt],
                         [s.h_star, s.phi_star, s.Dz, s.iota])  # fmt: skip
        self._over_cells(k.flux, [s.h, s.v, s.phi, s.celerity, s.h_star, s.phi_star, s.Dz], s.F)
        self._over_cells(k.update, [*s.U, *s.F, s.dt], s.W)
        self._over_cells(k.relax, [s.W[0], s.W[1], s.dt], [s.W[2], s.s])
        self._wrap(*s.W, s.s)
        self._over_cells(k.diffuse, [*s.W, s.s, s.iota, s.dt], s.U)
        self._over_runs(k.tick, [s.U[0], s.dt_exact, s.times, s.output, s.params, s.budget, s.t, s.steps, s.status,
                                 s.active, s.due, s.lo, s.hi, s.running])  # fmt: skip

    def replay(self, budget: int | None = None) -> bool:
        """Steps until every run has ended, without a return to Python; True once that is so.

        False if there is more to do, after `budget` steps, so that Python can look at the clock: call again.
        """
        s = self.state
        with _calls:
            s.budget.fill_(self.steps_per_replay if budget is None else budget)
            s.running.zero_()
            self._over_runs(self.kernels.start, [s.active, s.running])
        wp.capture_launch(self._graph)
        wp.synchronize_device(self.device)  # a GPU is waited for here, so that others may call Warp meanwhile
        with _calls:
            return not s.active.numpy().any()

    def _wrap(self, *arrays: Any) -> None:
        """Set the ghost cells of periodic runs."""
        for array in arrays if self.kernels.wrap else ():
            self._over_runs(self.kernels.wrap, [self.state.params, self.state.active, array])

    def _over_cells(self, kernel: Any, inputs: Sequence[Any], outputs: Sequence[Any]) -> None:
        """Launch a kernel over the windows of all runs."""
        s = self.state
        self._launch(kernel, s.runs * self.chunks * self.lanes,
                     [*inputs, s.params, s.lo, s.hi, s.active, self.chunks, *outputs])  # fmt: skip

    def _over_runs(self, kernel: Any, arguments: Sequence[Any], lanes: int = 1) -> None:
        """Launch a kernel with a thread, or a block of lanes, a run."""
        self._launch(kernel, self.state.runs * lanes, arguments)

    def _launch(self, kernel: Any, threads: int, arguments: Sequence[Any]) -> None:
        wp.launch(kernel, dim=threads, inputs=arguments, device=self.device, block_dim=self.lanes)
