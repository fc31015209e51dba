"""Files: what is read is a regular file, what is written replaces nothing that is not ours."""

from __future__ import annotations

import errno
import os
from pathlib import Path

import pytest

from warpgran import files
from warpgran.files import MARK, StorageError, check_readable, read_text, replacing


def written(path: Path, text: bytes = b"new", ours: bytes | None = None) -> None:
    with replacing(path, ours=ours) as part:
        part.write_bytes(text)


def test_text_has_plain_line_ends_and_no_byte_order_mark(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"\xef\xbb\xbfa\r\nb\rc")
    assert read_text(tmp_path / "a") == "a\nb\nc"


@pytest.mark.parametrize("path", ["/dev/zero", "/dev/null", "fifo", "."])
def test_only_regular_files_are_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, path: str) -> None:
    monkeypatch.chdir(tmp_path)
    os.mkfifo("fifo")
    with pytest.raises(OSError, match=r"it is a (device|FIFO|folder), not a file"):
        read_text(path)
    with pytest.raises(StorageError, match=r"it is a (device|FIFO|folder), not a file"):
        check_readable(Path(path))
    if path != ".":
        with pytest.raises(StorageError, match=r"cannot write .*: it is a (device|FIFO)"):
            written(Path(path), ours=MARK)


def test_text_of_more_than_a_gigabyte_is_not_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(files, "MOST_TEXT", 3)
    (tmp_path / "a").write_bytes(b"123")
    assert read_text(tmp_path / "a") == "123"
    (tmp_path / "a").write_bytes(b"1234")
    with pytest.raises(OSError, match="more than 1 GB"):
        read_text(tmp_path / "a")


def test_a_symbolic_link_stays(tmp_path: Path) -> None:
    (tmp_path / "there").mkdir()
    for name in ("old", "absent"):
        (tmp_path / name).symlink_to(tmp_path / "there" / name)
    (tmp_path / "there" / "old").write_text("old")
    for name in ("old", "absent"):
        written(tmp_path / name)
        assert (tmp_path / name).is_symlink()
        assert (tmp_path / "there" / name).read_text() == "new"
    assert sorted(path.name for path in (tmp_path / "there").iterdir()) == ["absent", "old"]


def test_what_is_not_ours_is_not_replaced(tmp_path: Path) -> None:
    path = tmp_path / "a.png"
    written(path, b"x" * 10**6 + MARK, ours=MARK)
    written(path, MARK + b"x" * 10**6, ours=MARK)
    written(path, b"of somebody else", ours=MARK)
    with pytest.raises(StorageError, match=r"a\.png: what is there was not written by warpgran; remove it first"):
        written(path, ours=MARK)
    assert [file.read_bytes() for file in tmp_path.iterdir()] == [b"of somebody else"]


def test_the_missing_folder_is_named(tmp_path: Path) -> None:
    with pytest.raises(StorageError, match=rf"cannot write .*: there is no folder {tmp_path}/a$"):
        written(tmp_path / "a" / "b" / "c")


def test_a_full_disk_is_told_with_the_name_of_the_file(tmp_path: Path) -> None:
    with (
        pytest.raises(StorageError, match=r"cannot write .*/a\.png: No space left on device"),
        replacing(tmp_path / "a.png"),
    ):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
