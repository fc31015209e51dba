"""Every kernel compiles for NVIDIA GPUs; this needs none, the compiler comes with Warp."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

import pytest
import warp as wp

from warpgran.kernels.build import Kernels, build
from warpgran.kernels.precision import Variant

VARIANTS: list[dict[str, Any]] = [
    {},
    {"alpha_two": False, "lambda_zero": False, "phi_eq": "f0", "relaxation": "exponential", "viscosity": "paper"},
    {"phi_eq": "f1"},
    {"alpha_two": False, "phi_eq": "f2"},
]
"""Between them every choice of every option; the first two differ in all of them."""
TARGETS = [
    *((arch, precision, VARIANTS[0]) for arch in (80, 90, 100) for precision in ("float64", "float32")),
    *((90, precision, VARIANTS[1]) for precision in ("float64", "float32")),
    (90, "float64", VARIANTS[2]),
    (90, "float32", VARIANTS[3]),
]
"""Compute capabilities (of an A100, H100 and B200, without their point), precisions, and variants. Every kernel in both
precisions for all of them; every choice for one."""


def test_the_variants_have_every_choice_of_every_option() -> None:
    known = {
        "alpha_two": {True, False}, "lambda_zero": {True, False}, "phi_eq": {"f0", "f1", "f2", "f2_one"},
        "relaxation": {"rational", "exponential"}, "viscosity": {"bounded", "paper"},
    }  # fmt: skip
    made = [asdict(Variant(**changes)) for changes in VARIANTS]
    assert {name: {variant[name] for variant in made} for name in made[0] if name != "precision"} == known


@pytest.mark.parametrize(("arch", "precision", "changes"), TARGETS)
def test_every_kernel_compiles_for_cuda(arch: int, precision: str, changes: dict[str, Any], tmp_path: Path) -> None:
    kernels = build(Variant(precision, **changes), many_lanes=True)
    modules = {kernel.module for kernel in kernels}
    if changes:  # the kernels over runs are those of all variants
        modules = {kernels.decode.module}
    compiled = b""
    for module in modules:
        for path in wp.compile_aot_module(module, arch=arch, use_ptx=False, module_dir=tmp_path):
            compiled += path.read_bytes()
    for name in Kernels._fields:
        kernel = getattr(kernels, name)
        if kernel.module in modules:
            assert f"{kernel.get_mangled_name()}_cuda_kernel_forward".encode() in compiled, name
