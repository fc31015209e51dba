"""Every kernel compiles for NVIDIA GPUs; this needs none, the compiler comes with Warp."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any, get_args, get_type_hints

import pytest
import warp as wp

from warpgran.case.case import Case
from warpgran.kernels.build import build
from warpgran.kernels.precision import Variant
from warpgran.solve.variant import variant_of

OTHER = {
    "alpha_two": False, "lambda_zero": False, "phi_eq": "f0", "relaxation": "exponential", "viscosity": "paper",
    "periodic": True,
}  # fmt: skip
FIRST, SECOND = {"order": 1}, {"order": 2}
VARIANTS: list[dict[str, Any]] = [
    FIRST,
    {**FIRST, **OTHER},
    SECOND,
    {**SECOND, "alpha_two": False, "phi_eq": "f0", "periodic": True},
    {**FIRST, "phi_eq": "f1"},
    {**FIRST, "alpha_two": False, "phi_eq": "f2"},
    {**SECOND, "phi_eq": "f1"},
    {**SECOND, "phi_eq": "f2"},
]
"""Between them every choice of every option; the first two of each order differ in all that it knows."""
TARGETS = [
    *((arch, precision, n) for arch in (80, 90, 100) for precision in ("float64", "float32") for n in range(4)),
    *((90, "float64" if n % 2 else "float32", n) for n in range(4, 8)),
]
"""Compute capabilities (of an A100, H100 and B200, without their point), precisions, and variants by number. Every
kernel in both precisions for all of them; every choice of a law for one."""


def variant(precision: str, changes: dict[str, Any]) -> Variant:
    return replace(variant_of(Case(), precision), **changes)


def test_the_variants_have_every_choice_of_every_option() -> None:
    made = [variant("float64", changes) for changes in VARIANTS]
    for name, kind in get_type_hints(Variant).items():
        if name != "precision":
            assert {getattr(each, name) for each in made} == set(get_args(kind) or (True, False)), name


@pytest.mark.slow
@pytest.mark.parametrize(("arch", "precision", "number"), TARGETS)
def test_every_kernel_compiles_for_cuda(arch: int, precision: str, number: int, tmp_path: Path) -> None:
    stages = build(variant(precision, VARIANTS[number]), many_lanes=True)
    kernels = [stage.kernel for stage in (*stages.load, *stages.step, *stages.start)]
    if number > 0:  # the kernels over runs are those of all variants
        kernels = [each for each in kernels if each.module is kernels[0].module]
    compiled = b""
    for module in {each.module for each in kernels}:
        for path in wp.compile_aot_module(module, arch=arch, use_ptx=False, module_dir=tmp_path):
            compiled += path.read_bytes()
    for kernel in kernels:
        assert f"{kernel.get_mangled_name()}_cuda_kernel_forward".encode() in compiled
