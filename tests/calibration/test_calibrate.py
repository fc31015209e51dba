"""A calibration from end to end: stages, resuming, the command, and truths that are recovered."""

from __future__ import annotations

import importlib.util
import shutil
from pathlib import Path
from types import ModuleType
from typing import Any

import h5py
import numpy as np
import pytest
from helpers.places import BENCHMARKS
from typer.testing import CliRunner

import warpgran as wg
from warpgran.calibration import words
from warpgran.calibration.calibrate import Calibrated
from warpgran.calibration.forward import Forward
from warpgran.cli.app import app

TRUTH = {"rheology.mu1": 0.45, "rheology.phi_stat": 0.58}
PRIORS = {"rheology.mu1": {"low": 0.3, "high": 0.6}, "rheology.phi_stat": {"low": 0.55, "high": 0.61}}
SECTION: dict[str, Any] = {"screening": 32, "particles": 8, "starts": 1, "predictive": 6}
RUN_FILE = """
title = "Two slopes"
[grid]
left = -0.2
right = 1.0
cells = 40
[time]
end = 0.5
[calibration]
screening = 32
particles = 8
starts = 1
predictive = 6
[calibration.over]
"rheology.mu1" = { low = 0.3, high = 0.6 }
"rheology.phi_stat" = { low = 0.55, high = 0.61 }
"""


def coverage() -> ModuleType:
    """The benchmark that makes experiments."""
    spec = importlib.util.spec_from_file_location("intervals", BENCHMARKS / "intervals.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def case() -> wg.Case:
    grid, time = {"left": -0.2, "right": 1.0, "cells": 40}, {"end": 0.5}
    return wg.Case.from_dict({"grid": grid, "time": time})


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Fronts of two slopes with 3 % noise."""
    folder = tmp_path_factory.mktemp("laboratory")
    times = [0.1, 0.2, 0.3, 0.4, 0.5]
    rng = np.random.default_rng(4)
    lines = ["angle,t,x,sigma"]
    for angle in (5.0, 18.0):
        run = wg.simulate(case().with_(**{"slope.angle": angle, "time.series": times}, **TRUTH)).isel(run=0)
        front = run["front"].values + rng.normal(0.0, 0.01, 5)
        lines += [f"{angle},{t},{x:.6f},0.01" for t, x in zip(times, front.tolist(), strict=True)]
    (folder / "front.csv").write_text("\n".join(lines) + "\n")
    return folder


def calibrated(data: Path, output: Path, **more: Any) -> Calibrated:
    return wg.calibrate(case(), PRIORS, data, output=output, **{**SECTION, **more})


@pytest.fixture(scope="module")
def output(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where `whole` is kept."""
    return tmp_path_factory.mktemp("whole")


@pytest.fixture(scope="module")
def whole(data: Path, output: Path) -> Calibrated:
    """All stages at once."""
    return calibrated(data, output)


def bits(found: Any) -> list[bytes]:
    stages = found.stages
    arrays = [
        stages.screening.predictions,
        stages.fit.theta,
        stages.posterior.samples.theta,
        stages.predictive.replicated,
    ]
    return [array.tobytes() for array in (*arrays, *stages.posterior.errors.values())]


@pytest.mark.slow
def test_a_calibration_that_is_killed_goes_on_to_the_same_bits(
    data: Path, whole: Calibrated, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    calls = 0
    compute = Forward.__call__

    def killed(self: Forward, theta: np.ndarray, *rest: Any) -> np.ndarray:
        nonlocal calls
        calls += 1
        if calls in (3, 9, 14):  # in the fit, and twice in the posterior
            raise KeyboardInterrupt
        return compute(self, theta, *rest)

    monkeypatch.setattr(Forward, "__call__", killed)
    for _ in range(3):
        with pytest.raises(KeyboardInterrupt):
            calibrated(data, tmp_path / "killed")
    computed = calls
    assert bits(calibrated(data, tmp_path / "killed")) == bits(whole)
    calls = computed = 100
    again = calibrated(data, tmp_path / "killed")
    assert bits(again) == bits(whole)
    assert (calls, again.stages.forward.tally.runs) == (computed, 0)  # nothing is computed twice


@pytest.mark.slow
def test_stages_can_be_asked_for_alone(data: Path, tmp_path: Path) -> None:
    first = calibrated(data, tmp_path, stage="screening")
    assert first.stages.forward.tally.runs == 64 and "fit" not in vars(first.stages)
    assert list(first.table()) == ["prior_5", "prior_95"] and first.converged
    second = calibrated(data, tmp_path, stage="fit")
    assert "posterior" not in vars(second.stages)
    fit = second.table()
    assert (abs(fit["fit"] - list(TRUTH.values())) < 4 * fit["fit_sd"]).all()
    assert not (tmp_path / "runs" / "predictive.h5").exists()
    with pytest.raises(
        wg.OptionError, match="stage: 'all' is not known; allowed: screening, fit, posterior, predictive"
    ):
        calibrated(data, tmp_path, stage="all")


@pytest.mark.slow
def test_other_measurements_are_another_posterior_of_the_same_runs(
    data: Path, whole: Calibrated, output: Path, tmp_path: Path
) -> None:
    shutil.copytree(output, tmp_path / "out")
    other = tmp_path / "other"
    other.mkdir()
    text = (data / "front.csv").read_text().replace(",0.01\n", ",0.03\n")
    (other / "front.csv").write_text(text)
    second = calibrated(other, tmp_path / "out", stage="posterior")
    assert second.stages.screening.predictions.tobytes() == whole.stages.screening.predictions.tobytes()
    assert second.table()["sd"]["rheology.mu1"] > 1.5 * whole.table()["sd"]["rheology.mu1"]


@pytest.mark.slow
def test_the_command_prints_a_table_and_what_must_be_said(
    data: Path, whole: Calibrated, output: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "two.toml").write_text(RUN_FILE)
    shutil.copytree(output, tmp_path / "two_calibration")
    monkeypatch.chdir(tmp_path)
    asked = ["calibrate", "two.toml", "--data", str(data)]
    monkeypatch.setattr(words, "LEAST_SIZE", 30.0)
    done = CliRunner().invoke(app, asked)
    assert done.exit_code == 0, done.output
    assert done.output.startswith("Two slopes\n")
    assert "rheology.phi_stat" in done.output and "error of the model" in done.output
    assert "\n0 runs in " in done.output  # all are those of `whole`
    monkeypatch.setattr(words, "LEAST_SIZE", 1e6)
    failed = CliRunner().invoke(app, asked)
    assert failed.exit_code == 1
    assert "rheology.mu1: not converged: R-hat" in failed.output and "set calibration.particles = 16" in failed.output


def test_the_command_refuses_wrong_input_with_a_line_each(tmp_path: Path) -> None:
    (tmp_path / "two.toml").write_text(RUN_FILE)
    (tmp_path / "front.csv").write_text("angle,t,x\n0,9,0.1\n0,10,7\n")
    refused = CliRunner().invoke(app, ["calibrate", str(tmp_path / "two.toml"), "--data", str(tmp_path)])
    assert refused.exit_code == 2
    assert [line.rpartition("front.csv:")[2].partition(" ")[0] for line in refused.output.splitlines()] == [
        "2:",
        "3:",
        "3:",
    ]
    refused = CliRunner().invoke(app, ["calibrate", str(tmp_path / "two.toml"), "--data", str(tmp_path / "none")])
    assert (refused.exit_code, refused.output.count("\n")) == (2, 1)


def test_a_spoiled_screening_is_refused_in_a_line(tmp_path: Path) -> None:
    (tmp_path / "two.toml").write_text(RUN_FILE)
    (tmp_path / "front.csv").write_text("angle,t,x,sigma\n0,0.2,0.2,0.01\n")
    folder = tmp_path / "out"
    small = [word for change in ("calibration.screening=16", "time.end=0.2") for word in ("--set", change)]
    options = ["--data", str(tmp_path), "-o", str(folder), "--stage", "screening", *small]
    assert CliRunner().invoke(app, ["calibrate", str(tmp_path / "two.toml"), *options]).exit_code == 0
    kept = folder / "runs" / "screening.h5"
    sound = kept.read_bytes()
    with h5py.File(kept) as file:
        status = file["status"].id.get_offset()
    for at in (status, 600, len(sound) // 2):  # a run that ended as another, a structure, numbers
        kept.write_bytes(sound[:at] + bytes([sound[at] ^ 1]) + sound[at + 1 :])
        refused = CliRunner().invoke(app, ["calibrate", str(tmp_path / "two.toml"), *options])
        assert refused.exit_code == 2 and isinstance(refused.exception, SystemExit)
        assert refused.stderr == f"warpgran: cannot write {kept}: {kept} is damaged, or no result; remove it first\n"
    kept.write_bytes(sound)
    again = CliRunner().invoke(app, ["calibrate", str(tmp_path / "two.toml"), *options])
    assert again.exit_code == 0 and "\n0 runs in " in again.output and kept.read_bytes() == sound


def test_check_checks_the_section(tmp_path: Path) -> None:
    (tmp_path / "two.toml").write_text(RUN_FILE)
    done = CliRunner().invoke(app, ["check", str(tmp_path / "two.toml")])
    assert done.exit_code == 0 and "warpgran calibrate fits rheology.mu1, rheology.phi_stat\n" in done.output
    refused = CliRunner().invoke(app, ["check", str(tmp_path / "two.toml"), "--set", "calibration.starts=0"])
    assert refused.exit_code == 2 and "calibration.starts: 0 is out of range" in refused.output


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "sigma"), [(1, True), (2, False)])
def test_truths_are_recovered_from_noisy_measurements(tmp_path: Path, seed: int, sigma: bool) -> None:
    """Two experiments of the rank histogram in benchmarks/intervals.py."""
    made = coverage()
    base = made.base_case(60)
    rng = np.random.default_rng([7, seed])
    truth = {key: float(rng.uniform(prior["low"], prior["high"])) for key, prior in made.PRIORS.items()}
    made.measure(base, truth, 0.05, sigma, False, tmp_path / "data", seed)
    section: dict[str, Any] = {"screening": 128, "particles": 16, "starts": 2}
    found = wg.calibrate(base, made.PRIORS, tmp_path / "data", output=tmp_path / "out", stage="posterior", **section)
    table = found.table()
    assert (abs(table["mean"] - list(truth.values())) < 3.0 * table["sd"]).all()
    assert (table["sd"] < 0.7 * (table["prior_95"] - table["prior_5"]) / 0.9 / np.sqrt(12.0))[
        ["rheology.phi_stat"]
    ].all()
    assert table["r_hat"].max() < 1.1
