"""HDF5 files that are written into space reserved before: on a full disk the HDF5 library ends the whole process."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py
import numpy as np

Reserve = Callable[[int], None]
"""Reserves so many bytes beyond what is in the file; raises an OSError where the disk, or the user's share, is full."""
SLACK = 2**18
"""Bytes of the structure that are reserved beyond what is asked for: headers, attributes, and what awaits writing."""
_CHUNK_ENTRY = 256
"""Bytes that a chunk takes beyond its numbers: its place in the index, and what packing in vain adds."""


@contextmanager
def reserving(path: Path) -> Iterator[tuple[h5py.File, Reserve]]:
    """A new HDF5 file, and what reserves space in it: call it before so much is written. What is left is given back.

    Raises:
        OSError: There is no space, also from the function.
    """
    path.write_bytes(_empty_file())
    descriptor = os.open(path, os.O_RDWR)
    try:
        # Without a cache of chunks each has its place in the file once it is written, and is counted.
        with h5py.File(path, "r+", locking=False, rdcc_nbytes=0) as file:
            reserved = 0

            def reserve(size: int) -> None:
                nonlocal reserved
                wanted = file.id.get_filesize() + size + SLACK
                if wanted > reserved:
                    _allocate(descriptor, reserved, wanted)
                    reserved = wanted

            reserve(0)
            yield file, reserve
            file.flush()
            end = file.id.get_filesize()
        if os.fstat(descriptor).st_size > end:
            os.ftruncate(descriptor, end)
    finally:
        os.close(descriptor)


def bytes_of(data: h5py.Dataset, runs: int) -> int:
    """Most bytes that so many runs of a dataset take in the file."""
    each = data.dtype.itemsize * int(np.prod(data.shape[1:]))
    if data.chunks is None:
        return runs * each
    chunks = int(np.prod([-(-n // chunk) for n, chunk in zip(data.shape[1:], data.chunks[1:], strict=True)]))
    packed = chunks * (data.dtype.itemsize * int(np.prod(data.chunks[1:])) + _CHUNK_ENTRY)
    return -(-runs // data.chunks[0]) * data.chunks[0] * packed


def _allocate(descriptor: int, begin: int, end: int) -> None:
    if hasattr(os, "posix_fallocate"):
        os.posix_fallocate(descriptor, begin, end - begin)
        return
    piece = bytes(2**20)  # macOS has no such call
    for at in range(begin, end, len(piece)):
        os.pwrite(descriptor, piece[: end - at], at)


def _empty_file() -> bytes:
    """The bytes of an HDF5 file without anything in it, made in memory."""
    with h5py.File("empty", "w", driver="core", backing_store=False) as file:
        file.flush()
        return bytes(file.id.get_file_image())
