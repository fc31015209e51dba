"""The scheme over a block of runs: its stages, launched step after step until every run has ended."""

from __future__ import annotations

import inspect
import threading
from collections.abc import Sequence

import warp as wp

from warpgran.case.case import Case
from warpgran.kernels.build import build
from warpgran.kernels.precision import Variant
from warpgran.kernels.stages import Over, Stage
from warpgran.solve.checkpoint import Checkpoint
from warpgran.solve.device import free_memory_of
from warpgran.solve.schedule import Outputs
from warpgran.solve.state import State, bytes_of_run, padded_cells
from warpgran.solve.variant import variant_of

LANES = 256
"""Threads of a block of a GPU."""
CHUNK = 1024
"""Cells that such a block walks."""
REPLAY = 20_000_000
"""Cell-steps between two returns to Python, a fraction of a second, so that an interruption is noticed; 100 times as
many on a GPU."""
MOST_STEPS = 20_000
"""Steps between two returns, since the steps of a few small runs take some 20 microseconds at least on a GPU."""


calls = threading.RLock()
"""Held while Warp is called. While one thread records a graph, calls of all others would be recorded in it too; replays
alone run side by side."""


class Solver:
    """A block of runs of one variant on one device, and the time loop over them.

    Each run passes the output times at its own pace and is retired when it reaches the last, comes to rest,
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
            runs: Capacity.
            padded: Elements of the longest row, `state.padded_cells` of its cells.
            variant: What is compiled in, see `variant_of`.
            outputs: The output schedule of the runs.
            device: A Warp device, "cpu" or "cuda:N".
            lanes: Threads that walk a chunk of a run's cells side by side; one on the CPU by default, LANES on a GPU.
                More than one on the CPU is for tests, and needs `wp.config.enable_cpu_blocks`.
            chunk: Cells of a chunk, where there are lanes.

        Raises:
            ValueError: The device has no such lanes.
            MemoryError: The device cannot hold so many runs; the message says how many it can.
        """
        self.device = wp.get_device(device)
        self.lanes = lanes or (1 if self.device.is_cpu else LANES)
        if self.device.is_cpu and self.lanes > 1 and not wp.config.enable_cpu_blocks:
            raise ValueError(f"lanes: {self.lanes} on the cpu; allowed: 1, unless wp.config.enable_cpu_blocks is set")
        self._chunk = chunk
        self._finer: dict[tuple[int, int], Solver] = {}
        self.chunks = 1 if self.lanes == 1 else -(-padded // chunk)
        many = REPLAY if self.device.is_cpu else 100 * REPLAY
        self.steps_per_replay = min(max(100, many // (runs * padded)), MOST_STEPS)
        with calls:
            self.stages = build(variant, many_lanes=self.lanes > 1)
            free = free_memory_of(str(self.device))
            try:
                self.state = State(runs, padded, variant, outputs, self.device)
            except RuntimeError as error:  # Warp's, of memory that it does not get
                size = bytes_of_run(padded - 1, outputs, variant)
                message = f"{self.device}: no room for {runs} runs of {padded - 1} cells, {runs * size / 2**30:.2g} GiB"
                fit = f"{free / 2**30:.2g} GiB are free, enough for {free // size:.0f}"
                raise MemoryError(f"{message}; {fit}: give less to a block by --memory") from error
            for kernel in {stage.kernel for stages in self.stages for stage in stages}:
                wp.load_module(kernel.module, device=self.device, block_dim=self.lanes)
            with wp.ScopedCapture(device=self.device) as capture:
                wp.capture_while(self.state.running, self.step)
        self._graph = capture.graph

    @classmethod
    def holding(cls, cases: Sequence[Case], *, precision_name: str = "float64", device: str = "cpu") -> Solver:
        """A solver loaded with cases of one variant, with the output schedule of the first."""
        padded = padded_cells(max(case.grid.cells for case in cases))
        solver = cls(len(cases), padded, variant_of(cases[0], precision_name), Outputs.of(cases[0]), device)
        solver.load(cases)
        return solver

    def load(self, cases: Sequence[Case], checkpoint: Checkpoint | None = None) -> None:
        """Replace the runs by others of the same variant, no more than the capacity, or by one at its checkpoint."""
        with calls:
            self.state.load(cases, checkpoint)
            if checkpoint is None:  # which has what a first step needs
                self.launch(self.stages.load)

    def finer(self, level: int, runs: int) -> Solver:
        """The solver, kept for the next time, of some runs at a time on 2^level times the cells, see solve/start.py."""
        key = level, runs
        if key not in self._finer:
            padded = padded_cells((self.state.padded - 1) << level)
            variant, device = self.state.variant, str(self.device)
            self._finer[key] = Solver(
                runs, padded, variant, Outputs.never(), device, lanes=self.lanes, chunk=self._chunk
            )
        return self._finer[key]

    def find_fastest(self) -> None:
        """Do what a first step needs, for states that were changed after they were loaded."""
        with calls:
            self.state.max_speed.zero_()
            self.launch(self.stages.load)

    def step(self) -> None:
        """One step of every active run, each by its own dt and not beyond its next output time."""
        self.launch(self.stages.step)

    def replay(self, budget: int | None = None) -> bool:
        """Steps until every run has ended, without a return to Python; True once that is so.

        False if runs are left after `budget` steps, so that Python can look at the clock: call again.
        """
        s = self.state
        with calls:
            s.budget.fill_(self.steps_per_replay if budget is None else budget)
            s.running.zero_()
            self.launch(self.stages.start)
        wp.capture_launch(self._graph)
        wp.synchronize_device(self.device)  # a GPU is waited for here, so that others may call Warp meanwhile
        with calls:
            return not s.active.numpy().any()

    def launch(self, stages: Sequence[Stage]) -> None:
        """Launch stages one after another; each argument of a kernel is that of its name."""
        state = self.state
        threads = {
            Over.CELLS: state.runs * self.chunks * self.lanes,
            Over.RUNS: state.runs,
            Over.LANES: state.runs * self.lanes,
        }
        for kernel, over, named in stages:
            names = [named.get(name, name) for name in inspect.signature(kernel.func).parameters]
            arguments = [self.chunks if name == "chunks" else state.argument(name) for name in names]
            wp.launch(kernel, dim=threads[over], inputs=arguments, device=self.device, block_dim=self.lanes)
