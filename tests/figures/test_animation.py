"""Animations, on results made by hand."""

from __future__ import annotations

import base64
import gc
import re
import warnings
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pytest
from helpers.collapses import collapse, two_runs
from PIL import Image

from warpgran.analysis.units import Lengths
from warpgran.errors import ResultError
from warpgran.figures import animation
from warpgran.figures.scene import LEGIBLE, Scene
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
    scene = Scene(data, 50, Lengths(1.0, 0.1))
    assert scene.alone is None
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


def test_a_thickness_that_the_slope_dwarfs_has_a_panel_of_its_own() -> None:
    data = collapse()
    data["bed"] = "x", 60.0 * np.exp(-data["x"].values)
    scene = Scene(one_run(data, 0), 50, Lengths(1.0, 0.1))
    assert scene.alone is not None
    scene.show(1)
    box = scene.ax.get_window_extent()
    assert 0.21 * box.height / np.ptp(scene.ax.get_ylim()) < 50 * LEGIBLE
    thickness = np.max([path.get_extents().y1 for path in scene.alone.collections[0].get_paths()])
    assert thickness == pytest.approx(100.0 * float(data["h"][0, 1].max()), rel=0.01)
    assert scene.alone.get_ylim()[1] > 100.0 * float(data["h"].max())
    assert (scene.alone.get_ylabel(), scene.alone.get_xlabel()) == (
        "thickness $h$ (cm)",
        "position along the slope $x$ (m)",
    )


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


def test_a_notebook_shows_it_and_nothing_is_loaded() -> None:
    before = dict(matplotlib.rcParams)
    film = animation.animate(collapse(snapshots=3), dpi=40)
    html = film._repr_html_()
    assert re.findall('alt="([^"]*)"', html) == [f"Animation at t = {t} s" for t in ("0.000", "0.450", "0.900")]
    frames = [Image.open(BytesIO(base64.b64decode(code))) for code in re.findall('base64,([^"]*)', html)]
    assert len({frame.tobytes() for frame in frames}) == 3
    assert not re.search(r"https?:|<link|<script|@import|src=\"(?!data:)", html)
    assert film.to_jshtml() == html
    assert 'data-wait="100"' in film.to_jshtml(fps=10, default_mode="once")
    assert dict(matplotlib.rcParams) == before


@pytest.mark.slow
def test_a_notebook_plays_it(chromium: Any, tmp_path: Path) -> None:
    film = animation.animate(collapse(snapshots=3), dpi=40)
    path = tmp_path / "film.html"
    path.write_text(2 * film.to_jshtml(fps=20, default_mode="once"))  # two in a page do not disturb each other
    tab, asked = chromium.new_page(), list[str]()
    tab.on("request", lambda request: asked.append(request.url))
    tab.goto(path.as_uri())
    first, second = tab.locator("figure").all()
    assert first.locator("img:visible").get_attribute("alt") == "Animation at t = 0.450 s"
    first.get_by_role("slider").press("Home")
    assert first.locator("img:visible").get_attribute("alt") == "Animation at t = 0.000 s"
    first.get_by_role("button", name="Play").press("Enter")
    first.get_by_role("button", name="Pause").wait_for()
    first.get_by_role("button", name="Play").wait_for()  # it ends where the frames do
    assert first.locator("img:visible").get_attribute("alt") == "Animation at t = 0.900 s"
    assert first.get_by_role("slider").get_attribute("aria-valuetext") == "Animation at t = 0.900 s"
    assert second.locator("img:visible").get_attribute("alt") == "Animation at t = 0.450 s"
    assert [url for url in asked if not url.startswith("data:")] == [path.as_uri()]
    tab.close()


def test_a_notebook_shows_a_share_of_very_many_snapshots(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(animation, "MOST_SHOWN", 3)
    film = animation.animate(collapse(cells=8, snapshots=9), dpi=30)
    assert film.to_jshtml().count("<img") == 3
    assert "3 of 9 snapshots" in film.to_jshtml()


def test_axes_are_in_a_unit_that_suits_the_run() -> None:
    small = collapse()
    for name in ("x", "front"):
        small[name] = 0.01 * small[name]
    film = animation.animate(small, dpi=40)
    film._repr_html_()
    (ax, _) = film.figure.axes
    assert ax.get_xlabel() == "horizontal position (mm)"
    assert -10.0 < ax.get_xlim()[0] < -1.0
