"""Options of a computation: device, precision, engine, threads, memory."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Literal

from warpgran.errors import OptionError

Precision = Literal["float64", "float32"]
EngineName = Literal["warp", "numpy"]
DECISIVE = ("precision", "engine")
"""Options on which the bits of a result depend, as they do on the kind of device; a resumed file must share them."""

MOST_THREADS = 4096
MOST_MEMORY = 1e18
"""Bytes."""


@dataclass(frozen=True)
class Options:
    """How to compute: the options that `warpgran run`, `simulate` and `converge` share.

    Attributes:
        device: "cpu", "cuda", "cuda:N", or several of a kind with commas between, which share the blocks.
        precision: "float64" or "float32".
        engine: "warp", or "numpy" for the reference implementation.
        threads: Blocks computed at once; all cores by default. A GPU has one.
        memory: Bytes for the runs being computed; a quarter of the machine's, or of the GPUs', by default.
    """

    device: str = "cpu"
    precision: Precision = "float64"
    engine: EngineName = "warp"
    threads: int | None = None
    memory: float | None = None

    def __post_init__(self) -> None:
        if self.precision not in ("float64", "float32"):
            raise OptionError(f"precision: {self.precision!r} is not known; allowed: float64, float32")
        if self.engine not in ("warp", "numpy"):
            raise OptionError(f"engine: {self.engine!r} is not known; allowed: warp, numpy")
        if self.engine == "numpy" and (self.device, self.precision) != ("cpu", "float64"):
            raise OptionError("engine: numpy computes on the cpu in float64 alone")
        if self.threads is not None and not 1 <= self.threads <= MOST_THREADS:
            raise OptionError(f"threads: {self.threads} is out of range; allowed: 1 to {MOST_THREADS}")
        if self.memory is not None and not 0 < self.memory < MOST_MEMORY:
            raise OptionError(f"memory: {self.memory:g} is out of range; allowed: > 0 and < {MOST_MEMORY:g} bytes")

    @property
    def devices(self) -> tuple[str, ...]:
        """Names of the devices."""
        return tuple(name.strip() for name in self.device.split(","))

    @property
    def workers(self) -> int:
        """Threads to use. By default all cores, but one for each GPU, whose blocks fill it, and for the reference."""
        if self.threads is not None:
            return self.threads
        return (os.cpu_count() or 1) if self.engine == "warp" and self.device == "cpu" else len(self.devices)

    @property
    def bytes(self) -> float:
        """Memory to use."""
        if self.memory is not None:
            return self.memory
        from warpgran.solve.device import memory_of

        different = set(self.devices)
        return min(map(memory_of, different)) * len(different) / 4
