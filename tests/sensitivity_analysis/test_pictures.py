"""The figures of indices: which there are, and that they say what the indices say."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from helpers.designs import ishigami, result_of, study_of
from matplotlib import rc_context
from matplotlib.container import BarContainer, ErrorbarContainer
from xarray import Dataset

import warpgran as wg
from warpgran.figures.style import STYLE
from warpgran.sensitivity_analysis.pictures import draw, draw_bars, draw_main_effects, draw_over_time, draw_plane


def front(x: np.ndarray) -> np.ndarray:
    return np.stack([0 * x[:, 0], x[:, 0], x[:, 1]], axis=1)


@pytest.fixture(scope="module")
def sobol() -> Dataset:
    return wg.indices(result_of(study_of(3, samples=64, of=["run_out", "front@1", "front"]), ishigami, front))


@pytest.fixture(scope="module")
def morris() -> Dataset:
    study = study_of(3, samples=20, method="morris", of=["run_out", "front"])
    return wg.indices(result_of(study, ishigami, front))


def test_all_figures_of_a_method(sobol: Dataset, morris: Dataset, tmp_path: Path) -> None:
    def names(found: Dataset, suffix: str) -> list[str]:
        return [path.name for path in draw(found, tmp_path / "a", suffix) if path.stat().st_size > 5000]

    assert names(sobol, ".png") == ["a_indices.png", "a_main_effects.png", "a_over_time.png"]
    assert names(morris, ".svg") == ["a_plane.svg", "a_over_time.svg"]
    only = wg.indices(result_of(study_of(2, samples=16), lambda x: x[:, 0]))
    assert names(only, ".pdf") == ["a_indices.pdf", "a_main_effects.pdf"]


def test_bars_are_the_indices(sobol: Dataset) -> None:
    axes = draw_bars(sobol).axes
    assert [ax.get_title(loc="left") for ax in axes] == ["(a) run-out", "(b) front at 1 s"]
    for ax, output in zip(axes, ("run_out", "front@1"), strict=True):
        first, total = (bars for bars in ax.containers if isinstance(bars, BarContainer))
        for bars, name in ((first, "first_order"), (total, "total_order")):
            widths = [patch.get_width() for patch in bars.patches]
            np.testing.assert_allclose(widths, sobol[name].sel(output=output))


def test_lines_over_time_are_the_total_indices(sobol: Dataset) -> None:
    axes = draw_over_time(sobol).axes
    lines = [line for line in axes[1].lines if str(line.get_label())[0] != "_"]
    assert len(lines) == 3
    for line, key in zip(lines, sobol["parameter"].values, strict=True):
        wanted = sobol["total_order_over_time"].sel(series="front", parameter=key)
        np.testing.assert_allclose(np.asarray(line.get_ydata(), dtype=float), wanted)


def test_where_nothing_varies_no_index_is_drawn() -> None:
    def still(x: np.ndarray) -> np.ndarray:
        return np.stack([1e-3 * x[:, 0], x[:, 1], x[:, 1]], axis=1)

    found = wg.indices(result_of(study_of(2, samples=16, of=["front"]), ishigami_of_two, still))
    assert np.isfinite(found["total_order_over_time"]).all()
    [line, *_] = [line for line in draw_over_time(found).axes[1].lines if str(line.get_label())[0] != "_"]
    assert np.isnan(np.asarray(line.get_ydata(), dtype=float)).tolist() == [True, False, False]


def ishigami_of_two(x: np.ndarray) -> np.ndarray:
    return np.asarray(x.sum(axis=1))


def test_the_plane_has_a_mark_for_each_parameter(morris: Dataset) -> None:
    [ax] = draw_plane(morris).axes
    marks = [container.lines[0] for container in ax.containers if isinstance(container, ErrorbarContainer)]
    at = [np.asarray(line.get_xydata(), dtype=float)[0] for line in marks]
    one = morris.sel(output="run_out")
    np.testing.assert_allclose(at, np.stack([one["mu_star"], one["sigma"]], axis=1))


def test_main_effects_have_a_panel_for_each_parameter(sobol: Dataset) -> None:
    with rc_context(STYLE):
        axes = draw_main_effects(sobol).axes
    assert len(axes) == 2 * 3
    drawn = np.asarray(axes[0].lines[0].get_ydata(), dtype=float)
    np.testing.assert_allclose(drawn, sobol["main_effect"].sel(output="run_out", parameter="rheology.K"))
