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


def test_a_batch_is_drawn_together_or_one_run_of_it() -> None:
    one = len(wg.plot(collapse()).axes)
    assert one == 8
    for run in (0, 1):
        assert len(wg.plot(two_runs(), run=run).axes) == one + 1  # a bed
    assert len(wg.plot(two_runs()).axes) != one


def test_a_figure_is_given_back_in_our_style_and_written_where_asked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    figure = wg.plot(collapse())
    assert not list(tmp_path.iterdir())
    shown: Any = figure
    assert shown._repr_png_().startswith(b"\x89PNG")  # what a notebook shows
    figure.savefig("saved.svg", metadata={"Date": None})
    assert "<text" in Path("saved.svg").read_text()  # text, as our style has it, and not matplotlib's outlines
    assert wg.plot(collapse(), path="page.png").axes
    with Image.open("page.png") as picture:
        assert picture.width == pytest.approx(180 / 25.4 * 200, abs=1)


@pytest.mark.slow
@BOTH
@pytest.mark.parametrize("suffix", [".png", ".pdf", ".svg"])
def test_nothing_but_the_picture_is_written(data: xr.Dataset, suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"page{suffix}"
    wg.plot(data, path=path)
    assert [path] == list(tmp_path.iterdir())
    assert path.stat().st_size > 10_000


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
        wg.plot(data, path=tmp_path / name, run=run)
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
        wg.plot(data, path=path)
    assert path.read_text() == "old warpgran"
    assert [path] == list(tmp_path.iterdir())


def test_drawing_leaves_matplotlib_as_it_was(tmp_path: Path) -> None:
    before = dict(matplotlib.rcParams)
    wg.plot(collapse(), path=tmp_path / "page.png")
    assert dict(matplotlib.rcParams) == before


@pytest.mark.parametrize("suffix", ["png", "pdf", "svg"])
def test_a_full_disk_is_told_with_the_name_of_the_picture(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suffix: str
) -> None:
    def full(path: Path, data: bytes) -> int:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(wg.StorageError, match=rf"cannot write .*/a\.{suffix}: No space left on device"):
        wg.plot(collapse(), path=tmp_path / f"a.{suffix}")
    assert not list(tmp_path.iterdir())
