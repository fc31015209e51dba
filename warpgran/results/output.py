"""Where a result may be written: a name that suits one, over nothing that a study reads."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from warpgran.files import StorageError, check_place, target_of

OTHERS = {
    "a picture": (".png", ".pdf", ".svg", ".svgz", ".eps", ".ps", ".jpg", ".jpeg", ".tif", ".tiff", ".webp"),
    "an animation": (".gif", ".mp4"),
    "a page": (".html",),
    "a run file": (".toml",),
    "a table": (".csv",),
}
"""Suffixes of what stands beside a result."""


def result_path(path: Path, inputs: Iterable[Path] = ()) -> Path:
    """The file to write a result to, which a symbolic link may lead to.

    Args:
        path: As it was named.
        inputs: Files that are read to compute it.

    Raises:
        StorageError: It has the suffix of something else, is one of the inputs or no regular file, or its folder is
            missing.
    """
    check_place(path)
    target = target_of(path)
    for what, suffixes in OTHERS.items():
        if target.suffix.lower() in suffixes:
            raise StorageError(f"cannot write {path}: {target.suffix} is {what}; allowed: a name such as out.h5")
    for file in inputs:
        if target.exists() and file.exists() and target.samefile(file):
            raise StorageError(f"cannot write {path}: it is read to compute the result")
    return target
