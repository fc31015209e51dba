"""The seal of a file: a checksum of everything in it that may not change, which is read without HDF5.

In a part file that is all but what runs write; a calibration seals the whole of its finished files.

HDF5 believes a structure that a disk has spoiled, and may follow it for minutes; so the seal is checked before. It
stands behind the end of the file that HDF5 knows, where HDF5 neither reads nor writes: beginning and end of each range
of bytes that runs write, the number of ranges, the checksum of all other bytes, and a mark.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from hashlib import blake2b
from pathlib import Path

import numpy as np

from warpgran.arrays import Array
from warpgran.files import StorageError

_MARK = b"\nsealed\n"
_WORD, _PIECE = np.dtype("<u8"), 2**20


def seal(path: Path, ranges: Sequence[tuple[int, int]]) -> None:
    """Append the seal; ranges: in increasing order, the bytes that may change hereafter."""
    foot = np.array([*ranges, (len(ranges), 0)], dtype=_WORD).tobytes()[: -_WORD.itemsize]
    with path.open("r+b") as file:
        file.seek(0, os.SEEK_END)
        file.write(foot)
        file.flush()
        file.write(_checksum(file.fileno(), ranges, file.tell()) + _MARK)


def sealed(path: Path) -> bool:
    """Whether a file has a seal, broken or not."""
    with path.open("rb") as file:
        file.seek(max(0, path.stat().st_size - len(_MARK)))
        return file.read() == _MARK


def check_seal(path: Path) -> None:
    """Check the seal of a file that has one; a file named as a part file must have one.

    Raises:
        StorageError: It is not what was sealed, or cannot be read.
    """
    try:
        with path.open("rb") as file:
            good = _whole(file.fileno(), needed=path.suffix == ".part")
    except OSError as error:
        raise StorageError(f"cannot read {path}: {error.strerror}") from None
    if not good:
        raise StorageError(f"cannot read {path}: it is damaged")


def _whole(fd: int, needed: bool) -> bool:
    end = os.fstat(fd).st_size - len(_MARK) - _WORD.itemsize  # of what the checksum covers
    if end < _WORD.itemsize or os.pread(fd, len(_MARK), end + _WORD.itemsize) != _MARK:
        return not needed
    count = int(_words(fd, end - _WORD.itemsize, 1)[0])
    begin = end - _WORD.itemsize * (1 + 2 * count)
    if begin < 0:
        return False
    bounds = _words(fd, begin, 2 * count)
    if (np.diff(bounds.astype(np.int64)) < 0).any() or (bounds > begin).any():
        return False
    ranges = [(int(a), int(b)) for a, b in bounds.reshape(-1, 2)]
    return _checksum(fd, ranges, end) == os.pread(fd, _WORD.itemsize, end)


def _words(fd: int, offset: int, count: int) -> Array:
    return np.frombuffer(os.pread(fd, count * _WORD.itemsize, offset), dtype=_WORD)


def _checksum(fd: int, ranges: Sequence[tuple[int, int]], size: int) -> bytes:
    """The checksum of the first bytes of a file but for those in the ranges."""
    total, at = blake2b(digest_size=_WORD.itemsize), 0
    for begin, end in [*ranges, (size, size)]:
        while at < begin and (piece := os.pread(fd, min(_PIECE, begin - at), at)):
            total.update(piece)
            at += len(piece)
        at = max(at, end)
    return total.digest()
