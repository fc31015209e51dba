"""Animations, on results made by hand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from helpers.collapses import collapse, two_runs
from PIL import Image

from warpgran.errors import ResultError
from warpgran.figures import animation
from warpgran.figures.selection import one_run


def test_animation_has_a_frame_for_each_snapshot_that_the_run_reached(tmp_path: Path) -> None:
    path = animation.animate(two_runs(), tmp_path / "collapse.gif", run=1, dpi=40)
    assert [path] == list(tmp_path.iterdir())
    with Image.open(path) as film:
        assert getattr(film, "n_frames", 1) == 8
        assert film.width % 2 == 0
        assert film.height % 2 == 0


def test_scene_tilts_the_slope_and_keeps_its_colours() -> None:
    data = one_run(collapse(), 0)
    scene = animation.Scene(data, 50)
    limits = scene.material.get_clim()
    scene.show(1)
    bottom_left, bottom_right, _, top_left = np.asarray(scene.material.get_paths()[0].vertices)[:4]
    theta, height = np.deg2rad(22.0), 0.042 / 0.5
    np.testing.assert_allclose(bottom_left, [-0.2 * np.cos(theta), 0.2 * np.sin(theta)])
    np.testing.assert_allclose(bottom_right - bottom_left, 0.005 * np.array([np.cos(theta), -np.sin(theta)]))
    np.testing.assert_allclose(top_left - bottom_left, height * np.array([np.sin(theta), np.cos(theta)]), rtol=1e-3)
    assert scene.ax.get_aspect() == 1
    assert scene.ax.get_title(loc="left") == "$t$ = 0.300 s"
    assert len(scene.ax.lines) == 1  # the wall on the left alone
    assert scene.material.get_clim() == limits


def test_animate_refuses_what_it_cannot_draw(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(ValueError, match=r"time\.snapshots = \{ every = 0\.02 \}"):
        animation.animate(collapse(snapshots=1), tmp_path / "collapse.gif")
    with pytest.raises(ValueError, match=r"\.gif, \.mp4"):
        animation.animate(collapse(), tmp_path / "collapse.avi")
    endless = collapse()
    endless["h"][0, 0, 5] = np.inf
    with pytest.raises(ResultError, match=r"run 0 cannot be drawn: it is .* m wide or high"):
        animation.animate(endless, tmp_path / "collapse.gif")
    monkeypatch.setattr("matplotlib.animation.FFMpegWriter.isAvailable", lambda: False)
    with pytest.raises(ValueError, match=r"install it, or choose a name that ends in \.gif"):
        animation.animate(collapse(), tmp_path / "collapse.mp4")
    assert not list(tmp_path.iterdir())
