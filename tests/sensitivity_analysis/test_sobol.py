"""Sobol indices: exact ones, those of other programs, and their intervals."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from helpers.designs import Function, g_function, g_indices, ishigami, ishigami_indices
from scipy import stats

from warpgran.arrays import Array
from warpgran.case.sensitivity_design import saltelli
from warpgran.sensitivity_analysis.sobol import SobolIndices, sobol

EXACT = [(ishigami, ishigami_indices, 3), (g_function, g_indices, 4)]


def found(f: Function, d: int, n: int = 4096, seed: int = 1) -> tuple[Array, SobolIndices]:
    y = f(saltelli(n, d, seed))
    return y, sobol(y[:, :, None], seed)


@pytest.mark.parametrize(("f", "exact", "d"), EXACT, ids=["ishigami", "g"])
def test_exact_indices(f: Function, exact: Callable[[], tuple[Array, Array]], d: int) -> None:
    _, indices = found(f, d, n=16384)
    for estimate, wanted in zip(indices, exact(), strict=True):
        np.testing.assert_allclose(estimate.value[0], wanted, atol=0.01)
        assert (estimate.low[0] <= wanted).all()
        assert (wanted <= estimate.high[0]).all()


def test_intervals_contain_the_exact_index_about_as_often_as_they_say() -> None:
    wanted = np.array(g_indices())
    hits = []
    for seed in range(40):
        estimates = [estimate for estimate in found(g_function, 4, 256, seed)[1]]
        hits.append([(e.low[0] <= w) & (w <= e.high[0]) for e, w in zip(estimates, wanted, strict=True)])
    share = np.mean(hits)  # of 320, correlated; Sobol points are more even than the bootstrap believes
    assert 0.90 <= share <= 1.0


def test_a_linear_model_has_no_interactions() -> None:
    weights = np.array([3.0, 2.0, 1.0])
    _, indices = found(lambda x: x @ weights, 3)
    for estimate in indices:
        np.testing.assert_allclose(estimate.value[0], weights**2 / (weights**2).sum(), atol=2e-3)


def test_a_parameter_without_a_part_has_a_total_of_0() -> None:
    _, indices = found(lambda x: x[..., 0], 2)
    assert indices.total_order.value[0, 1] == 0.0
    assert (indices.total_order.low[0, 1], indices.total_order.high[0, 1]) == (0.0, 0.0)


@pytest.mark.parametrize("f", [ishigami, lambda x: 100.0 + 1e-3 * ishigami(x)])
def test_the_same_as_scipy(f: Function) -> None:
    y, indices = found(f, 3, n=256)
    run = {"f_A": y[:, 0][None], "f_B": y[:, 1][None], "f_AB": y[:, 2:].T[:, None]}
    theirs = stats.sobol_indices(func=run, n=256)
    np.testing.assert_allclose(indices.first_order.value[0], theirs.first_order, rtol=1e-9)
    np.testing.assert_allclose(indices.total_order.value[0], theirs.total_order, rtol=1e-9)


def test_the_same_as_salib() -> None:
    analyse = pytest.importorskip("SALib.analyze.sobol").analyze
    y, indices = found(g_function, 4, n=1024)
    rows = np.concatenate([y[:, :1], y[:, 2:], y[:, 1:2]], axis=1).ravel()  # their order: A, AB, B
    problem = {"num_vars": 4, "names": list("abcd"), "bounds": [[0.0, 1.0]] * 4}
    theirs = analyse(problem, rows, calc_second_order=False, seed=1, num_resamples=999)
    # Same estimators; the variance is theirs of A and B, normalized by the standard deviation of all runs.
    np.testing.assert_allclose(indices.first_order.value[0], theirs["S1"], atol=2e-3)
    np.testing.assert_allclose(indices.total_order.value[0], theirs["ST"], atol=2e-3)
    ours = (indices.total_order.high - indices.total_order.low)[0] / 2
    np.testing.assert_allclose(ours, theirs["ST_conf"], rtol=0.3)


def test_an_output_that_does_not_vary_has_no_indices() -> None:
    x = saltelli(64, 2, 1)
    y = np.stack([np.full(x.shape[:2], 3.0), 3.0 + 1e-12 * x[..., 0], 3.0 + 1e-6 * x[..., 0]], axis=2)
    first, total = sobol(y, 1)
    for estimate in (first, total):
        for array in estimate:
            assert np.isnan(array[:2]).all()
            assert np.isfinite(array[2]).all()
    np.testing.assert_allclose(total.value[2], [1.0, 0.0], atol=0.05)


def test_outputs_do_not_touch_each_other(monkeypatch: pytest.MonkeyPatch) -> None:
    x = saltelli(64, 3, 1)
    y = np.stack([ishigami(x), 1e6 * ishigami(x[..., ::-1]), np.full(x.shape[:2], np.nan)], axis=2)
    together = sobol(y, 1)
    for k in range(2):
        alone = sobol(y[:, :, k : k + 1], 1)
        for a, b in zip(together, alone, strict=True):
            np.testing.assert_allclose(np.array(a)[:, k], np.array(b)[:, 0], rtol=1e-9, atol=1e-12)
    assert np.isnan(together.first_order.value[2]).all()
    monkeypatch.setattr("warpgran.sensitivity_analysis.sobol.AT_ONCE", 1)  # an output at a time
    for a, b in zip(together, sobol(y, 1), strict=True):
        np.testing.assert_allclose(np.array(a), np.array(b), rtol=1e-9, atol=1e-12)


def test_any_number_of_samples_will_do() -> None:
    y = ishigami(saltelli(1024, 3, 1))[:1000, :, None]
    np.testing.assert_allclose(sobol(y, 1).first_order.value[0], ishigami_indices()[0], atol=0.05)


def test_the_seed_decides_the_intervals() -> None:
    y = ishigami(saltelli(64, 3, 1))[:, :, None]
    assert np.array_equal(sobol(y, 1).first_order.low, sobol(y, 1).first_order.low)
    assert not np.array_equal(sobol(y, 1).first_order.low, sobol(y, 2).first_order.low)


def test_of_few_samples_the_intervals_may_be_infinite_and_nothing_is_warned_of() -> None:
    """Resamples of one sample alone do not vary; pytest makes an error of the warnings that NumPy had for them."""
    first, total = sobol(np.array([[1.0, 1.0, 2.0], [3.0, 3.0, 5.0]])[:, :, None], seed=1)
    assert np.isfinite([first.value, total.value]).all()
    assert [float(end.item()) for end in (first.low, first.high, total.high)] == [-np.inf, np.inf, np.inf]
