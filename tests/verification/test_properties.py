"""What holds of any run that is accepted: quasi-random points of the whole space, and points that hypothesis draws."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from helpers.cases import DIVERGING, small
from hypothesis import given, settings
from hypothesis import strategies as st

import warpgran as wg
from warpgran.case.case import Case
from warpgran.run.options import Precision
from warpgran.verification import properties
from warpgran.verification.properties import PRECISIONS, Findings, examine, points, run_files
from warpgran.verification.space import AXES, SCALES, case_at

RUNS = 64  # of each scale and precision


def drawn_at(point: Sequence[float], scale: float, order: int, precision: str) -> Case:
    """The case at a point, but of fewer codes to compile; `warpgran verify --deep` has all of them."""
    case = case_at(point, scale, order, precision)
    changes: dict[str, Any] = {"scheme.lambda": 0.0, "scheme.relaxation": "rational"} if order == 1 else {}
    if case.scheme.alpha != 2.0:
        changes |= dict.fromkeys(("scheme.left", "scheme.right"), "wall")
    if case.scheme.alpha != 2.0 or case.scheme.periodic:
        changes |= {"rheology.phi_eq": "f2", "rheology.phi_eq_N": 1.0}
    return case.with_(**changes)


def assert_sound(findings: Findings) -> None:
    files = run_files(findings)
    assert not files, "\n\n".join(list(files.values())[:3])


@pytest.mark.slow
@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("order", [1, 2])
def test_any_run_that_is_accepted_is_sound(order: int, scale: float, precision: Precision) -> None:
    findings = Findings()
    cases = [drawn_at(point, scale, order, precision) for point in points(scale, RUNS, seed=1)]
    examine(cases, precision, findings)
    assert_sound(findings)
    assert findings.runs == RUNS
    assert findings.unfinished <= 1
    assert findings.speed > 0.3  # something moved, and what is compared is near


@pytest.mark.slow
@given(
    point=st.tuples(*[st.just(0.0) | st.floats(1e-20, 1.0, exclude_max=True)] * len(AXES)),
    scale=st.sampled_from(SCALES),
    order=st.sampled_from([1, 2]),
    precision=st.sampled_from(PRECISIONS),
)
@settings(max_examples=60)
def test_any_point_of_the_space_is_sound(
    point: tuple[float, ...], scale: float, order: int, precision: Precision
) -> None:
    findings = Findings()
    examine([drawn_at(point, scale, order, precision)], precision, findings)
    assert_sound(findings)


def test_the_corners_of_the_space_are_accepted() -> None:
    last = np.nextafter(1.0, 0.0)
    for scale in SCALES:
        for precision in PRECISIONS:
            for axis in range(len(AXES)):
                point = np.full(len(AXES), 0.5)
                for end in (0.0, last):
                    point[axis] = end
                    case_at(point, scale, 1 + axis % 2, precision)
    both = case_at(np.zeros(len(AXES)), 1e-3, 1), case_at(np.full(len(AXES), last), 10.0, 1)
    assert [case.grid.cells for case in both] == [10, 300]
    assert [case.slope.angle for case in both] == pytest.approx([-80.0, 80.0])


def test_a_fault_is_told_with_a_run_file_that_has_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """A run that diverges, and one of which a bound is asked that it does not hold."""
    findings = Findings()
    sampled: dict[str, Any] = {"time.series": {"every": 0.1}}
    diverging = small(**DIVERGING, **sampled)
    monkeypatch.setattr(properties, "speed_bound", lambda case, t: 0.1 + 0.0 * t)
    examine([small(**sampled), diverging], "float64", findings)
    assert [what.partition(",")[0].split(" ")[0] for what, _, _ in findings.faults] == ["|v|", "diverged"]
    for text, case in zip(run_files(findings).values(), [findings.faults[0][1], diverging], strict=True):
        assert Case.from_dict(tomllib.loads(text)) == case


def test_float32_refuses_an_alpha_it_cannot_hold() -> None:
    case = small(**{"scheme.alpha": 5.1})
    with pytest.raises(wg.CaseError, match=r"^scheme.alpha: 5.1 is out of range in float32; allowed: > 1 and <= 5"):
        wg.simulate([small(), case], precision="float32")
    assert wg.simulate(case)["status"] == 0
