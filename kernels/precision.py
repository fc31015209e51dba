"""Scalar types, parameters of a run, memory layout, compile options and variants: what every kernel file imports."""

import functools
from dataclasses import dataclass, fields
from typing import Any, Literal

import warp as wp

BLOCK = 32
"""Ranges of cells start and end at multiples of this: no scalar remainder of a vector loop, so the same bits whatever
the range."""
MARGIN = 16
"""Elements before each row: the left ghost cell, and cell 0 at a cache line's start."""

DRY = 1e-12
"""A cell holding no more solid than this (m) is dry."""

Ints = wp.array(dtype=wp.int32)
Doubles = wp.array(dtype=wp.float64)
"""Per-run arrays that have the same type in both precisions."""

# Gains and the traps of these flags: docs/performance.md. NaN tests are void in modules compiled with FAST, so
# whatever looks for a NaN lives in a module compiled with CAREFUL.
CAREFUL = "-march=native -mllvm=-inline-threshold=9000 -mllvm=-inline-cold-callsite-threshold=3000"
FAST = (
    CAREFUL
    + " -ffp-contract=fast -menable-no-nans -fno-signed-zeros -mprefer-vector-width=512"
    + " -Wno-nan-infinity-disabled"  # Warp's own headers mention NaN
)


@dataclass(frozen=True)
class Precision:
    """The types of one precision.

    Attributes:
        name: "float64" or "float32".
        Real: the Warp scalar.
        Array: wp.array of Real, one dimension.
        RunParams: struct of one run's parameters.
        Params: wp.array of RunParams, shape (runs,).
        tiny: floor under denominators that may vanish; in float64 two of them multiplied do not underflow.
    """

    name: str
    Real: Any
    Array: Any
    RunParams: Any
    Params: Any
    tiny: float


def _run_params(Real: Any) -> Any:
    @wp.struct
    class RunParams:
        cells: wp.int32
        row: wp.int32  # element of cell 0
        longest: wp.int32  # cells + 1 rounded up to BLOCK: the longest range
        step_limit: wp.int32
        dx: Real  # m
        per_dx: Real
        g_c: Real  # g cos(theta), m/s2
        cfl: Real
        mu1: Real
        dmu: Real  # mu2 - mu1
        I0: Real
        d: Real  # grain diameter, m
        K: Real
        K_tilde: Real
        phi_stat: Real
        N: Real  # exponent of f2
        wall: Real  # mu_w/width, 1/m
        h_min: Real  # m
        h_front: Real  # m
        rest_speed: Real  # m/s; negative if a run at rest is not to end
        a: Real  # alpha - 1
        per_a: Real
        per_2a: Real
        per_2alpha_1: Real  # 1/(2 alpha - 1)
        head: Real  # lambda/g_c, s2/m
        xi1: Real
        xi2: Real
        xi3: Real
        xi_max: Real
        v_left: Real  # velocity of the left ghost cell over that of cell 0: -1 wall, 1 open; periodic: not used
        v_right: Real

    return RunParams


@functools.cache
def precision(name: str) -> Precision:
    """The types of `name`, "float64" or "float32"; a struct may be defined only once, hence cached."""
    Real, tiny = {"float64": (wp.float64, 1e-150), "float32": (wp.float32, 1e-36)}[name]
    RunParams = _run_params(Real)
    return Precision(name, Real, wp.array(dtype=Real), RunParams, wp.array(dtype=RunParams), tiny)


@dataclass(frozen=True)
class Variant:
    """What is compiled in: the choices of a case that change code, not numbers.

    No field has a default, so that whoever makes a variant cannot leave out a choice.

    Attributes:
        order: Scheme, by its order.
        precision: Floating-point precision.
        alpha_two: alpha = 2, so that x^(alpha - 1) is x.
        lambda_zero: lambda = 0, so that the head correction vanishes.
        phi_eq: Law of the equilibrium volume fraction; "f2_one" is f2 with N = 1.
        relaxation: Dilatancy step.
        viscosity: Artificial viscosity.
        periodic: Whether the two ends are one interface.
    """

    order: Literal[1, 2]
    precision: Literal["float64", "float32"]
    alpha_two: bool
    lambda_zero: bool
    phi_eq: Literal["f0", "f1", "f2", "f2_one"]
    relaxation: Literal["rational", "exponential"]
    viscosity: Literal["bounded", "paper"]
    periodic: bool

    @property
    def name(self) -> str:
        """A name for the compiled module: every word or number, and the name of every field that is true."""
        values = ((field.name, getattr(self, field.name)) for field in fields(self))
        return "_".join(["warpgran", *(name if value is True else str(value) for name, value in values if value)])


def module(name: str, flags: str) -> Any:
    """The Warp module of that name, compiled with these flags on the CPU."""
    found = wp.get_module(name)
    found.options.update({"cpu_compiler_flags": flags, "enable_backward": False})
    return found
