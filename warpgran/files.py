"""Files that are written completely or not at all."""

from __future__ import annotations

import os
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from warpgran.errors import WarpgranError


class StorageError(WarpgranError):
    """A result file cannot be written or read; the message names it and says why."""


@contextmanager
def replacing(path: Path, part: Path | None = None) -> Iterator[Path]:
    """A temporary file beside `path` that replaces it when the block ends, and is removed if the block fails.

    Args:
        path: The file to write.
        part: The temporary file, by default of a unique name. A killed process leaves it behind.

    Raises:
        StorageError: The folder is missing or not writable, or `path` is a folder.
    """
    part = part or path.with_name(
        f".{path.stem}.{uuid.uuid4().hex[:8]}{path.suffix}"
    )  # writers choose the format by the suffix
    check_writable(path, part)
    try:
        yield part
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)


def check_writable(path: Path, trial: Path) -> None:
    """Check that `path` can be written, by making an empty file `trial`.

    Raises:
        StorageError: The folder is missing or not writable, or `path` is a folder.
    """
    if path.is_dir():
        raise StorageError(f"cannot write {path}: it is a folder")
    try:
        trial.touch()
    except OSError as error:
        raise StorageError(f"cannot write {path}: {error.strerror}") from None
