"""Registers that the kernels take on a GPU, and local memory, read from what the CUDA compiler makes of them."""

from __future__ import annotations

import struct
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import warp as wp
from parts.counts import ARCH

from warpgran.kernels.build import build
from warpgran.kernels.precision import Variant
from warpgran.kernels.stages import Over

INFO = ".nv.info"
SIZED = 4  # the form of its entries that have a size
FRAME_SIZE, REGISTER_COUNT = 0x11, 0x2F  # entries of a function: the number of its symbol, and this


class Most(NamedTuple):
    """Of all kernels over cells: the most registers of a lane, and bytes of its frame in local memory."""

    registers: int
    frame: int


def most(variant: Variant) -> Most:
    """What the kernels over cells of a step take; a frame of 0 bytes means that no register is spilled."""
    modules = {stage.kernel.module for stage in build(variant, many_lanes=True).step if stage.over is Over.CELLS}
    found: list[tuple[int, int]] = []
    with tempfile.TemporaryDirectory() as folder:
        for module in modules:
            (path,) = wp.compile_aot_module(module, arch=ARCH, use_ptx=False, module_dir=folder)
            found += _of_functions(_section(Path(path).read_bytes(), INFO))
    return Most(*(max(number for kind, number in found if kind == asked) for asked in (REGISTER_COUNT, FRAME_SIZE)))


def _section(elf: bytes, wanted: str) -> bytes:
    """Content of a section of an ELF file of 64 bits."""
    (start,) = struct.unpack_from("<Q", elf, 40)
    count, names_at = struct.unpack_from("<HH", elf, 60)
    headers = [struct.unpack_from("<IIQQQQ", elf, start + 64 * n) for n in range(count)]
    for name, _, _, _, offset, size in headers:
        if elf.startswith(wanted.encode() + b"\0", headers[names_at][4] + name):
            return elf[offset : offset + size]
    raise ValueError(f"no section {wanted}")


def _of_functions(info: bytes) -> Iterator[tuple[int, int]]:
    """Kind and number of each entry of a function."""
    at = 0
    while at < len(info):
        form, kind, size = struct.unpack_from("<BBH", info, at)
        if form == SIZED and kind in (FRAME_SIZE, REGISTER_COUNT):
            yield kind, struct.unpack_from("<II", info, at + 4)[1]
        at += 4 + (size if form == SIZED else 0)
