"""Memory that a cell-step moves and arithmetic that it does, counted from the kernels.

Arrays are counted in the source of each kernel, instructions in the code that the CUDA compiler makes of its loop over
cells; neither needs a GPU.
"""

from __future__ import annotations

import ast
import inspect
import re
import tempfile
import textwrap
from dataclasses import astuple, dataclass, fields
from pathlib import Path
from typing import Any

import warp as wp
from parts.stages import numbered

from warpgran.kernels.build import build
from warpgran.kernels.precision import Variant
from warpgran.kernels.stages import Over

ARCH = 90


@dataclass(frozen=True)
class Count:
    """Counts per cell and step.

    Attributes:
        read, written: Arrays.
        fma, other: Multiply-adds; single additions and multiplications, of which the assembler may still fuse some.
        divisions, roots: Divisions and reciprocals; square roots.
        choices: Minima, maxima, comparisons and selections of numbers.
        integer: All the rest, most of it the arithmetic of addresses.
    """

    read: int
    written: int
    fma: int
    other: int
    divisions: int
    roots: int
    choices: int
    integer: int

    def bytes(self, precision: str) -> int:
        """What is moved if every array is read or written once and nothing stays in a cache between two kernels."""
        return (self.read + self.written) * (8 if precision == "float64" else 4)


def counts(variant: Variant) -> dict[str, Count]:
    """The count of each launch that visits cells at every step, in their order."""
    stages = [stage for stage in build(variant, many_lanes=True).step if stage.over is Over.CELLS]
    kernels = [stage.kernel for stage in stages if "active" in inspect.signature(stage.kernel.func).parameters]
    code = _ptx(kernels[0].module)
    names = numbered(kernel.func.__name__ for kernel in kernels)
    return {name: _count(kernel, code) for name, kernel in zip(names, kernels, strict=True)}


def total(found: dict[str, Count]) -> Count:
    """The counts of a whole step."""
    return Count(*(sum(column) for column in zip(*map(astuple, found.values()), strict=True)))


def table(found: dict[str, Count]) -> str:
    """The counts, a row a kernel."""
    names = [field.name for field in fields(Count)]
    lines = [f"{'':12s}" + "".join(f"{name:>10s}" for name in names)]
    for kernel, count in {**found, "sum": total(found)}.items():
        lines.append(f"{kernel:12s}" + "".join(f"{value:10d}" for value in astuple(count)))
    return "\n".join(lines)


def _count(kernel: Any, code: str) -> Count:
    read, written = _arrays(kernel)
    body = _loop(code, kernel)
    numbers = [line for line in body if re.search(r"\.f(32|64)\b", line)]

    def how_many(pattern: str) -> int:
        return sum(1 for line in numbers if re.match(pattern, line))

    moves = sum(1 for line in body if re.match(r"(ld|st|mov)\.", line))
    fma, other = how_many(r"fma\."), how_many(r"(add|sub|mul)\.")
    divisions, roots = how_many(r"(div|rcp)\."), how_many(r"sqrt\.")
    choices = how_many(r"(min|max|setp|selp|abs|neg)\.")
    integer = len(body) - moves - (fma + other + divisions + roots + choices)
    return Count(len(read), len(written), fma, other, divisions, roots, choices, integer)


def _arrays(kernel: Any) -> tuple[set[str], set[str]]:
    """Arrays of cells that a kernel reads and writes; those that it indexes by the run alone are not of cells."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(kernel.func)))
    read: set[str] = set()
    written: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Subscript) and isinstance(node.value, ast.Name) and ast.unparse(node.slice) != "run":
            (written if isinstance(node.ctx, ast.Store) else read).add(node.value.id)
    return read, written


def _ptx(module: Any) -> str:
    with tempfile.TemporaryDirectory() as folder:
        (path,) = wp.compile_aot_module(module, arch=ARCH, use_ptx=True, module_dir=folder)
        return Path(path).read_text(encoding="utf-8", errors="replace")


def _loop(code: str, kernel: Any) -> list[str]:
    """The instructions of the loop over cells: the shortest that stores a number."""
    start = code.index(f"{kernel.get_mangled_name()}_cuda_kernel_forward(")
    lines = [line.strip() for line in code[start : code.index("\n}", start)].splitlines()]
    labels = {line[:-1]: n for n, line in enumerate(lines) if line.startswith("$") and line.endswith(":")}
    loops = []
    for n, line in enumerate(lines):
        target = re.search(r"bra(?:\.uni)?\s+(\S+);", line)
        if target and labels[target[1]] < n:
            loops.append(lines[labels[target[1]] + 1 : n + 1])
    shortest = min((loop for loop in loops if any(re.match(r"st\.global\.f", line) for line in loop)), key=len)
    return [re.sub(r"^@!?%p\d+\s+", "", line) for line in shortest if line and not line.startswith(("$", "//", "."))]
