"""What is said beside the numbers of a calibration, of stages whose answers are made up."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from warpgran.calibration import words
from warpgran.calibration.experiments import Experiment, Experiments, Observed
from warpgran.calibration.forward import Tally
from warpgran.calibration.screening import Screening
from warpgran.case.case import Case
from warpgran.case.distributions import Distribution

PRIORS = {"rheology.mu1": Distribution(low=0.3, high=0.6), "rheology.K": Distribution(low=0.0, high=8.0)}
NAMES = tuple(PRIORS)
T = np.array([0.1, 0.2, 0.3])
CASE = Case()


def stages(**found: Any) -> Any:
    front = Observed("front", T, np.full(3, np.nan), np.array([0.1, 0.2, 0.9]), np.full(3, 0.01))
    experiments = Experiments(CASE, (Experiment("22°", {"slope.angle": 22.0}, (front,)),))
    study = SimpleNamespace(priors=PRIORS, section=SimpleNamespace(particles=32))
    return SimpleNamespace(study=study, experiments=experiments, names=NAMES, **found)


def posterior(shares: np.ndarray, **more: Any) -> Any:
    """Draws at shares (draws, 2) of the priors."""
    theta = np.stack([prior.ppf(u) for prior, u in zip(PRIORS.values(), shares.T, strict=True)], axis=1)
    samples = SimpleNamespace(theta=theta.reshape(2, -1, 2))
    return SimpleNamespace(samples=samples, errors={}, **more)


def test_measurements_beyond_reach_and_failed_runs_are_told() -> None:
    predictions = np.array([[0.1, 0.2, 0.3], [0.2, 0.3, 0.4], [np.nan] * 3])
    lines = [*words.of_screening(stages(screening=Screening(np.ones((3, 2)), predictions)))]
    assert lines[-2].startswith("1 of 3 points of the prior have no likelihood: their runs failed")
    assert lines[-1] == (
        "front at 22°: 1 of 3 measurements lie further than three sigma from all that the model gives anywhere in the "
        "prior: t = 0.3 s"
    )


def test_an_unlikely_case_is_told() -> None:
    found = stages(screening=Screening(np.ones((1, 2)), np.array([[0.1, 0.2, 0.9]])))
    assert [*words.of_screening(found)] == []
    coarse = Experiments(CASE.with_(**{"grid.cells": 60}), found.experiments.each)
    found.experiments = coarse
    (line,) = words.of_screening(found)
    assert line.startswith("grid.cells: 60 put")


def test_combinations_are_told_in_steps_of_the_parameters() -> None:
    turned = np.array([[0.6, 0.8], [0.8, -0.6]])
    fit = SimpleNamespace(
        names=NAMES, units=np.array([0.1, 2.0]), ends=np.zeros((1, 3)),
        combinations=lambda: [(0.05, turned[0]), (0.9, turned[1])],
    )  # fmt: skip
    lines = [*words.of_fit(stages(fit=fit, error_model=SimpleNamespace(kinds={})))]
    assert lines == [
        "best determined: rheology.K up by 1.6 with rheology.mu1 up by 0.06 (5% of the width of the prior is left)",
        "not determined by the data: rheology.mu1 up by 0.08 with rheology.K down by 1.2 "
        "(90% of the width of the prior is left)",
    ]


@pytest.mark.parametrize(
    ("reached", "told"), [([3.0], 0), ([3.0, 3.0, 3.0], 0), ([3.0, 2.0, -9.0], 0), ([3.0, 0.5, 0.5], 1)]
)
def test_starts_that_lead_elsewhere_are_told(reached: list[float], told: int) -> None:
    ends = np.column_stack([np.zeros((len(reached), 2)), reached])
    fit = SimpleNamespace(names=NAMES, ends=ends, combinations=list)
    lines = [*words.of_fit(stages(fit=fit, error_model=SimpleNamespace(kinds={})))]
    assert [line.startswith("of 3 starts one has led to the best fit") for line in lines] == [True] * told


@pytest.mark.parametrize(
    ("shares", "message"),
    [
        (lambda u: 0.955 + 0.03 * u, "rheology.K: leans on the high edge of its prior (100% of the posterior lies"),
        (lambda u: 0.2 * u, "rheology.K: leans on the low edge of its prior (25% of the posterior lies"),
        (lambda u: u, "rheology.K: the posterior is as wide as the prior; the data do not determine it by itself"),
        (lambda u: 0.3 + 0.1 * u, None),
    ],
)
def test_edges_of_the_prior_and_open_parameters_are_told(shares: Any, message: str | None) -> None:
    u = (np.arange(600) + 0.5) / 600
    both = np.stack([0.5 + 0.1 * u, shares(u)], axis=1)
    lines = [*words.of_posterior(stages(posterior=posterior(both), error_model=SimpleNamespace(kinds={})))]
    if message is None:
        assert lines == []
    else:
        assert len(lines) == 1 and lines[0].startswith(message)


def test_what_has_not_converged_says_what_to_do() -> None:
    found = posterior(
        np.full((8, 2), 0.5), r_hat={NAMES[0]: 1.01, NAMES[1]: 1.2}, size={NAMES[0]: 99.0, NAMES[1]: 500.0}
    )
    lines = words.not_converged(stages(posterior=found))
    assert len(lines) == 2
    assert lines[1].startswith("rheology.K: not converged: R-hat 1.200 (allowed: <= 1.05), 500 effective draws")
    assert lines[1].endswith("set calibration.particles = 64, or narrow the priors")


def test_runs_are_counted() -> None:
    tally = Tally(runs=100, refused=4, engine_seconds=8.0)
    tally.ended["diverged"] = 3
    assert (
        words.of_runs(tally, 10.0) == "100 runs, 3 of which failed; 4 cannot be made in 10 s, 80% of it in the engine"
    )
