"""The figure of a batch, on results made by hand."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from helpers.collapses import batch, collapse
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection, QuadMesh
from matplotlib.figure import Figure
from PIL import Image

import warpgran as wg
from warpgran.analysis.run_columns import RunColumns
from warpgran.analysis.summary import summary
from warpgran.case.case import Case
from warpgran.case.sections import KEYS
from warpgran.figures import batch as batch_figures
from warpgran.figures.names import named
from warpgran.figures.plot import plot
from warpgran.figures.swept_keys import Key, runs_along, varied_keys

ANGLES, PACKINGS = np.repeat([0.0, 10.0, 22.0], 2), np.tile([0.55, 0.62], 3)


def page(data: xr.Dataset) -> Figure:
    """The page before it is written."""
    return batch_figures.draw_batch(RunColumns.of(data))


def grid(**options: Any) -> xr.Dataset:
    """Three angles by two packings."""
    return batch(slope__angle=ANGLES, column__phi=PACKINGS, **options)


def sample(runs: int, keys: int = 1, **options: Any) -> xr.Dataset:
    """Values without order in so many keys; the first grows with the run-out."""
    random = np.random.default_rng(1)
    names = ["slope__angle", "rheology__K", "column__phi", "rheology__mu1", "rheology__I0", "column__height"]
    values: dict[str, Any] = {name: random.random(runs) for name in names[1:keys]}
    return batch(slope__angle=np.linspace(1.0, 2.0, runs), **values, **options)


def letters(figure: Figure) -> dict[str, Axes]:
    """The panels by their letters."""
    return {ax.get_title(loc="left"): ax for ax in figure.axes if ax.get_title(loc="left")}


def small_print(figure: Figure) -> str:
    return " ".join(text.get_text() for ax in figure.axes for text in ax.texts).replace("\n", " ")


def legend_of(ax: Axes) -> list[str]:
    legend = ax.get_legend()
    return [text.get_text() for text in legend.get_texts()] if legend else []


def crosses(ax: Axes) -> np.ndarray:
    """Where the crosses of an axes lie, (crosses, 2)."""
    return np.concatenate([np.asarray(line.get_xydata()) for line in ax.lines if line.get_marker() == "x"])


def opened(ax: Axes, sign: str) -> list[float]:
    """Abscissae of the open marks of a panel."""
    lines = [line for line in ax.lines if line.get_marker() == sign and str(line.get_markerfacecolor()) == "white"]
    return [float(x) for line in lines for x in np.asarray(line.get_xdata())]


@pytest.mark.slow
@pytest.mark.parametrize("data", [grid(), sample(60, 4, diverged=(7,)), sample(2), sample(60, 6)])
def test_page_is_180_mm_wide_fits_a_sheet_and_clips_nothing(tmp_path: Path, data: xr.Dataset) -> None:
    plot(data, path=tmp_path / "page.png")
    with Image.open(tmp_path / "page.png") as picture:
        assert picture.width == pytest.approx(180 / 25.4 * 200, abs=1)
        assert picture.height <= 247 / 25.4 * 200
        ink = np.argwhere(np.asarray(picture.convert("L")) < 250)
    margins = [*ink.min(axis=0), picture.height - ink.max(axis=0)[0], picture.width - ink.max(axis=0)[1]]
    assert min(margins) > 4


def test_two_keys_make_eight_panels_fronts_and_a_map() -> None:
    figure = page(grid())
    panels = letters(figure)
    assert sorted(panels) == [f"({c})" for c in "abcdefghij"]
    labels = [panels[f"({c})"].get_ylabel() for c in "abcd"]
    units = dict(zip(batch_figures.QUANTITIES, ("m", "cm", "s", "%"), strict=True))
    assert labels == [f"{panel.words} ({unit})" for panel, unit in units.items()]
    assert panels["(d)"].get_xlabel() == r"slope angle $\theta$ (°)"
    assert panels["(h)"].get_xlabel() == r"initial fraction $\varphi_0$ (-)"
    assert (panels["(i)"].get_xlabel(), panels["(i)"].get_ylabel()) == (
        "time $t$ (s)",
        r"front position $x_\mathrm{f}$ (m)",
    )
    assert panels["(j)"].get_ylabel() == panels["(h)"].get_xlabel()
    assert figure.axes[-1].get_ylabel() == "run-out (m)"
    assert figure.get_suptitle().splitlines() == [
        "Dense column, 22 degrees",
        r"6 runs, $\theta$ = $0$ to $22$°, $\varphi_0$ = $0.55$ to $0.62$, $K$ = $4.09$",
    ]
    assert small_print(figure) == "6 of 6 runs came to rest and have a stop time."


def test_points_of_a_grid_are_joined_along_one_key_in_the_colour_of_the_other() -> None:
    data = grid()
    panels = letters(page(data))
    joined = [line for line in panels["(b)"].lines if line.get_linestyle() == "-"]
    h_max = 100 * summary(data)["h_max"].to_numpy()
    assert len(joined) == 2
    for n, line in enumerate(joined):
        np.testing.assert_array_equal(np.asarray(line.get_xdata()), [0.0, 10.0, 22.0])
        np.testing.assert_allclose(np.asarray(line.get_ydata()), h_max[n::2])
    assert tuple(joined[0].get_color()) != tuple(joined[1].get_color())
    assert legend_of(panels["(d)"]) == [r"$\varphi_0$ = $0.55$", r"$\varphi_0$ = $0.62$"]
    assert legend_of(panels["(h)"]) == [rf"$\theta$ = ${angle}$°" for angle in (0, 10, 22)]
    assert legend_of(panels["(i)"]) == legend_of(panels["(h)"])


def test_map_holds_the_run_out_and_misses_what_diverged() -> None:
    data = grid(diverged=(3,))
    figure = page(data)
    ax = letters(figure)["(j)"]
    (mesh,) = (c for c in ax.collections if isinstance(c, QuadMesh))
    expected = np.where(np.arange(6) == 3, np.nan, summary(data)["run_out"])
    np.testing.assert_array_equal(
        np.ma.filled(np.ma.asarray(mesh.get_array()), np.nan).reshape(2, 3), expected.reshape(3, 2).T
    )
    np.testing.assert_array_equal(crosses(ax), [[10.0, 0.62]])


def test_map_of_scattered_values_is_of_points() -> None:
    figure = page(sample(12, 2, diverged=(0,)))
    (points,) = (c for c in letters(figure)["(j)"].collections if isinstance(c, PathCollection))
    assert np.asarray(points.get_offsets()).shape == (11, 2)


def test_diverged_runs_are_crosses_and_count_nowhere_else() -> None:
    data = grid(diverged=(3,))
    data["status"][4] = "step_limit"
    figure = page(data)
    panels = letters(figure)
    for letter in "abcd":
        drawn = [np.asarray(line.get_xydata()) for line in panels[f"({letter})"].lines if line.get_marker() == "o"]
        assert np.isfinite(np.concatenate(drawn)[:, 1]).sum() == 4
        np.testing.assert_array_equal(crosses(panels[f"({letter})"])[:, 0], [10.0, 22.0])
    ends = crosses(panels["(i)"])
    np.testing.assert_allclose(ends[0], [data["series_time"].values[49], data["front"].values[3, 49]])
    np.testing.assert_allclose(ends[1], [0.9, data["front"].values[4, -1]])
    assert "Without a result: 1 diverged and 1 step limit of 6 runs" in small_print(figure)
    assert "4 of 6 runs came to rest" in small_print(figure)


def test_a_run_that_ended_at_rest_counts() -> None:
    data = grid()
    data["status"][:] = "at_rest"
    assert "Without" not in small_print(page(data))


def test_batch_without_a_single_good_run_is_crosses() -> None:
    for data in (grid(diverged=tuple(range(6))), sample(60, 5, diverged=tuple(range(60)))):
        figure = page(data)
        figure.canvas.draw()
        assert [text.get_text() for text in letters(figure)["(a)"].texts] == ["none"]


def test_runs_that_never_began_are_counted() -> None:
    data = grid()
    for name in ("front", "h_max", "volume_change"):
        data[name][4:] = np.nan
    data["status"][4:] = "pending"
    data["stop_time"][4:] = np.nan
    data["status"][3] = "interrupted"
    figure = page(data)
    figure.canvas.draw()
    assert "3 of 6 runs are still to be computed and left out." in small_print(figure)
    assert "Without" not in small_print(figure)
    assert not any(crosses(ax).size for ax in letters(figure).values())
    assert len(letters(figure)["(i)"].lines) == 4  # three fronts, and no crosses


def test_open_marks_are_the_runs_whose_end_is_not_the_end() -> None:
    data = grid(diverged=(2,))
    data["outflow_final"][1:3] = 0.2
    data["stop_time"][4] = np.nan
    data["v_flow_final"][4] = 1.0
    figure = page(data)
    for letter, run, sign in (("a", 1, "^"), ("a", 4, "o"), ("b", 1, "^"), ("b", 4, "o")):
        ax = letters(figure)[f"({letter})"]
        assert opened(ax, sign) == [ANGLES[run]]
    assert opened(letters(figure)["(d)"], "o") == opened(letters(figure)["(d)"], "^") == []
    assert "△ 1 of 6 runs left the grid: their run-out is a lower bound." in small_print(figure)
    assert "○ 1 of 6 runs still moved at the end." in small_print(figure)
    assert "△" not in small_print(page(grid()))


def test_a_batch_that_waits_has_nothing_to_draw() -> None:
    data = grid()
    data["status"][:] = "pending"
    with pytest.raises(wg.ResultError, match="none of the runs is computed yet"):
        page(data)


@pytest.mark.parametrize(("factor", "unit"), [(1e-2, "mm"), (1.0, "m"), (1e4, "km")])
def test_lengths_of_a_batch_are_in_one_unit(factor: float, unit: str) -> None:
    data = batch(column__height=[0.001 * factor, 1000.0 * factor])
    for name in ("front", "h_max", "x"):
        data[name] = factor * data[name]
    panels = letters(page(data))
    assert panels["(a)"].get_ylabel().endswith(f"({unit})")
    assert panels["(e)"].get_ylabel().endswith(f"({unit})")


def test_a_swept_length_is_named_in_the_unit_of_its_values() -> None:
    assert Key("rheology.grain_diameter", np.array([0.5, 2.0])).words.label == "grain diameter $d$ (m)"
    assert Key("rheology.grain_diameter", np.array([5e-4, 2e-3])).words.label == "grain diameter $d$ (mm)"
    assert Key("column.height", np.array([0.1, 0.2])).span() == "$h_0$ = $10$ to $20$ cm"


def test_stop_times_that_no_run_has_are_called_none() -> None:
    data = grid()
    data["stop_time"][:] = np.nan
    figure = page(data)
    assert letters(figure)["(c)"].texts[0].get_text() == "none"
    assert "0 of 6 runs came to rest" in small_print(figure)


def test_one_key_makes_two_by_two_panels() -> None:
    figure = page(batch(slope__angle=[0.0, 10.0, 22.0]))
    panels = letters(figure)
    assert list(panels) == [f"({c})" for c in "abcde"]
    assert panels["(c)"].get_xlabel() == panels["(d)"].get_xlabel() == r"slope angle $\theta$ (°)"
    assert [line.get_linestyle() for line in panels["(a)"].lines if line.get_marker() in ("", "None")] == ["-"]
    assert len(panels["(e)"].lines) == 4  # three fronts, and no crosses
    assert legend_of(panels["(e)"]) == [rf"$\theta$ = ${angle}$°" for angle in (0, 10, 22)]


def test_many_values_are_points_and_many_runs_are_bands() -> None:
    data = sample(60, 3, diverged=(59,))
    panels = letters(page(data))
    assert {line.get_linestyle() for ax in list(panels.values())[:12] for line in ax.lines} == {"None"}
    assert legend_of(panels["(m)"]) == ["5 to 95 % of runs", "25 to 75 %", "median"]
    median = np.asarray(panels["(m)"].lines[0].get_ydata())
    np.testing.assert_allclose(median, np.median(data["front"][:59], axis=0))


def test_bands_stand_samples_that_no_run_has() -> None:
    data = sample(60)
    data["front"][:, 40:] = np.nan
    data["front"][:10, 20:] = np.nan
    (median,) = (line for line in letters(page(data))["(e)"].lines if line.get_label() == "median")
    assert len(np.asarray(median.get_xdata())) == 40


def test_fronts_of_a_key_with_many_values_name_the_first_and_the_last() -> None:
    panels = letters(page(sample(20)))
    assert legend_of(panels["(e)"]) == [r"$\theta$ = $1$°", r"$\theta$ = $2$°"]


def test_of_many_keys_the_strongest_are_drawn_and_the_others_named() -> None:
    data = sample(40, 6)
    data.coords["rheology.I0"] = "run", -data["slope.angle"].values + 5.0
    figure = page(data)
    labels = [ax.get_xlabel() for ax in letters(figure).values() if ax.get_xlabel()]
    assert len(labels) == 5
    assert labels[:2] == ["slope angle\n$\\theta$ (°)", "inertial number\n$I_0$ (-)"]
    assert "Of the 6 swept keys, the 4 whose rank correlation (Spearman)" in small_print(figure)
    assert "slope.angle +1.00, rheology.I0 \N{MINUS SIGN}1.00" in small_print(figure)
    assert "; without " in small_print(figure)


def test_choices_are_categories() -> None:
    data = batch(slope__angle=ANGLES, rheology__phi_eq=["f2", "f0"] * 3)
    panels = letters(page(data))
    assert [tick.get_text() for tick in panels["(h)"].get_xticklabels()] == ["f0", "f2"]
    assert not [line for line in panels["(e)"].lines if line.get_linestyle() == "-"]
    assert [tick.get_text() for tick in panels["(j)"].get_yticklabels()] == ["f0", "f2"]
    assert legend_of(panels["(d)"]) == [r"$\varphi_\mathrm{eq}$ = f0", r"$\varphi_\mathrm{eq}$ = f2"]


def test_choices_alone_leave_the_fronts() -> None:
    panels = letters(page(batch(rheology__phi_eq=["f0", "f1", "f2"], scheme__window=[True, False, True])))
    assert [ax.get_ylabel() for ax in panels.values()] == [r"front position $x_\mathrm{f}$ (m)"]


def test_runs_that_differ_in_no_key_leave_the_fronts() -> None:
    assert list(letters(page(collapse(runs=3)))) == ["(a)"]


def test_keys_over_decades_are_logarithmic() -> None:
    assert letters(page(batch(grid__cells=[100, 200, 400, 800, 1600, 3200])))["(c)"].get_xscale() == "log"
    assert letters(page(sample(40)))["(c)"].get_xscale() == "linear"
    assert not Key("rheology.K", np.linspace(0.01, 8.0, 100)).logarithmic


def test_cells_of_the_map_lie_around_their_values() -> None:
    np.testing.assert_allclose(Key("slope.angle", np.array([0.0, 10.0, 22.0])).edges, [-5, 5, 16, 28])
    np.testing.assert_allclose(
        Key("scheme.cfl", np.array([0.01, 0.1, 1.0])).edges, 10 ** np.array([-2.5, -1.5, -0.5, 0.5])
    )
    np.testing.assert_array_equal(Key("rheology.phi_eq", np.array(["f0", "f2"])).edges, [-0.5, 0.5, 1.5])
    data = batch(rheology__grain_diameter=np.repeat([1e-5, 1e-4, 1e-3], 2), column__phi=PACKINGS)
    figure = page(data)
    figure.canvas.draw()
    assert letters(figure)["(j)"].get_xscale() == "log"


@pytest.mark.slow
def test_ten_thousand_runs_are_drawn_as_pixels(tmp_path: Path) -> None:
    path = tmp_path / "p.pdf"
    plot(sample(10_000, 2, samples=60, diverged=tuple(range(0, 10_000, 50))), path=path)
    assert path.stat().st_size < 2_000_000


def test_choices_correlate_in_the_order_of_their_means() -> None:
    key = Key("rheology.phi_eq", np.array(["b", "a", "b", "a", "c"]))
    assert key.correlation(np.array([0.0, 1.0, 0.1, 1.1, np.nan])) == pytest.approx(np.sqrt(0.8))


def test_keys_that_take_their_values_from_another_are_left_out() -> None:
    d = [1e-3, 2e-3]
    speeds = [case.rest_speed for case in Case().sweep({"column.height": [0.1, 0.2]})]
    five: dict[str, Any] = {"scheme__h_min": [5e-3, 1e-2]}
    follows = batch(rheology__grain_diameter=d, **five, slope__angle=[5.0, 5.0], scheme__h_front=[2e-3, 4e-3])
    assert [key.name for key in varied_keys(follows)] == ["rheology.grain_diameter"]
    first = batch(rheology__grain_diameter=d, scheme__h_min=d, scheme__order=[1, 1])
    assert [key.name for key in varied_keys(first)] == ["rheology.grain_diameter"]
    stops = batch(
        column__height=[0.1, 0.2], time__rest_speed=speeds, slope__angle=[0.0, 0.0], slope__gravity=[9.81, 9.81]
    )
    assert [key.name for key in varied_keys(stops)] == ["column.height"]
    differs = batch(rheology__grain_diameter=d, scheme__h_min=[5e-3, 1e-2 + 1e-5])
    assert [key.name for key in varied_keys(differs)] == ["rheology.grain_diameter", "scheme.h_min"]


def test_runs_along_a_key_differ_in_nothing_else() -> None:
    a, b = Key("slope.angle", np.array([2.0, 1.0, 2.0, 1.0])), Key("column.phi", np.array([0.5, 0.5, 0.6, 0.6]))
    assert [group.tolist() for group in runs_along(a, [a, b])] == [[1, 0], [3, 2]]
    assert [group.tolist() for group in runs_along(a, [a])] == [[1, 3, 0, 2]]


def test_every_key_that_can_vary_has_a_name() -> None:
    assert {key for key in KEYS if named(key).words in ("", key)} == set()
    assert named("rheology.grain_diameter").value(7e-4) == "$d$ = $0.7$ mm"
    assert named("slope.angle").label == r"slope angle $\theta$ (°)"
    assert named("scheme.viscosity").value("paper") == "viscosity = paper"
    assert named("new.key").value(3) == "new.key = 3"


def test_joined_results_are_headed_by_what_they_share() -> None:
    data = batch(slope__angle=[0.0, 22.0])
    texts = [data.attrs["case_toml"], data.attrs["case_toml"].replace("K = 4.09", "K = 1.0").replace("Dense", "Other")]
    figure = page(data.assign_coords(case_toml=("run", texts)))
    title, facts = figure.get_suptitle().splitlines()
    assert title == "Dense column, 22 degrees / Other column, 22 degrees"
    assert r"$\varphi_0$ = $0.62$" in facts and "$K$" not in facts
