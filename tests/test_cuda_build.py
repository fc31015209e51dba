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
TARGETS = [(90, VARIANTS), (80, VARIANTS[:2]), (100, VARIANTS[:2])]
"""Compute capabilities (A100, H100, B200, the number without its point) and the variants compiled for each."""


def test_the_variants_have_every_choice_of_every_option() -> None:
    known = {
        "alpha_two": {True, False}, "lambda_zero": {True, False}, "phi_eq": {"f0", "f1", "f2", "f2_one"},
        "relaxation": {"rational", "exponential"}, "viscosity": {"bounded", "paper"},
    }  # fmt: skip
    made = [asdict(Variant(**changes)) for changes in VARIANTS]
    assert {name: {variant[name] for variant in made} for name in made[0] if name != "precision"} == known


@pytest.mark.parametrize("precision", ["float64", "float32"])
@pytest.mark.parametrize(("arch", "changes"), [(arch, changes) for arch, set_ in TARGETS for changes in set_])
def test_every_kernel_compiles_for_cuda(arch: int, changes: dict[str, Any], precision: str, tmp_path: Path) -> None:
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
