"""What a `[sensitivity]` section asks for, and what is refused of it."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from helpers.places import RUNS
from helpers.sweeps import messages, table, write

from warpgran.case.case import Case, CaseError
from warpgran.case.read_study import read_study, sensitivity_design
from warpgran.case.sensitivity_section import read_sensitivity

OVER: dict[str, Any] = {"rheology.K": {"low": 0.0, "high": 8.0}, "slope.angle": {"mean": 16.0, "sd": 1.0}}
TEXT = """
[time]
series = [0.0, 0.25, 0.5]
end = 0.5
[sensitivity]
samples = 8
of = ["run_out", "front", "h_max@0.25"]
[sensitivity.over]
rheology.K = { low = 0.0, high = 8.0 }
"slope.angle" = { mean = 16.0, sd = 1.0 }
"""


def test_a_design_is_a_study(tmp_path: Path) -> None:
    study = read_study(write(tmp_path, TEXT))
    assert study.keys == ("rheology.K", "slope.angle")
    assert len(study) == 8 * 4
    assert study[5].rheology.K == study.values("rheology.K")[5]
    again = sensitivity_design(
        Case().with_(**{"time.end": 0.5, "time.series": [0.0, 0.25, 0.5]}), OVER, samples=8, of=["run_out"]
    )
    assert table(again) == table(study)


@pytest.mark.parametrize("path", sorted(RUNS.glob("sensitivity_*.toml")), ids=lambda path: path.stem)
def test_run_files_load(path: Path) -> None:
    study = read_study(path)
    assert study.base.title
    assert study.design
    assert study.base.time.stop_at_rest


def test_no_profiles_that_nobody_asked_for(tmp_path: Path) -> None:
    assert read_study(write(tmp_path, TEXT)).base.snapshot_times == ()
    asked = TEXT.replace("[time]", "[time]\nsnapshots = [0.5]")
    assert read_study(write(tmp_path, asked)).base.snapshot_times == (0.5,)
    assert sensitivity_design(Case(), OVER, samples=2).base.snapshot_times == ()


def test_the_section_in_force_goes_with_the_study(tmp_path: Path) -> None:
    study = read_study(write(tmp_path, TEXT), ["sensitivity.samples=4", "sensitivity.over.rheology.K.high=2"])
    assert len(study) == 4 * 4
    assert max(study.values("rheology.K")) < 2.0
    again = read_study(write(tmp_path, TEXT.partition("[sensitivity]")[0] + study.design))
    assert again.design == study.design
    assert table(again) == table(study)
    assert read_study(write(tmp_path, "")).design == ""


def test_the_section_in_force_keeps_the_order_of_keys_of_mixed_sections(tmp_path: Path) -> None:
    over = {
        "rheology.K": OVER["rheology.K"],
        "slope.angle": OVER["slope.angle"],
        "rheology.mu1": {"low": 0.4, "high": 0.5},
    }
    study = sensitivity_design(Case(), over, samples=2)
    assert table(read_study(write(tmp_path, study.design))) == table(study)


def test_defaults_follow_the_method() -> None:
    sobol, morris = (read_sensitivity({"over": OVER, "method": method}) for method in ("sobol", "morris"))
    assert (sobol.size, sobol.per_sample, sobol.of) == (256, 4, ("run_out",))
    assert (morris.size, morris.per_sample) == (32, 3)
    assert read_sensitivity({"over": OVER}) == sobol


def refused(**section: Any) -> dict[str, str]:
    with pytest.raises(CaseError) as caught:
        sensitivity_design(Case(), **({"over": OVER} | section))
    return messages(caught.value)


@pytest.mark.parametrize(
    ("section", "key", "words"),
    [
        ({"over": {}}, "sensitivity.over", "names no key"),
        ({"over": 3}, "sensitivity.over", "3 is not a table of keys"),
        ({"over": {"slope.angle": [1, 2]}}, "sensitivity.over.slope.angle", "[1, 2] is not a distribution"),
        ({"method": "fast"}, "sensitivity.method", '"fast" is not known; allowed: "sobol" or "morris"'),
        ({"samples": 100}, "sensitivity.samples", "100 is no power of 2, .*; next: 128"),
        ({"samples": 1}, "sensitivity.samples", "1 is out of range; allowed: >= 2"),
        ({"samples": 2.0}, "sensitivity.samples", "not a whole number"),
        ({"samples": 2**18}, "sensitivity.samples", "asks for 1048576 runs; allowed: 1000000"),
        ({"samples": 400_000, "method": "morris"}, "sensitivity.samples", "asks for 1200000 runs"),
        ({"seed": -1}, "sensitivity.seed", "-1 is out of range; allowed: >= 0"),
        ({"of": "run_out"}, "sensitivity.of", '"run_out" is not a list; allowed: a list of run_out'),
        ({"of": []}, "sensitivity.of", "asks for nothing"),
        ({"of": [f"front@{n}" for n in range(51)]}, "sensitivity.of", "asks for 51 results; allowed: 50"),
        ({"of": [3]}, "sensitivity.of[0]", "3 is not text"),
        ({"of": ["run_out", "run_out"]}, "sensitivity.of[1]", "run_out is given twice"),
        ({"of": ["runout"]}, "sensitivity.of[0]", '"runout" is no result of a run; did you mean run_out?'),
        ({"of": ["zzz"]}, "sensitivity.of[0]", '"zzz" is no result of a run; allowed: run_out, h_max_final'),
        ({"of": ["run_out@1"]}, "sensitivity.of[0]", "run_out is no series; allowed before @: front"),
        ({"of": ["front@soon"]}, "sensitivity.of[0]", '"soon" is no time; allowed after @: a number >= 0, in s'),
        ({"of": ["front@-1"]}, "sensitivity.of[0]", '"-1" is no time'),
        ({"of": ["front@nan"]}, "sensitivity.of[0]", '"nan" is no time'),
        ({"of": ["front@0.5"]}, "sensitivity.of[0]", "0.5 s is none of the times of time.series; the nearest are 0.49"),
        ({"sampels": 8}, "sensitivity.sampels", "unknown key; did you mean samples?"),
    ],
)
def test_sections_that_are_refused(section: dict[str, Any], key: str, words: str) -> None:
    found = refused(**section)
    where = key if key in found else key.partition("[")[0]
    assert found.keys() == {where}
    assert re.search(re.escape(words).replace(r"\.\*", ".*"), found[where])


@pytest.mark.parametrize(
    ("text", "key", "words"),
    [
        ("sensitivity = 3", "sensitivity", "3 is not a table of keys"),
        ("[sensitivity]", "sensitivity.over", "names no key"),
        (TEXT + "[sweep.over]\nslope.angle = [1]", "sensitivity", "has no part beside [sweep]"),
        (TEXT.replace("series = [0.0, 0.25, 0.5]", "series = []"), "sensitivity.of[2]", "the runs have no samples"),
        (TEXT + '"column.phi" = {low = 0.5, high = 1.5}', "column.phi", "is out of range; allowed: > 0 and < 1 ("),
    ],
)
def test_files_that_are_refused(tmp_path: Path, text: str, key: str, words: str) -> None:
    with pytest.raises(CaseError) as caught:
        read_study(write(tmp_path, text))
    assert any(problem.key == key and words in problem.message for problem in caught.value.problems), caught.value


def test_what_is_wrong_elsewhere_is_said_too(tmp_path: Path) -> None:
    with pytest.raises(CaseError) as caught:
        read_study(write(tmp_path, TEXT.replace("samples = 8", "samples = 7") + "[slope]\nangel = 3"))
    assert [problem.key for problem in caught.value.problems] == ["sensitivity.samples", "slope.angel"]


def test_an_override_that_the_design_would_undo(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match=r"slope\.angle: the design varies it .* set sensitivity\.over\.slope\.angle"):
        read_study(write(tmp_path, TEXT), ["slope.angle=3"])


def test_a_design_is_no_case(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match="sensitivity: is a design of several runs, and a case is one"):
        Case.from_toml(write(tmp_path, TEXT))
