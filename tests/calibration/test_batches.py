"""Batches that are kept: what is computed again, and what is not."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from warpgran.calibration.batches import Batches
from warpgran.files import StorageError


class Counting:
    """Twice the points, and how many were asked for."""

    def __init__(self) -> None:
        self.points = 0

    def __call__(self, theta: np.ndarray) -> np.ndarray:
        """NaN for what is over 5."""
        self.points += len(theta)
        return np.where(theta > 5.0, np.nan, 2.0 * theta)


def test_points_are_computed_once_also_by_another_process(tmp_path: Path) -> None:
    count = Counting()
    theta = np.arange(8.0).reshape(4, 2)
    first = Batches(count, tmp_path / "runs", "a")(theta)
    assert count.points == 4
    again = Batches(count, tmp_path / "runs", "a")
    assert np.array_equal(again(theta[::-1]), first[::-1], equal_nan=True)
    assert count.points == 4
    again(np.concatenate([theta, theta + 1.0]))
    assert count.points == 8


def test_what_is_of_another_identity_is_computed_anew(tmp_path: Path) -> None:
    count = Counting()
    theta = np.ones((2, 1))
    Batches(count, tmp_path / "runs", "a")(theta)
    Batches(count, tmp_path / "runs", "b")(theta)
    assert count.points == 4
    assert len([*(tmp_path / "runs").glob("*.npz")]) == 1


def test_a_part_that_a_kill_has_left_is_no_batch(tmp_path: Path) -> None:
    count = Counting()
    Batches(count, tmp_path / "runs", "a")(np.ones((2, 1)))
    (whole,) = (tmp_path / "runs").glob("*.npz")
    (tmp_path / "runs" / f".{whole.stem}.0123.npz").write_bytes(whole.read_bytes()[:50])
    Batches(count, tmp_path / "runs", "a")(np.ones((2, 1)))
    assert count.points == 2


@pytest.mark.parametrize(
    "spoil",
    [
        lambda data: data[:200],
        lambda data: data[:300] + bytes(64) + data[364:],
        lambda data: data.replace(b"(20, 2)", b"(10, 2)", 1),  # so that NumPy would not read to the checksum
    ],
)
def test_a_batch_that_a_disk_has_spoiled_is_computed_again(tmp_path: Path, spoil: Callable[[bytes], bytes]) -> None:
    count = Counting()
    theta = np.linspace(0.1, 0.9, 40).reshape(20, 2)
    first = Batches(count, tmp_path / "runs", "a")(theta)
    (kept,) = (tmp_path / "runs").glob("*.npz")
    sound = kept.read_bytes()
    kept.write_bytes(spoil(sound))
    assert np.array_equal(Batches(count, tmp_path / "runs", "a")(theta), first)
    assert count.points == 40
    assert kept.read_bytes() == sound
    (tmp_path / "runs" / "identity.txt").write_bytes(b"\xff")
    Batches(count, tmp_path / "runs", "a")(theta)
    assert count.points == 60


def test_a_folder_of_something_else_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "0.npz").write_text("mine")
    with pytest.raises(StorageError, match="it holds files of something else; move them"):
        Batches(Counting(), tmp_path, "a")
    assert (tmp_path / "0.npz").read_text() == "mine"
