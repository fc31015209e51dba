"""What a calibration leaves behind: the netCDF file, the figures, the page."""

from __future__ import annotations

import tomllib
import warnings
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure

import warpgran as wg
from warpgran.calibration.calibrate import Calibrated
from warpgran.calibration.diagnostics import r_hat
from warpgran.calibration.figures_measurements import draw_profiles, draw_residuals, draw_series
from warpgran.calibration.figures_parameters import draw_corner, draw_priors
from warpgran.calibration.page import CAPTIONS, write_figures, write_page
from warpgran.calibration.result import write_result

TRUTH = {"rheology.mu1": 0.45, "rheology.grain_diameter": 1e-3}
PRIORS = {
    "rheology.mu1": {"mean": 0.48, "sd": 0.05},
    "rheology.grain_diameter": {"low": 1e-4, "high": 1e-2, "scale": "log"},
}
SECTION: dict[str, Any] = {"screening": 32, "particles": 32, "starts": 1, "predictive": 12, "seed": 2}
ANGLES, SNAPSHOTS, SAMPLES = (10.0, 20.0), [0.1, 0.2], [0.05, 0.1, 0.15, 0.2]
pytestmark = pytest.mark.slow  # one calibration for all of them


def measure(folder: Path) -> wg.Case:
    """Write profiles and fronts without sigma and volumes with one; the case that they are of."""
    time = {"end": 0.2, "snapshots": SNAPSHOTS, "series": SAMPLES}
    case = wg.Case.from_dict({"title": "Two slopes", "grid": {"left": -0.2, "right": 0.6, "cells": 40}, "time": time})
    data = wg.simulate([case.with_(**{"slope.angle": angle}, **TRUTH) for angle in ANGLES])
    rng = np.random.default_rng(1)
    x = np.linspace(-0.15, 0.2, 8)
    profiles, fronts, volumes = ["angle,t,x,h"], ["angle,t,x"], ["angle,t,change,sigma"]
    for run, angle in enumerate(ANGLES):
        for k, t in enumerate(SNAPSHOTS):
            h = np.interp(x, data["x"].values, data["h"].values[run, k]) * (1 + 0.03 * rng.standard_normal(x.size))
            profiles += [f"{angle},{t},{place},{max(each, 0.0)}" for place, each in zip(x, h, strict=True)]
        for k, t in enumerate(SAMPLES):
            fronts.append(f"{angle},{t},{data['front'].values[run, k] + 0.01 * rng.standard_normal()}")
            volumes.append(f"{angle},{t},{data['volume_change'].values[run, k] + 0.003 * rng.standard_normal()},0.003")
    for name, lines in (("profiles", profiles), ("front", fronts), ("volume", volumes)):
        (folder / f"{name}.csv").write_text("\n".join(lines) + "\n")
    return case


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> Calibrated:
    folder = tmp_path_factory.mktemp("calibration")
    case = measure(folder)
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # no warning of single runs reaches whoever fits thousands
        return wg.calibrate(case, PRIORS, folder, output=folder / "out", **SECTION)


@pytest.fixture(scope="module")
def path(found: Calibrated, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("netcdf") / "calibration.nc"
    write_result(found, path)
    return path


def groups_of(path: Path) -> dict[str, xr.Dataset]:
    """The groups of a file by name; that of the root is called "/"."""
    with h5py.File(path) as file:
        names = [name for name, item in file.items() if isinstance(item, h5py.Group)]
    found = {name: xr.load_dataset(path, group=name, engine="h5netcdf") for name in names}
    return {"/": xr.load_dataset(path, engine="h5netcdf"), **found}


def test_the_file_holds_what_was_found(found: Calibrated, path: Path) -> None:
    groups = groups_of(path)
    assert groups.keys() == {
        "/", "observed_data", "constant_data", "prior", "fit", "posterior", "sample_stats", "tempering",
        "posterior_predictive",
    }  # fmt: skip
    sampled, predictive = found.stages.posterior, found.stages.predictive
    for k, name in enumerate(TRUTH):
        assert groups["posterior"][name].dims == ("chain", "draw")
        assert np.array_equal(groups["posterior"][name], sampled.samples.theta[..., k])
        assert np.array_equal(groups["prior"][name][0], found.stages.screening.theta[:, k])
    assert groups["posterior"]["rheology.grain_diameter"].attrs["units"] == "m"
    assert np.array_equal(groups["posterior"]["front.model_error"], sampled.errors["front model_error"])
    assert np.array_equal(groups["sample_stats"]["log_likelihood"], sampled.samples.log_likelihood)
    replicated = groups["posterior_predictive"]
    assert replicated["profiles"].dims == ("chain", "draw", "profiles_datum")
    assert replicated.sizes["draw"] == SECTION["predictive"]
    for number, observed, where in found.stages.experiments.slices():
        kind, name = observed.kind, found.stages.experiments.each[number].name
        for values, group in ((observed.value, "observed_data"), (found.stages.fit.prediction[where], "fit")):
            rows = groups[group][f"{kind}_experiment"] == name
            assert np.array_equal(groups[group][kind][rows], values)
            assert np.array_equal(groups[group][f"{kind}_t"][rows], observed.t)
        rows = replicated[f"{kind}_experiment"] == name
        assert np.array_equal(replicated[kind][0][:, rows], predictive.replicated[:, where])
    assert np.isnan(groups["constant_data"]["front_sigma"]).all()
    assert (groups["constant_data"]["volume_sigma"] == 0.003).all()
    assert np.array_equal(groups["fit"]["covariance"], found.stages.fit.covariance)
    assert groups["tempering"]["temperature"][-1] == 1.0
    assert groups["/"].attrs["seed"] == SECTION["seed"]
    assert wg.Case.from_dict(tomllib.loads(groups["/"].attrs["case"])) == found.stages.study.base


@pytest.mark.parametrize(
    ("stage", "groups"),
    [("screening", {"observed_data", "prior"}), ("fit", {"observed_data", "prior", "constant_data", "fit"})],
)
def test_a_stage_leaves_what_it_has_found(found: Calibrated, tmp_path: Path, stage: str, groups: set[str]) -> None:
    part = Calibrated(found.stages, stage, 1.0)
    write_result(part, tmp_path / "part.nc")
    assert groups_of(tmp_path / "part.nc").keys() == {"/", *groups}
    pictures = write_figures(part, tmp_path)
    assert {picture.stem for picture in pictures} == (
        set() if stage == "screening" else set(CAPTIONS) - {"corner", "priors"}
    )
    write_page(part, pictures, tmp_path / "part.html")
    assert "Sampling" not in (tmp_path / "part.html").read_text(encoding="utf-8")


@pytest.mark.filterwarnings("ignore")  # ArviZ 0.23 speaks of its own future
def test_arviz_reads_it(found: Calibrated, path: Path) -> None:
    arviz = pytest.importorskip("arviz")
    data = arviz.from_netcdf(path, engine="h5netcdf")
    table = arviz.summary(data, var_names=list(TRUTH), round_to="none")
    for k, name in enumerate(TRUTH):
        draws = found.stages.posterior.samples.theta[..., k]
        assert float(table["mean"][name]) == pytest.approx(draws.mean())
        assert float(table["r_hat"][name]) == pytest.approx(r_hat(draws))
    assert data["posterior_predictive"]["front"].sizes["front_datum"] == data["observed_data"]["front"].size


@pytest.mark.skipif(
    not hasattr(xr, "open_datatree"), reason="xarray before 2024.10 has no trees, as ArviZ 1 reads them"
)
def test_it_is_a_tree_of_datasets(found: Calibrated, path: Path) -> None:
    with xr.open_datatree(path, engine="h5netcdf") as tree:
        assert set(tree.children) == groups_of(path).keys() - {"/"}
        assert tree["posterior"].sizes["draw"] == found.stages.posterior.samples.theta.shape[1]


class Reader(HTMLParser):
    """The text and the pictures of a page."""

    def __init__(self) -> None:
        super().__init__()
        self.text: list[str] = []
        self.pictures = 0

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Count what is shown."""
        source = dict(attrs).get("src") or ""
        self.pictures += tag == "img" and source.startswith("data:image/png;base64,")

    def handle_data(self, data: str) -> None:
        """Keep what is read."""
        self.text.append(data)


def test_the_page_has_all_of_it(found: Calibrated, tmp_path: Path) -> None:
    pictures = write_figures(found, tmp_path)
    assert {picture.stem for picture in pictures} == set(CAPTIONS)
    write_page(found, pictures, tmp_path / "calibration.html")
    reader = Reader()
    reader.feed((tmp_path / "calibration.html").read_text(encoding="utf-8"))
    text = " ".join(" ".join(reader.text).split())
    assert reader.pictures == len(CAPTIONS)
    for line in found.told():
        assert line[1:] in text
    for name, row in found.table().iterrows():
        assert str(name) in text
        assert f"{row['mean']:.4g}" in text
    assert "0.0001 to 0.01, logarithmic" in text
    assert f"Seed {SECTION['seed']}" in text
    assert ("has not converged" in text) is not found.converged


def test_all_of_it_is_written_over_what_is_ours_alone(found: Calibrated, tmp_path: Path) -> None:
    for _ in range(2):
        written = found.write(tmp_path)
    assert {path.name for path in written} == {"calibration.html", "calibration.nc", *(f"{n}.png" for n in CAPTIONS)}
    (tmp_path / "calibration.nc").write_text("mine")
    with pytest.raises(wg.StorageError, match="was not written by warpgran"):
        found.write(tmp_path)


def labels(figure: Figure) -> set[str]:
    return {label.get_text() for legend in figure.legends for label in legend.get_texts()}


def test_the_corner_has_every_pair_and_the_best_fit(found: Calibrated) -> None:
    figure = draw_corner(found)
    shown = [ax for ax in figure.axes if ax.axison]
    assert len(shown) == 3
    theta, factor = found.stages.fit.theta, 1e3  # grain diameters in mm
    [pair] = [ax for ax in shown if len(ax.lines) == 2]
    assert pair.lines[1].get_xydata() == pytest.approx(np.array([[theta[0], factor * theta[1]]]))
    assert np.size(pair.lines[0].get_xdata()) == found.stages.posterior.samples.log_likelihood.size


def test_a_logarithmic_prior_is_flat_over_its_logarithm(found: Calibrated) -> None:
    _, ax = draw_priors(found).axes
    assert ax.get_xscale() == "log"
    heights = np.asarray(ax.collections[0].get_paths()[0].vertices)[:, 1]
    assert np.ptp(heights[heights > 0]) == pytest.approx(0.0, abs=1e-12)
    assert ax.get_xlim() == pytest.approx((0.1, 10.0), rel=0.02)  # mm


def test_bands_lie_around_the_measurements(found: Calibrated) -> None:
    profiles, series = draw_profiles(found), draw_series(found)
    assert profiles is not None and series is not None
    assert len(profiles.axes) == len(ANGLES) * len(SNAPSHOTS)
    assert len(series.axes) == len(ANGLES) * 2
    for figure in (profiles, series):
        assert labels(figure) == {"model, 90 %", "model and its errors, 90 %", "best fit", "measured"}
    first = series.axes[0]
    front = next(o for _, o, _ in found.stages.experiments.slices() if o.kind == "front")
    assert first.lines[0].get_xdata() == pytest.approx(front.t)
    measured = next(line for line in first.lines if line.get_marker() == "o")
    ratio = np.asarray(measured.get_ydata()) / front.value
    assert ratio == pytest.approx(ratio[0])


def test_residuals_are_those_of_the_best_fit(found: Calibrated) -> None:
    figure = draw_residuals(found)
    assert [ax.get_title() for ax in figure.axes] == ["profiles", "profiles", "front", "volume"]
    deviation = found.stages.error_model.likeliest(found.stages.fit.prediction).deviation()
    _, observed, where = next(part for part in found.stages.experiments.slices() if part[1].kind == "volume")
    expected = (observed.value - found.stages.fit.prediction[where]) / deviation[where]
    assert figure.axes[3].lines[0].get_ydata() == pytest.approx(expected)
