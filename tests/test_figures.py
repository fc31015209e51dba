"""The figures, on results made by hand: a cap of material that slides and spreads."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure
from PIL import Image

from warpgran import figures

CASE = """
title = "Dense column, 22 degrees"
[rheology]
mu1 = 0.48
mu2 = 0.73
I0 = 0.279
grain_diameter = 7e-4
K = 4.09
K_tilde = 0.2
phi_stat = 0.582
phi_eq = "f2"
phi_eq_N = 1.0
mu_wall = 0.0
channel_width = 0.2
[slope]
angle = 22.0
[column]
height = 0.14
length = 0.2
phi = 0.62
start = -0.2
[grid]
left = -0.2
right = 1.0
cells = 240
[time]
end = 0.9
rest_speed = 1e-3
[scheme]
h_min = 7e-4
h_front = 1e-3
left = "wall"
right = "open"
"""


def collapse(cells: int = 240, snapshots: int = 4, samples: int = 100, runs: int = 1) -> xr.Dataset:
    """A parabolic cap that spreads from 0.2 m to 0.8 m and comes to rest after 0.6 s, in every run alike."""
    x = -0.2 + 1.2 * (np.arange(cells) + 0.5) / cells
    time, series_time = np.linspace(0.0, 0.9, snapshots), np.linspace(0.0, 0.9, samples)

    def length(t: np.ndarray) -> np.ndarray:
        return 0.2 + 0.6 * np.sin(np.pi / 2 * np.clip(t / 0.6, 0, 1)) ** 2

    def speed(t: np.ndarray) -> np.ndarray:
        return 0.6 * np.pi / 1.2 * np.sin(np.pi * np.clip(t / 0.6, 0, 1))

    s = (x + 0.2) / length(time)[:, None]
    phi = np.clip(0.62 - 0.06 * s, 0.5, 0.62)
    h = 0.042 / length(time)[:, None] * np.clip(1 - s**2, 0, None) * 0.62 / phi
    v = np.where(h > 0, speed(time)[:, None] * s, 0.0)
    series = {
        "front": -0.2 + length(series_time),
        "front_speed": speed(series_time),
        "h_max": 0.042 / length(series_time),
        "v_max": speed(series_time),
        "volume_change": 0.05 * (1 - np.exp(-series_time / 0.2)),
        "mass": np.full(samples, 0.017),
        "energy": 1e-3 * np.exp(-series_time),
    }
    variables: dict[str, Any] = {
        "x": ("cell", x),
        "bed": ("cell", np.zeros(cells)),
        "time": ("time", time),
        "series_time": ("sample", series_time),
        "status": ("run", np.full(runs, "ok", dtype=object)),
        "steps": ("run", np.full(runs, 1000)),
        "stop_time": ("run", np.full(runs, 0.6)),
    }
    variables |= {k: (("run", "time", "cell"), np.stack([f] * runs)) for k, f in {"h": h, "v": v, "phi": phi}.items()}
    variables |= {k: (("run", "sample"), np.stack([f] * runs)) for k, f in series.items()}
    return xr.Dataset(variables, attrs={"case_toml": CASE})


def page(data: xr.Dataset, run: int = 0) -> Figure:
    """The page before it is written."""
    return figures._page(figures._one_run(data, run))


def two_runs() -> xr.Dataset:
    """Two runs at 0 and -12.5 degrees on a bump; the second diverged at two thirds."""
    data = collapse(snapshots=12, runs=2)
    data = data.assign_coords({"slope.angle": ("run", [0.0, -12.5]), "column.length": ("run", [0.2, 0.25])})
    data["bed"] = "cell", 0.05 * np.exp(-(((data["x"].values - 0.3) / 0.1) ** 2))
    for name in ("h", "v", "phi"):
        data[name][1, 8:] = np.nan
    for name in ("front", "front_speed", "h_max", "v_max", "volume_change"):
        data[name][1, 66:] = np.nan
    data["status"] = "run", np.array([0, 1]), {"flag_values": np.array([0, 1]), "flag_meanings": "ok diverged"}
    data["stop_time"][1] = np.nan
    return data


def heading(figure: Figure) -> str:
    return figure.get_suptitle()


@pytest.mark.parametrize("suffix", [".png", ".pdf", ".svg"])
def test_plot_writes_only_the_picture(tmp_path: Path, suffix: str) -> None:
    path = figures.plot(collapse(), tmp_path / f"page{suffix}")
    assert [path] == list(tmp_path.iterdir())
    assert path.stat().st_size > 10_000


def test_plot_is_a_page_wide(tmp_path: Path) -> None:
    with Image.open(figures.plot(collapse(), tmp_path / "page.png")) as picture:
        assert picture.width == pytest.approx(180 / 25.4 * 200, abs=1)


def test_page_names_quantities_symbols_and_units() -> None:
    figure = page(collapse())
    labels = [ax.get_ylabel() for ax in figure.axes]
    assert [ax.get_title(loc="left") for ax in figure.axes] == [f"({c})" for c in "aebfcgdh"]
    assert labels[::2] == [panel.label for panel in figures.PROFILES]
    assert labels[1::2] == [panel.label for panel in figures.SERIES]
    assert all("$" in label and label.endswith(")") for label in labels)
    assert [ax.get_xlabel() for ax in figure.axes[-2:]] == ["position along the slope $x$ (m)", "time $t$ (s)"]
    assert heading(figure).splitlines() == [
        "Dense column, 22 degrees",
        r"$\theta$ = $22$°, $\varphi_0$ = $0.62$, $K$ = $4.09$",
    ]


def test_profiles_are_in_the_units_of_their_labels_and_cut_where_thin() -> None:
    data = collapse()
    thickness, speed = page(data).axes[0].lines[1], page(data).axes[2].lines[1]
    x = np.asarray(thickness.get_xdata())
    cells = np.isin(data["x"].values, x)
    h = data["h"].values[0, 1][cells]
    np.testing.assert_allclose(np.asarray(thickness.get_ydata()), 100 * h)
    np.testing.assert_array_equal(np.isnan(np.asarray(speed.get_ydata())), h <= 1e-3)
    assert np.isnan(np.asarray(speed.get_ydata())).any()
    assert 0.6 < x[-1] < 0.65  # the grid goes on to 1.0


def test_speed_prefers_what_leaves_out_the_thinnest_flow() -> None:
    data = collapse()
    data["v_flow"] = 0.5 * data["v_max"]
    np.testing.assert_array_equal(np.asarray(page(data).axes[5].lines[0].get_ydata()), data["v_flow"].values[0])


def test_stop_time_is_marked_where_the_run_stopped() -> None:
    legends = [page(two_runs(), run).axes[-1].get_legend() for run in (0, 1)]
    texts = [[text.get_text() for text in legend.get_texts()] for legend in legends if legend is not None]
    assert "at rest, $t$ = 0.6 s" in texts[0]
    assert not any("at rest" in text for text in texts[1])


def test_page_of_a_diverged_run_says_so_and_shows_what_there_is() -> None:
    figure = page(two_runs(), run=1)
    for fact in ("$-12.5$°", "column.length = 0.25", "run 1 (0 to 1)", "ended early: diverged"):
        assert fact in " ".join(heading(figure).split())
    profiles = [line for line in figure.axes[0].lines if str(line.get_label()).startswith("$t$")]
    assert len(profiles) == figures.MAX_INSTANTS
    assert figure.axes[0].get_ylabel() == "thickness $h$, bed $b$ (cm)"
    assert "diverged" not in heading(page(two_runs(), run=0))


def test_page_says_how_many_snapshots_it_shows() -> None:
    assert "8 of the 12 snapshots" in page(two_runs()).axes[6].texts[0].get_text()
    assert "snapshots" not in page(collapse()).axes[6].texts[0].get_text()
    assert "$h$ > 1 mm" in page(collapse()).axes[6].texts[0].get_text()


@pytest.mark.parametrize(("snapshots", "samples", "label"), [(4, 0, "thickness $h$ (cm)"), (0, 9, "front position")])
def test_page_leaves_out_what_was_not_stored(snapshots: int, samples: int, label: str) -> None:
    figure = page(collapse(snapshots=snapshots, samples=samples))
    assert len(figure.axes) == 4
    assert figure.axes[0].get_ylabel().startswith(label)


def test_one_snapshot_and_one_sample_at_rest_are_drawn(tmp_path: Path) -> None:
    data = collapse(snapshots=1, samples=1)
    figures.plot(data, tmp_path / "page.png")
    assert page(data).axes[5].get_yscale() == "linear"


def test_grids_that_differ_are_drawn_without_their_padding() -> None:
    data = collapse(runs=2)
    x, bed = (np.stack([data[name].values] * 2) for name in ("x", "bed"))
    x[1, 100:] = bed[1, 100:] = np.nan
    data = data.assign(x=(("run", "cell"), x), bed=(("run", "cell"), bed))
    assert figures._one_run(data, 1).sizes["cell"] == 100
    assert len(page(data, 1).axes) == 8


def test_plot_refuses_what_it_cannot_draw(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="nothing to draw"):
        figures.plot(collapse(snapshots=0, samples=0), tmp_path / "page.png")
    with pytest.raises(ValueError, match="no run 1: the result holds 1"):
        figures.plot(collapse(), tmp_path / "page.png", run=1)
    with pytest.raises(ValueError, match=r"\.png, \.pdf, \.svg"):
        figures.plot(collapse(), tmp_path / "page.bmp")
    assert not list(tmp_path.iterdir())


def test_failure_leaves_the_old_file_and_nothing_else(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "page.png"
    path.write_text("old")

    def half(figure: Figure, part: Path, **options: Any) -> None:
        part.write_text("half")
        raise OSError("disk full")

    monkeypatch.setattr(Figure, "savefig", half)
    with pytest.raises(OSError, match="disk full"):
        figures.plot(collapse(), path)
    assert path.read_text() == "old"
    assert [path] == list(tmp_path.iterdir())


def test_drawing_leaves_matplotlib_as_it_was(tmp_path: Path) -> None:
    before = dict(matplotlib.rcParams)
    figures.plot(collapse(), tmp_path / "page.png")
    assert dict(matplotlib.rcParams) == before


def test_animation_has_a_frame_for_each_snapshot_that_the_run_reached(tmp_path: Path) -> None:
    path = figures.animate(two_runs(), tmp_path / "collapse.gif", run=1, dpi=40)
    assert [path] == list(tmp_path.iterdir())
    with Image.open(path) as film:
        assert getattr(film, "n_frames", 1) == 8
        assert film.width % 2 == 0
        assert film.height % 2 == 0


def test_scene_tilts_the_slope_and_keeps_its_colours() -> None:
    data = figures._one_run(collapse(), 0)
    scene = figures.Scene(data, 50)
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
        figures.animate(collapse(snapshots=1), tmp_path / "collapse.gif")
    with pytest.raises(ValueError, match=r"\.gif, \.mp4"):
        figures.animate(collapse(), tmp_path / "collapse.avi")
    monkeypatch.setattr("matplotlib.animation.FFMpegWriter.isAvailable", lambda: False)
    with pytest.raises(ValueError, match=r"install it, or choose a name that ends in \.gif"):
        figures.animate(collapse(), tmp_path / "collapse.mp4")
    assert not list(tmp_path.iterdir())
