"""Files: only regular ones are read, and they are written completely or not at all, over nothing that is not ours."""

from __future__ import annotations

import errno
import os
import stat
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from warpgran.errors import WarpgranError

MOST_TEXT = 10**9
"""Most bytes of a text file that is read."""
MARK = b"warpgran"
"""Stands near the beginning or the end of every picture, animation and page that warpgran writes."""
_ENDS = 2**16
"""Bytes of the beginning and the end of a file in which its mark is looked for."""
_KINDS = {stat.S_IFIFO: "a FIFO", stat.S_IFCHR: "a device", stat.S_IFBLK: "a device", stat.S_IFSOCK: "a socket"}


class StorageError(WarpgranError):
    """A file cannot be written or read; the message names it and says why."""


def read_text(path: str | os.PathLike[str]) -> str:
    """The text of a regular file, with plain line ends and without a byte order mark.

    Raises:
        OSError: It cannot be read, is no regular file, or has more than MOST_TEXT bytes.
        UnicodeDecodeError: It is not UTF-8.
    """
    if what := _special(os.stat(path).st_mode):
        raise OSError(errno.EINVAL, f"it is {what}, not a file", path)
    with open(path, "rb") as file:
        data = file.read(MOST_TEXT + 1)
    if len(data) > MOST_TEXT:
        raise OSError(errno.EFBIG, "it has more than 1 GB, the most of text that is read", path)
    return data.decode("utf-8-sig").replace("\r\n", "\n").replace("\r", "\n")


def check_readable(path: Path) -> None:
    """Check that a path leads to a regular file.

    Raises:
        StorageError: It does not.
    """
    try:
        what = _special(path.stat().st_mode)
    except FileNotFoundError:
        raise StorageError(f"cannot read {path}: there is no such file") from None
    except (OSError, ValueError) as error:  # ValueError: a null character in the name
        raise StorageError(f"cannot read {path}: {getattr(error, 'strerror', None) or error}") from None
    if what:
        raise StorageError(f"cannot read {path}: it is {what}, not a file")


@contextmanager
def replacing(path: Path, part: Path | None = None, *, ours: bytes | None = None) -> Iterator[Path]:
    """A temporary file beside `path` that replaces it when the block ends, and is removed if the block fails.

    A symbolic link stays, and what it leads to is replaced.

    Args:
        path: The file to write.
        part: The temporary file, by default of a unique name. A killed process leaves it behind.
        ours: What a file at `path` must hold near its beginning or end to be replaced, such as MARK; None: anything is.

    Raises:
        StorageError: The folder is missing or not writable, `path` is no regular file or not ours, or the disk is full.
    """
    target = target_of(path)
    part = part or target.with_name(
        f".{target.stem}.{uuid.uuid4().hex[:8]}{target.suffix}"
    )  # writers choose the format by the suffix
    check_writable(path, part)
    try:
        if ours is not None:
            check_ours(path, ours)
        yield part
        os.replace(part, target)
    except OSError as error:  # of a write it knows no name, and the name of the temporary file says nothing
        if error.errno is None or error.filename not in (None, str(part)):
            raise
        raise StorageError(f"cannot write {path}: {error.strerror}") from error
    finally:
        part.unlink(missing_ok=True)


def target_of(path: Path) -> Path:
    """Where a symbolic link leads, so that it is kept; any other path as it is."""
    return Path(os.path.realpath(path)) if path.is_symlink() else path


def check_place(path: Path) -> None:
    """Check that a file may be written at a path: in a folder that is there, over a regular file or none.

    Raises:
        StorageError: There is no such folder, or `path` is a folder, a device or a FIFO.
    """
    try:
        what = _special(path.stat().st_mode)
    except (OSError, ValueError):
        what = ""
    if what:
        raise StorageError(f"cannot write {path}: it is {what}")
    parent = target_of(path).parent
    if not parent.is_dir():
        missing = next(folder for folder in (*reversed(parent.parents), parent) if not folder.is_dir())
        raise StorageError(f"cannot write {path}: there is no folder {missing}")


def check_writable(path: Path, trial: Path) -> None:
    """Check that `path` can be written, by making an empty file `trial` beside it.

    Raises:
        StorageError: The folder is missing or not writable, or `path` is a folder, a device or a FIFO.
    """
    check_place(path)
    try:
        trial.touch()
    except (OSError, ValueError) as error:
        raise StorageError(f"cannot write {path}: {getattr(error, 'strerror', None) or error}") from None


def check_ours(path: Path, mark: bytes = MARK) -> None:
    """Check that what is at a path, if anything is, was written by warpgran.

    Raises:
        StorageError: It was not.
    """
    if not path.is_file():
        return
    with path.open("rb") as file:
        ends = file.read(_ENDS)
        file.seek(max(len(ends), os.fstat(file.fileno()).st_size - _ENDS))
        ends += file.read(_ENDS)
    if ends and mark not in ends:
        raise StorageError(f"cannot write {path}: what is there was not written by warpgran; remove it first")


def _special(mode: int) -> str:
    """What a path leads to, in words, unless it is a regular file."""
    if stat.S_ISREG(mode):
        return ""
    return "a folder" if stat.S_ISDIR(mode) else _KINDS.get(stat.S_IFMT(mode), "a special file")
