"""R-hat and effective sample sizes, against what they must be and against ArviZ where that is installed."""

import numpy as np
import pytest

from warpgran.arrays import Array
from warpgran.calibration.diagnostics import effective_size, r_hat, tail_size


def correlated(memory: float, shape: tuple[int, int], seed: int = 1) -> Array:
    """Chains of standard normal draws, each correlated with the one before."""
    rng = np.random.default_rng(seed)
    draws = rng.standard_normal(shape)
    for n in range(1, shape[1]):
        draws[:, n] = memory * draws[:, n - 1] + (1.0 - memory**2) ** 0.5 * draws[:, n]
    return draws


def test_independent_draws_count_in_full() -> None:
    draws = correlated(0.0, (4, 2000))
    assert r_hat(draws) < 1.005
    assert effective_size(draws) == pytest.approx(draws.size, rel=0.1)
    assert tail_size(draws) == pytest.approx(draws.size, rel=0.1)


@pytest.mark.parametrize("memory", [0.5, 0.9])
def test_correlated_draws_count_less(memory: float) -> None:
    draws = correlated(memory, (4, 20000))
    assert effective_size(draws) == pytest.approx(draws.size * (1 - memory) / (1 + memory), rel=0.1)


def test_chains_apart_are_seen_in_place_and_in_spread() -> None:
    draws = correlated(0.0, (4, 500))
    apart = draws + np.array([[0.0], [0.0], [0.0], [2.0]])
    wider = draws * np.array([[1.0], [1.0], [1.0], [3.0]])
    drifting = draws + np.linspace(-1, 1, 500)
    for found in (apart, wider, drifting):
        assert r_hat(found) > 1.05
    assert effective_size(apart) < 20
    assert r_hat(np.tile([[1.0], [2.0]], 8)) == np.inf
    assert r_hat(np.ones((2, 8))) == 1.0


@pytest.mark.parametrize("draws", [100, 101, 250])
@pytest.mark.parametrize("memory", [-0.4, 0.0, 0.5, 0.9])
@pytest.mark.filterwarnings("ignore")  # ArviZ 0.23 speaks of its own future
def test_arviz_finds_the_same(draws: int, memory: float) -> None:
    arviz = pytest.importorskip("arviz")
    found = correlated(memory, (4, draws)) + np.array([[0.0], [0.1], [-0.1], [0.2]])
    assert r_hat(found) == pytest.approx(float(arviz.rhat(found)), rel=1e-12)
    # The two end the same sum a term or two apart.
    assert effective_size(found) == pytest.approx(float(arviz.ess(found)), rel=0.08)
    assert tail_size(found) == pytest.approx(float(arviz.ess(found, method="tail")), rel=0.08)
