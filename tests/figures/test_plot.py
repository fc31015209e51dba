"""A figure is of one run or of the batch, and is written whole or not at all."""

from __future__ import annotations

import errno
import os
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib
import pytest
import xarray as xr
from helpers.collapses import batch, collapse, two_runs
from matplotlib.figure import Figure
from PIL import Image

import warpgran as wg

BOTH = pytest.mark.parametrize("data", [collapse(), batch(slope__angle=[0.0, 22.0])], ids=["run", "batch"])


def axes_of(monkeypatch: pytest.MonkeyPatch, *arguments: Any) -> int:
    """How many axes `wg.plot` draws."""
    drawn: list[Figure] = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, *_, **__: drawn.append(figure))
    wg.plot(*arguments)
    return len(drawn[0].axes)


def test_a_batch_is_drawn_together_or_one_run_of_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "page.png"
    one = axes_of(monkeypatch, collapse(), path)
    assert one == 8
    assert axes_of(monkeypatch, two_runs(), path, 1) == axes_of(monkeypatch, two_runs(), path, 0) == one + 1  # a bed
    assert axes_of(monkeypatch, two_runs(), path) != one


@pytest.mark.slow
@BOTH
@pytest.mark.parametrize("suffix", [".png", ".pdf", ".svg"])
def test_nothing_but_the_picture_is_written(data: xr.Dataset, suffix: str, tmp_path: Path) -> None:
    path = wg.plot(data, tmp_path / f"page{suffix}")
    assert [path] == list(tmp_path.iterdir())
    assert path.stat().st_size > 10_000


def test_a_page_is_180_mm_wide(tmp_path: Path) -> None:
    with Image.open(wg.plot(collapse(), tmp_path / "page.png")) as picture:
        assert picture.width == pytest.approx(180 / 25.4 * 200, abs=1)


@pytest.mark.parametrize(
    ("data", "name", "run", "words"),
    [
        (collapse(snapshots=0, samples=0), "page.png", None, "nothing to draw"),
        (batch(samples=0, slope__angle=[0.0, 1.0]), "page.png", None, "nothing to draw"),
        (collapse(), "page.png", 1, "no run 1: the result holds 1"),
        (collapse().isel(run=0), "page.png", None, r"data\.isel\(run=\[0\]\)"),
        (collapse(), "page.bmp", None, r"\.png, \.pdf, \.svg"),
    ],
)
def test_what_cannot_be_drawn_is_refused(
    data: xr.Dataset, name: str, run: int | None, words: str, tmp_path: Path
) -> None:
    with pytest.raises(ValueError, match=words):
        wg.plot(data, tmp_path / name, run)
    assert not list(tmp_path.iterdir())


@BOTH
def test_failure_leaves_the_old_file_and_nothing_else(
    data: xr.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "page.png"
    path.write_text("old warpgran")

    def half(figure: Figure, part: BytesIO, **options: Any) -> None:
        part.write(b"half")
        raise OSError("disk full")

    monkeypatch.setattr(Figure, "savefig", half)
    with pytest.raises(OSError, match="disk full"):
        wg.plot(data, path)
    assert path.read_text() == "old warpgran"
    assert [path] == list(tmp_path.iterdir())


def test_drawing_leaves_matplotlib_as_it_was(tmp_path: Path) -> None:
    before = dict(matplotlib.rcParams)
    wg.plot(collapse(), tmp_path / "page.png")
    assert dict(matplotlib.rcParams) == before


@pytest.mark.parametrize("suffix", ["png", "pdf", "svg"])
def test_a_full_disk_is_told_with_the_name_of_the_picture(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suffix: str
) -> None:
    def full(path: Path, data: bytes) -> int:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(wg.StorageError, match=rf"cannot write .*/a\.{suffix}: No space left on device"):
        wg.plot(collapse(), tmp_path / f"a.{suffix}")
    assert not list(tmp_path.iterdir())
