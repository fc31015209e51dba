"""The global heaps of an HDF5 file, where texts and the links to dimension scales stand.

HDF5 walks over the objects of a heap by their sizes, without end where a disk has made one of them zero; so the sizes
are checked before it reads any.
"""

from __future__ import annotations

from pathlib import Path

from warpgran.files import StorageError

_MARK = b"GCOL\1\0\0\0"
_HEAD = 16
"""Bytes in front of a heap's objects, and of each object's content: its index first, its size last."""
_SEARCHED = 2**18
"""Bytes of the beginning and of the end of a file that are searched for heaps."""


def check_heaps(path: Path) -> None:
    """Check the heaps at both ends of a file: all of a small one. What is between them in a large one stays unread.

    Raises:
        StorageError: One of them is damaged.
    """
    size = path.stat().st_size
    for begin in sorted({0, max(0, size - _SEARCHED)}):
        with path.open("rb") as file:
            file.seek(begin)
            data = file.read(_SEARCHED)
        at = data.find(_MARK)
        while at >= 0:
            length = int.from_bytes(data[at + 8 : at + _HEAD], "little")
            heap = data[at : at + length]
            if len(heap) == length and not _whole(heap):
                raise StorageError(f"cannot read {path}: it is damaged")
            at = data.find(_MARK, at + 1)


def _whole(heap: bytes) -> bool:
    """Whether the objects of a heap, one after another, fill it; object 0 is what is free, with its own head."""
    at = _HEAD
    while at + _HEAD <= len(heap):
        index, size = int.from_bytes(heap[at : at + 2], "little"), int.from_bytes(heap[at + 8 : at + 16], "little")
        step = _HEAD + (size + 7) // 8 * 8 if index else size
        if step == 0:
            return False
        at += step
    return at <= len(heap)
