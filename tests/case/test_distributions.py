"""Distributions of parameters: the values and densities of scipy.stats, and what is refused."""

from __future__ import annotations

import math
import subprocess
import sys
from typing import Any

import numpy as np
import pytest
from helpers.sweeps import messages
from hypothesis import given
from hypothesis import strategies as st
from scipy import integrate, stats

from warpgran.case.distributions import Distribution, read_over
from warpgran.case.problems import CaseError

U = np.linspace(0.0, 1.0, 101)[1:-1]
FORMS: list[tuple[dict[str, Any], Any, tuple[float, float]]] = [
    ({"low": -2.0, "high": 8}, stats.uniform(-2.0, 10.0), (-2.0, 8.0)),
    ({"low": 1e-4, "high": 1e-2, "scale": "log"}, stats.loguniform(1e-4, 1e-2), (1e-4, 1e-2)),
    ({"low": 1e-4, "high": 1e-2, "log": True}, stats.loguniform(1e-4, 1e-2), (1e-4, 1e-2)),
    ({"low": 0.0, "high": 1.0, "scale": "linear"}, stats.uniform(0.0, 1.0), (0.0, 1.0)),
    ({"mean": 0.48, "sd": 0.05}, stats.norm(0.48, 0.05), (-math.inf, math.inf)),
    ({"mean": 0.5, "sd": 0.1, "low": 0.3, "high": 0.7}, stats.truncnorm(-2.0, 2.0, 0.5, 0.1), (0.3, 0.7)),
    ({"mean": 0.5, "sd": 0.1, "low": 0.3}, stats.truncnorm(-2.0, math.inf, 0.5, 0.1), (0.3, math.inf)),
    ({"mean": 0.5, "sd": 0.1, "high": 0.6}, stats.truncnorm(-math.inf, 1.0, 0.5, 0.1), (-math.inf, 0.6)),
]


def one(table: Any) -> Distribution:
    return read_over({"rheology.K": table}, "sensitivity.over")["rheology.K"]


@pytest.mark.parametrize(("table", "law", "bounds"), FORMS, ids=[str(table) for table, *_ in FORMS])
def test_values_and_densities_are_those_of_scipy(table: dict[str, Any], law: Any, bounds: tuple[float, float]) -> None:
    found = one(table)
    assert found.bounds == bounds
    values = found.ppf(U)
    np.testing.assert_allclose(values, law.ppf(U), rtol=1e-12)
    np.testing.assert_allclose(found.logpdf(values), law.logpdf(values), rtol=1e-12)
    assert (np.diff(values) > 0.0).all()


@pytest.mark.parametrize(("table", "law", "bounds"), FORMS, ids=[str(table) for table, *_ in FORMS])
def test_the_density_integrates_to_the_probability(
    table: dict[str, Any], law: Any, bounds: tuple[float, float]
) -> None:
    found = one(table)
    x = found.ppf(np.linspace(0.01, 0.99, 20_001))
    assert integrate.trapezoid(np.exp(found.logpdf(x)), x) == pytest.approx(0.98, abs=1e-6)


@pytest.mark.parametrize("table", [table for table, _, bounds in FORMS if math.isfinite(bounds[0] + bounds[1])])
def test_nothing_lies_beyond_the_bounds(table: dict[str, Any]) -> None:
    found = one(table)
    low, high = found.bounds
    assert found.ppf(np.array([0.0, 1.0])).tolist() == pytest.approx([low, high], rel=1e-12)
    assert found.logpdf(np.array([low - 1.0, high + 1.0])).tolist() == [-math.inf, -math.inf]


@given(st.floats(1e-6, 1e6), st.floats(1.0 + 1e-6, 1e6), st.floats(0.0, 1.0), st.booleans())
def test_rounding_takes_no_value_past_a_bound(low: float, factor: float, u: float, log: bool) -> None:
    high = low * factor
    value = float(one({"low": low, "high": high, "log": log}).ppf(np.array(u)))
    assert low <= value <= high


def test_a_normal_distribution_has_no_bound() -> None:
    assert one({"mean": 1.0, "sd": 2.0}).ppf(np.array([0.0, 1.0])).tolist() == [-math.inf, math.inf]


def test_keys_may_be_dotted_or_nested() -> None:
    table = {"low": 0.0, "high": 1.0}
    found = read_over({"rheology": {"K": table, "mu1": table}, "slope.angle": table}, "sensitivity.over")
    assert [*found] == ["rheology.K", "rheology.mu1", "slope.angle"]
    again = read_over(found, "calibration.over")  # what Python hands on
    assert again == found


def test_what_it_is_in_words() -> None:
    assert [str(one(table)) for table, *_ in FORMS[:6]] == [
        "-2 to 8",
        "0.0001 to 0.01, logarithmic",
        "0.0001 to 0.01, logarithmic",
        "0 to 1",
        "normal, 0.48 ± 0.05",
        "normal, 0.5 ± 0.1, 0.3 to 0.7",
    ]


REFUSED: list[tuple[Any, dict[str, str]]] = [
    (3, {"": "3 is not a table of keys"}),
    ({}, {"": "names no key; allowed: by dotted key { low = , high = } or { mean = , sd = }"}),
    ({"rheology.K": [0, 1]}, {".rheology.K": "[0, 1] is not a distribution; allowed: { low = , high = } or"}),
    ({"rheology.K": {}}, {".rheology.K.low": "is missing", ".rheology.K.high": "is missing"}),
    ({"rheology.K": {"low": 0}}, {".rheology.K.high": "is missing; allowed: { low = , high = } or"}),
    ({"rheology.K": {"mean": 0}}, {".rheology.K.sd": "is missing"}),
    ({"rheology.K": {"sd": 1, "low": 0, "high": 3}}, {".rheology.K.mean": "is missing"}),
    ({"rheology.K": {"mean": 1, "sd": 0}}, {".rheology.K.sd": "0 is out of range; allowed: > 0"}),
    ({"rheology.K": {"mean": 1, "std": 1}}, {".rheology.K.std": "unknown key; did you mean sd?"}),
    ({"rheology.K": {"low": "a", "high": 3}}, {".rheology.K.low": '"a" is not a number; allowed: a number'}),
    ({"rheology.K": {"low": 0, "high": math.inf}}, {".rheology.K.high": "inf is not a finite number"}),
    ({"rheology.K": {"low": 3, "high": 3}}, {".rheology.K.low": "3.0 is out of range; allowed: < high, which is 3.0"}),
    (
        {"rheology.K": {"low": 0, "high": 3, "scale": "log"}},
        {".rheology.K.low": "0.0 is out of range; allowed with sc"},
    ),
    ({"rheology.K": {"low": 1, "high": 3, "scale": "ln"}}, {".rheology.K.scale": '"ln" is not known; allowed: "lin'}),
    ({"rheology.K": {"low": 1, "high": 3, "scale": "log", "log": True}}, {".rheology.K.log": "has no part beside sca"}),
    ({"rheology.K": {"mean": 1, "sd": 1, "scale": "log"}}, {".rheology.K": "is normal, and has no logarithmic scale"}),
    ({"rheology.K": {"mean": 1, "sd": 0.01, "low": 5}}, {".rheology.K": "has no probability between low and high"}),
    ({"rheology.k": {"low": 0, "high": 3}}, {".rheology.k": "unknown key; did you mean rheology.K?"}),
    ({"rheology.phi_eq": {"low": 0, "high": 3}}, {".rheology.phi_eq": "holds no number"}),
    ({"time.end": {"low": 1, "high": 3}}, {".time.end": "cannot be swept: all runs of a file share"}),
    (
        {"rheology": {"K": {"low": 0, "high": 1}}, "rheology.K": {"low": 0, "high": 1}},
        {".rheology.K": "is given twice"},
    ),
]


@pytest.mark.parametrize(("over", "wanted"), REFUSED, ids=[str(over) for over, _ in REFUSED])
def test_what_is_refused(over: Any, wanted: dict[str, str]) -> None:
    with pytest.raises(CaseError) as caught:
        read_over(over, "sensitivity.over")
    found = messages(caught.value)
    assert found.keys() == {f"sensitivity.over{key}" for key in wanted}
    for key, words in wanted.items():
        assert words in found[f"sensitivity.over{key}"]


def test_all_problems_at_once() -> None:
    with pytest.raises(CaseError) as caught:
        read_over({"rheology.K": {"low": 1}, "slope.angel": {}, "slope.angle": 3}, "calibration.over")
    assert [problem.key for problem in caught.value.problems] == [
        "calibration.over.rheology.K.high",
        "calibration.over.slope.angel",
        "calibration.over.slope.angle",
    ]


def test_scipy_waits_until_it_is_asked_for() -> None:
    code = "import warpgran.case.distributions, sys; print('scipy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout == "False\n"
