"""The sampler, on posteriors that are known."""

from collections.abc import Callable
from pathlib import Path

import emcee
import numpy as np
import pytest
from scipy import stats

from warpgran.arrays import Array
from warpgran.calibration.diagnostics import effective_size, r_hat
from warpgran.calibration.smc import Posterior, sample
from warpgran.case.distributions import Distribution
from warpgran.errors import OptionError, ResultError

NORMAL = Distribution(mean=0.0, sd=1.0)
UNIFORM = Distribution(low=0.0, high=1.0)
Likelihood = Callable[[Array], Array]


class LinearGaussian:
    """y = A theta + noise, theta standard normal: the posterior is normal, and known."""

    def __init__(self, y: Array | None = None, d: int = 3, sd: float = 0.1) -> None:
        self.design = np.random.default_rng(5).standard_normal((12, d)) * np.array([1.0, 1.0, 0.2])[:d]
        self.sd = sd
        self.y = self.design @ np.array([0.5, -1.0, 1.5])[:d] if y is None else y
        self.covariance = np.linalg.inv(self.design.T @ self.design / sd**2 + np.eye(d))
        self.mean = self.covariance @ self.design.T @ self.y / sd**2
        evidence = stats.multivariate_normal(cov=self.design @ self.design.T + sd**2 * np.eye(12))
        self.log_evidence = float(evidence.logpdf(self.y))

    def __call__(self, theta: Array) -> Array:
        """Log likelihood of points (n, d), as (n,)."""
        return stats.norm.logpdf(self.y - theta @ self.design.T, scale=self.sd).sum(axis=1)


def flat(samples: Posterior) -> Array:
    return samples.theta.reshape(-1, samples.theta.shape[2])


def test_the_posterior_of_a_linear_gaussian_is_exact() -> None:
    model = LinearGaussian()
    samples = sample(model, [NORMAL] * 3, draws=500, seed=1)
    draws, sd = flat(samples), np.sqrt(np.diag(model.covariance))
    sizes = np.array([effective_size(samples.theta[..., k]) for k in range(3)])
    assert (sizes > 200).all()
    assert (abs(draws.mean(axis=0) - model.mean) < 4 * sd / np.sqrt(sizes)).all()
    found = np.cov(draws.T) / np.outer(sd, sd)
    assert found == pytest.approx(model.covariance / np.outer(sd, sd), abs=0.2)
    assert samples.log_evidence.mean() == pytest.approx(model.log_evidence, abs=0.5)
    assert max(r_hat(samples.theta[..., k]) for k in range(3)) < 1.03
    assert samples.log_likelihood.reshape(-1) == pytest.approx(model(draws))


def test_it_takes_thousands_of_points_in_tens_of_batches() -> None:
    model, batches = LinearGaussian(), []

    def counted(theta: Array) -> Array:
        batches.append(len(theta))
        return model(theta)

    samples = sample(counted, [NORMAL] * 3)
    assert set(batches[1:]) == {128}  # chains x particles
    assert batches[0] == 512
    assert len(batches) < 40
    assert sum(batches) == samples.steps[-1].evaluations


@pytest.mark.slow
def test_ranks_of_the_truth_are_uniform() -> None:
    """Simulation-based calibration, Talts et al. (2018): a truth drawn from the prior ranks evenly among the draws."""
    ranks = []
    for seed in range(150):
        rng = np.random.default_rng(seed)
        truth = rng.standard_normal(2)
        blank = LinearGaussian(d=2, sd=0.3)
        model = LinearGaussian(blank.design @ truth + 0.3 * rng.standard_normal(12), d=2, sd=0.3)
        draws = flat(sample(model, [NORMAL] * 2, particles=16, draws=60, seed=seed))
        ranks.append((draws < truth).mean(axis=0))
    for each in np.array(ranks).T:
        assert stats.kstest(each, "uniform").pvalue > 0.01


def banana(theta: Array) -> Array:
    x, y = theta.T
    return -0.5 * ((x - 0.3) / 0.5) ** 2 - 0.5 * ((y - 2 * x**2) / 0.1) ** 2


def islands(theta: Array) -> Array:
    """Two, of which one holds a third."""
    left, right = (-0.5 * ((theta - place) ** 2).sum(axis=1) / 0.15**2 for place in (-1.0, 1.0))
    return np.logaddexp(left + np.log(0.5), right)


def ridge(theta: Array) -> Array:
    """Sum known well, difference not at all."""
    return -0.5 * ((theta.sum(axis=1) - 1.0) / 0.01) ** 2


def on_grid(likelihood: Likelihood, prior: Distribution, low: float, high: float) -> tuple[Array, Array]:
    """Mean and standard deviation of two parameters by quadrature."""
    points = low + (high - low) * (np.arange(1200) + 0.5) / 1200
    theta = np.stack(np.meshgrid(points, points, indexing="ij"), axis=-1).reshape(-1, 2)
    logs = likelihood(theta) + prior.logpdf(theta).sum(axis=1)
    weights = np.exp(logs - logs.max())
    weights /= weights.sum()
    mean = weights @ theta
    return mean, np.sqrt(weights @ (theta - mean) ** 2)


def leaning(theta: Array) -> Array:
    """Largest beyond the upper edge of the first parameter."""
    return -0.5 * ((theta[:, 0] - 1.1) / 0.1) ** 2 - 0.5 * ((theta[:, 1] - 0.5) / 0.05) ** 2


@pytest.mark.slow
@pytest.mark.parametrize(
    ("likelihood", "prior", "low", "high"),
    [
        (banana, NORMAL, -4.0, 8.0),
        (islands, NORMAL, -3.0, 3.0),
        (ridge, UNIFORM, 0.0, 1.0),
        (leaning, UNIFORM, 0.0, 1.0),
    ],
)
def test_shapes_that_are_not_normal(likelihood: Likelihood, prior: Distribution, low: float, high: float) -> None:
    samples = sample(likelihood, [prior] * 2, particles=64, draws=500, seed=3)
    mean, sd = on_grid(likelihood, prior, low, high)
    size = min(effective_size(samples.theta[..., k]) for k in range(2))
    assert size > 80
    assert (abs(flat(samples).mean(axis=0) - mean) < 4 * sd / size**0.5).all()
    assert flat(samples).std(axis=0) == pytest.approx(sd, rel=0.25)


def test_failed_runs_have_no_share_and_are_counted() -> None:
    def half_fails(theta: Array) -> Array:
        return np.where(theta[:, 0] < 0.5, -np.inf, -0.5 * ((theta[:, 1] - 0.3) / 0.1) ** 2)

    samples = sample(half_fails, [UNIFORM, UNIFORM], draws=500)
    draws = flat(samples)
    assert draws[:, 0].min() >= 0.5
    assert draws[:, 0].mean() == pytest.approx(0.75, abs=0.03)
    assert samples.steps[0].failed == np.isneginf(samples.start_log_likelihood).sum() > 200
    assert sum(step.failed for step in samples.steps[1:]) > 0
    assert np.exp(samples.log_evidence).mean() == pytest.approx(0.5 * 0.1 * (2 * np.pi) ** 0.5, rel=0.15)


def test_all_failed_is_said() -> None:
    with pytest.raises(ResultError, match="512 of 512 points of the prior have no likelihood"):
        sample(lambda theta: np.full(len(theta), -np.inf), [UNIFORM])


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_no_number_is_no_likelihood(value: float) -> None:
    with pytest.raises(ValueError, match="finite or -inf"):
        sample(lambda theta: np.full(len(theta), value), [UNIFORM])


def test_populations_that_are_stuck_apart_are_told() -> None:
    """Four narrow islands in five dimensions, and far too few particles to weigh them against each other."""
    places = np.random.default_rng(3).choice([-1.0, 1.0], (4, 5))

    def far_apart(theta: Array) -> Array:
        squares = ((theta[:, None] - places) ** 2).sum(axis=2)
        return np.logaddexp.reduce(-0.5 * squares / 0.03**2, axis=1)

    samples = sample(far_apart, [NORMAL] * 5, particles=8, draws=100, seed=1)
    assert max(r_hat(samples.theta[..., k]) for k in range(5)) > 1.1


class Killed(Exception):
    """Stands for a kill in the middle of a batch."""


@pytest.mark.slow
@pytest.mark.parametrize("batch", [2, 9, 20])
def test_a_killed_sampling_goes_on_to_the_same_bits(tmp_path: Path, batch: int) -> None:
    model, whole = LinearGaussian(), sample(LinearGaussian(), [NORMAL] * 3, seed=4)
    asked = 0

    def killed(theta: Array) -> Array:
        nonlocal asked
        asked += 1
        if asked == batch:
            raise Killed
        return model(theta)

    path = tmp_path / "smc.npz"
    with pytest.raises(Killed):
        sample(killed, [NORMAL] * 3, seed=4, checkpoint=path)
    before = asked
    resumed = sample(killed, [NORMAL] * 3, seed=4, checkpoint=path)
    assert asked - before < len_batches(whole)  # what was stored is not asked for again
    for name in ("theta", "log_likelihood", "start", "start_log_likelihood", "log_evidence"):
        assert getattr(resumed, name).tobytes() == getattr(whole, name).tobytes()
    assert resumed.steps == whole.steps


def len_batches(samples: Posterior) -> int:
    return 1 + sum(step.moves for step in samples.steps)


def test_a_checkpoint_of_something_else_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "smc.npz"
    sample(LinearGaussian(), [NORMAL] * 3, checkpoint=path, identity="the data of Monday")
    with pytest.raises(OptionError, match="checkpoint of another seed, identity; remove it"):
        sample(LinearGaussian(), [NORMAL] * 3, checkpoint=path, identity="the data of Tuesday", seed=9)
    path.write_text("notes")
    with pytest.raises(OptionError, match="is no checkpoint of the sampler"):
        sample(LinearGaussian(), [NORMAL] * 3, checkpoint=path)


def fewer_numbers(data: bytes) -> bytes:
    """The header of an array says that it is smaller, so that NumPy would not read to its checksum."""
    at = data.index(b"'shape': (4, ") + len(b"'shape': (4, ")
    return data[:at] + b"1" + data[at + 1 :]


@pytest.mark.parametrize(
    "spoil",
    [
        lambda data: data[:-30],
        lambda data: data[:900],
        lambda data: data[:2000] + bytes([data[2000] ^ 1]) + data[2001:],
        lambda data: data[:-40] + bytes([data[-40] ^ 4]) + data[-39:],
        fewer_numbers,
    ],
    ids=["its end is cut", "cut", "a bit of a number", "a bit of its directory", "fewer numbers"],
)
def test_a_spoiled_checkpoint_is_refused_in_a_line(tmp_path: Path, spoil: Callable[[bytes], bytes]) -> None:
    path = tmp_path / "smc.npz"
    sample(LinearGaussian(), [NORMAL] * 3, checkpoint=path)
    sound = path.read_bytes()
    assert spoil(sound) != sound
    path.write_bytes(spoil(sound))
    with pytest.raises(OptionError) as refused:
        sample(LinearGaussian(), [NORMAL] * 3, checkpoint=path)
    assert str(refused.value) == f"{path}: is no checkpoint of the sampler, or damaged; remove it to begin anew"


def test_a_start_that_is_given_is_the_first_batch() -> None:
    shares = stats.qmc.Sobol(2, seed=np.random.default_rng(0)).random(256)
    first: list[Array] = []

    def kept(theta: Array) -> Array:
        first.append(theta)
        return -0.5 * ((theta - 0.4) ** 2).sum(axis=1) / 0.1**2

    samples = sample(kept, [UNIFORM] * 2, start=shares)
    assert first[0] == pytest.approx(shares, abs=1e-12)
    spread = samples.start[..., 0].std(axis=1)  # every population spans the prior
    assert spread == pytest.approx([12**-0.5] * 4, rel=0.05)
    with pytest.raises(OptionError, match=r"start: shape \(63, 2\); allowed"):
        sample(kept, [UNIFORM] * 2, start=shares[:63])


@pytest.mark.parametrize(("option", "value"), [("particles", 2), ("chains", 1), ("draws", 0), ("ess_fraction", 1.0)])
def test_options_out_of_range(option: str, value: float) -> None:
    with pytest.raises(OptionError, match=f"{option}: {value} is out of range; allowed"):
        sample(banana, [NORMAL] * 2, **{option: value})  # type: ignore[arg-type]


@pytest.mark.slow
def test_emcee_finds_the_same() -> None:
    samples = sample(banana, [NORMAL] * 2, particles=128, draws=1000, seed=6)

    def log_density(theta: Array) -> Array:
        return banana(theta) - 0.5 * (theta**2).sum(axis=1)

    sampler = emcee.EnsembleSampler(32, 2, log_density, vectorize=True)
    sampler.random_state = np.random.RandomState(0).get_state()
    sampler.run_mcmc(0.1 * np.random.default_rng(0).standard_normal((32, 2)), 6000, skip_initial_state_check=True)
    theirs, ours = sampler.get_chain(discard=1000, thin=20, flat=True), flat(samples)
    for q in (0.05, 0.25, 0.5, 0.75, 0.95):
        assert np.quantile(ours, q, axis=0) == pytest.approx(
            np.quantile(theirs, q, axis=0), abs=0.12 * float(theirs.std(axis=0).max())
        )
