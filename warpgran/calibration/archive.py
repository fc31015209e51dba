"""Arrays kept in a file of NumPy's, which a disk may spoil: what is read is what was written, or nothing."""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import Any

import numpy as np

from warpgran.arrays import Array
from warpgran.files import StorageError, replacing


def write_arrays(path: Path, **arrays: Any) -> None:
    """Write arrays by name, whole or not at all."""
    with replacing(path) as part, part.open("wb") as file:
        np.savez(file, **arrays)


def read_arrays(path: Path, *names: str) -> list[Array]:
    """Read arrays that `write_arrays` has written.

    Raises:
        StorageError: One is missing, or bytes are not what was written.
    """
    try:
        with path.open("rb") as file:
            with zipfile.ZipFile(file) as archive:  # NumPy reads as many numbers as an array says it has, which may be
                spoiled = archive.testzip()  # fewer than there are, and then compares no checksum
            if spoiled is None:
                file.seek(0)
                with np.load(file, allow_pickle=False) as kept:
                    return [kept[name] for name in names]
    except Exception as error:  # whatever NumPy and zipfile make of bytes that a disk has spoiled
        raise StorageError(f"cannot read {path}: it is damaged ({' '.join(str(error).split())})") from error
    raise StorageError(f"cannot read {path}: {spoiled} is damaged")
