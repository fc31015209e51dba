"""Animations, on results made by hand."""

from __future__ import annotations

import gc
import warnings
from pathlib import Path

import matplotlib
import numpy as np
import pytest
from helpers.collapses import collapse, two_runs
from PIL import Image

from warpgran.analysis.units import LengthUnit
from warpgran.errors import ResultError
from warpgran.figures import animation
from warpgran.figures.selection import one_run


def test_animation_has_a_frame_for_each_snapshot_that_the_run_reached(tmp_path: Path) -> None:
    path = tmp_path / "collapse.gif"
    animation.animate(two_runs(), path=path, run=1, dpi=40)
    assert [path] == list(tmp_path.iterdir())
    with Image.open(path) as film:
        assert getattr(film, "n_frames", 1) == 8
        assert film.width % 2 == 0
        assert film.height % 2 == 0


def test_scene_tilts_the_slope_and_keeps_its_colours() -> None:
    data = one_run(collapse(), 0)
    scene = animation.Scene(data, 50, LengthUnit("m", 1.0))
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
    with pytest.raises(ValueError, match=r"--set 'time\.snapshots=\{every=0\.015\}' for about 60"):
        animation.animate(collapse(snapshots=1), path=tmp_path / "collapse.gif")
    with pytest.raises(ValueError, match=r"\.gif, \.mp4"):
        animation.animate(collapse(), path=tmp_path / "collapse.avi")
    endless = collapse()
    endless["h"][0, 0, 5] = np.inf
    with pytest.raises(ResultError, match=r"run 0 cannot be drawn: it is .* m wide or high"):
        animation.animate(endless, path=tmp_path / "collapse.gif")
    monkeypatch.setattr("matplotlib.animation.FFMpegWriter.isAvailable", lambda: False)
    with pytest.raises(ValueError, match=r"install it, or choose a name that ends in \.gif"):
        animation.animate(collapse(), path=tmp_path / "collapse.mp4")
    assert not list(tmp_path.iterdir())


def test_an_animation_takes_about_five_seconds_and_says_how_to_get_more_frames(tmp_path: Path) -> None:
    for snapshots, milliseconds in ((4, 1000), (12, 500)):
        path = tmp_path / f"{snapshots}.gif"
        film = animation.animate(collapse(snapshots=snapshots), path=path, dpi=30)
        assert "--set 'time.snapshots={every=0.015}'" in film.advice
        with Image.open(path) as written:
            assert written.info["duration"] == milliseconds
    assert not animation.animate(collapse(cells=8, snapshots=20), path=tmp_path / "20.gif", dpi=30).advice


def test_an_animation_that_is_not_shown_goes_in_silence() -> None:
    with warnings.catch_warnings(record=True, action="always") as caught:
        animation.animate(collapse(snapshots=2), dpi=40)
        gc.collect()
    assert [warning for warning in caught if warning.category is UserWarning] == []  # that of matplotlib


def test_a_notebook_shows_it(tmp_path: Path) -> None:
    before = dict(matplotlib.rcParams)
    html = animation.animate(collapse(snapshots=3), dpi=40)._repr_html_()
    assert html.count("data:image/png;base64,") == 3
    assert dict(matplotlib.rcParams) == before


def test_axes_are_in_a_unit_that_suits_the_run() -> None:
    small = collapse()
    for name in ("x", "front"):
        small[name] = 0.01 * small[name]
    film = animation.animate(small, dpi=40)
    film._repr_html_()
    (ax, _) = film.figure.axes
    assert ax.get_xlabel() == "horizontal position (mm)"
    assert -10.0 < ax.get_xlim()[0] < -1.0
