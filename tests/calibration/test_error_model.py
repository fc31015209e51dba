"""The error model: against the same densities by scipy, and sums over what is not known by quadrature."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import kstest, multivariate_normal

from warpgran.calibration.error_model import LEAST_SHAPE, NOISE, WORTH, ErrorModel, KindErrors
from warpgran.calibration.experiments import Experiment, Experiments, Observed
from warpgran.case.case import Case

T = np.linspace(0.1, 0.6, 6)
X = np.array([0.0, 0.1, 0.2, 0.1, 0.3, 0.5])
VALUE = np.array([0.14, 0.12, 0.05, 0.10, 0.06, 0.01])
SIGMA = np.array([0.01, 0.02, 0.01, 0.03, 0.01, 0.02])
GRID = np.full(9, 0.004)
RESIDUALS = np.random.default_rng(3).normal(0.0, 0.015, (4, 9))


def parts(known: bool) -> list[tuple[slice, Observed]]:
    """Two experiments: six measurements and three."""
    first = Observed("profiles", T, X, VALUE, SIGMA if known else None)
    second = Observed("profiles", T[:3], X[:3], VALUE[:3] / 2, SIGMA[:3] if known else None)
    return [(slice(0, 6), first), (slice(6, 9), second)]


def correlated(length: float) -> np.ndarray:
    t, x = np.concatenate([T, T[:3]]), np.concatenate([X, X[:3]])
    experiment = np.repeat([0, 1], [6, 3])
    distance = abs(t[:, None] - t) / 0.5 + abs(x[:, None] - x) / 0.5
    return np.exp(-distance / length) * (experiment[:, None] == experiment)


def test_known_noise_is_a_gaussian_with_correlated_model_error() -> None:
    errors = KindErrors("profiles", parts(True), np.zeros(9), GRID, None, None)
    logs, _ = errors.by_node(RESIDUALS)
    noise = np.diag(np.concatenate([SIGMA, SIGMA[:3]]) ** 2 + GRID**2)
    for at in (0, 30, len(errors.nodes) - 1):
        node = errors.nodes[at]
        expected = multivariate_normal(np.zeros(9), noise + node.size**2 * correlated(node.length)).logpdf(RESIDUALS)
        assert logs[:, at] == pytest.approx(expected, rel=1e-9)
    assert errors.log_likelihood(RESIDUALS) == pytest.approx(np.log(np.exp(logs).mean(axis=1)))


@pytest.mark.parametrize("proportional", [False, True])
def test_inferred_noise_is_summed_by_formula_as_by_quadrature(proportional: bool) -> None:
    predicted = np.concatenate([VALUE, VALUE[:3] / 2])
    errors = KindErrors("profiles", parts(False), predicted, GRID, 0.01, 0.3)
    at = [node.proportional for node in errors.nodes].index(proportional) + 10
    shape = np.maximum(predicted / 0.14, LEAST_SHAPE) if proportional else np.ones(9)
    form = np.diag(shape**2 + (GRID / 0.01) ** 2) + errors.nodes[at].size ** 2 * correlated(0.3)
    least = (NOISE * errors.scale) ** 2

    def density(log_s: float) -> float:
        s2 = np.exp(2.0 * log_s)
        prior = 2.0 * np.sqrt(least / 2.0 / np.pi) * s2**-1.5 * np.exp(-least / (2.0 * s2)) * s2  # of log s
        return float(prior * multivariate_normal(np.zeros(9), s2 * form).pdf(RESIDUALS[0]))

    expected = quad(density, -9.0, 1.0, limit=200)[0]
    assert errors.by_node(RESIDUALS)[0][0, at] == pytest.approx(np.log(expected), rel=1e-6)


def test_draws_of_an_inferred_noise_follow_its_posterior() -> None:
    rng = np.random.default_rng(5)
    n = 200
    observed = Observed("front", np.linspace(0, 1, n), np.full(n, np.nan), np.linspace(0.0, 1.0, n), None)
    errors = KindErrors("front", [(slice(0, n), observed)], np.ones(n), np.zeros(n), None, 0.1)
    residuals = np.tile(rng.normal(0.0, 0.05, n), (2000, 1))
    named = errors.named(errors.draw(residuals, rng))
    assert named["noise"].mean() == pytest.approx(0.05, rel=0.05)
    assert named["noise"].std() == pytest.approx(0.05 / np.sqrt(2 * n), rel=0.5)
    assert np.median(named["model_error"]) < 0.02  # there is none


def test_the_prior_of_an_inferred_noise_counts_beside_few_measurements() -> None:
    errors = KindErrors("profiles", parts(False), np.concatenate([VALUE, VALUE[:3] / 2]), GRID, 0.01, 0.3)
    drawn = errors.draw(np.tile(RESIDUALS[0], (20_000, 1)), np.random.default_rng(1))
    squares = errors.by_node(RESIDUALS[:1])[1][0, drawn.node] + WORTH * (NOISE * errors.scale) ** 2
    assert (squares / drawn.noise**2).mean() == pytest.approx(9.0 + WORTH, rel=0.01)  # a chi-square of so many


def test_replicated_errors_have_the_covariance_of_the_model() -> None:
    errors = KindErrors("profiles", parts(True), np.zeros(9), GRID, None, 0.3)
    rng = np.random.default_rng(1)
    drawn = errors.draw(np.zeros((1, 9)), rng)
    at = len(errors.nodes) - 5
    many = type(drawn)(np.full(40000, at), np.ones(40000))
    found = np.cov(errors.errors(many, rng).T)
    noise = np.diag(np.concatenate([SIGMA, SIGMA[:3]]) ** 2 + GRID**2)
    expected = noise + errors.nodes[at].size ** 2 * correlated(0.3)
    assert found == pytest.approx(expected, abs=0.03 * expected.max())


def test_whitened_residuals_are_the_square_of_the_likelihood() -> None:
    errors = KindErrors("profiles", parts(True), np.zeros(9), GRID, None, None)
    node, noise = errors.likeliest(RESIDUALS[0])
    square = (errors.whitened(RESIDUALS, node, noise) ** 2).sum(axis=1)
    assert square == pytest.approx(errors.by_node(RESIDUALS)[1][:, errors.nodes.index(node)])


def test_correlation_lowers_the_effective_number_of_data() -> None:
    errors = KindErrors("profiles", parts(True), np.zeros(9), GRID, None, None)
    by_size = [errors.effective(node) for node in errors.nodes[:24]]
    assert by_size[0] == pytest.approx(9.0, rel=0.02)
    assert np.all(np.diff(by_size) < 0)


def experiments() -> Experiments:
    observed = (Observed("front", T, np.full(6, np.nan), T**2, np.full(6, 0.02)),
                Observed("volume", T, np.full(6, np.nan), 0.1 * T, None))  # fmt: skip
    return Experiments(Case(), (Experiment("0°", {"slope.angle": 0.0}, observed),))


def test_failed_runs_are_impossible_and_kinds_add_up() -> None:
    model = ErrorModel(experiments())
    predictions = np.tile(experiments().value + 0.01, (2, 1))
    predictions[1, 3] = np.nan
    found = model.log_likelihood(predictions)
    residuals = np.full((1, 12), -0.01)
    assert found[0] == pytest.approx(float(sum(kind.log_likelihood(residuals)[0] for kind in model.kinds.values())))
    assert found[1] == -np.inf


def test_draws_are_named_by_kind_and_replications_scatter_about_predictions() -> None:
    model = ErrorModel(experiments())
    rng = np.random.default_rng(2)
    predictions = np.tile(experiments().value, (3000, 1)) + rng.normal(0.0, 0.02, (3000, 12))
    named, replicated = model.draw(predictions, rng)
    assert [*named] == [
        "front model_error", "front correlation", "volume model_error", "volume noise", "volume correlation"
    ]  # fmt: skip
    z = (replicated - predictions)[:, 0] / 0.02
    assert abs(z.mean()) < 0.1 and 0.9 < z.std() < 2.0
    assert kstest(z / z.std(), "norm").pvalue > 1e-6
