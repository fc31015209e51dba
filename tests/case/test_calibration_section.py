"""The section `[calibration]`: what is read of it, and every refusal."""

from __future__ import annotations

from pathlib import Path

import pytest

from warpgran.case.calibration_section import read_calibration
from warpgran.case.case import Case
from warpgran.case.problems import CaseError
from warpgran.case.read_study import read_study

GOOD = """
[grid]
cells = 100
[calibration]
screening = 64
[calibration.over]
rheology.mu1 = { low = 0.3, high = 0.6 }
"rheology.K" = { mean = 4.0, sd = 1.0, low = 0.0 }
[[calibration.experiments]]
data = "dense"
[[calibration.experiments]]
data = "loose"
set = { column.phi = 0.55 }
"""


def written(folder: Path, text: str) -> Path:
    path = folder / "case.toml"
    path.write_text(text)
    return path


def test_section_is_read_with_priors_experiments_and_overrides(tmp_path: Path) -> None:
    study = read_calibration(written(tmp_path, GOOD), ["calibration.starts=2", "slope.gravity=9.8"])
    assert study.base.grid.cells == 100 and study.base.slope.gravity == 9.8
    assert list(study.priors) == ["rheology.mu1", "rheology.K"]
    assert study.priors["rheology.K"].bounds[0] == 0.0
    assert [(e.data, dict(e.changes)) for e in study.experiments] == [("dense", {}), ("loose", {"column.phi": 0.55})]
    assert (study.section.screening, study.section.starts) == (64, 2)


@pytest.mark.parametrize("key", ["rheology.mu1", '"rheology.mu1"'])
def test_a_prior_can_be_overridden(tmp_path: Path, key: str) -> None:
    path = written(tmp_path, GOOD.replace("rheology.mu1", key))
    study = read_calibration(path, ["calibration.over.rheology.mu1={ low = 0.4, high = 0.5 }"])
    assert study.priors["rheology.mu1"].bounds == (0.4, 0.5)


def test_a_run_leaves_the_section_aside(tmp_path: Path) -> None:
    path = written(tmp_path, GOOD)
    assert len(read_study(path)) == 1
    assert Case.from_toml(path).grid.cells == 100


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "calibration: is missing: a calibration needs the section and its priors"),
        ("[calibration]\n", r"calibration\.over: names no key; allowed: by dotted key \{ low"),
        ("[calibration]\nscreening = 100\n", r"calibration\.screening: 100 is no power of 2.*the next is 128"),
        ("[calibration]\nstart = 3\n", r"calibration\.start: unknown key; did you mean calibration\.starts\?"),
        (
            "[calibration]\ncorrelation = 0.0\n",
            r"calibration\.correlation: 0\.0 is out of range; allowed: > 0 and <= 10",
        ),
        (
            '[calibration.over]\n"slope.angle" = { low = 1.0, high = 2.0 }\n',
            r"calibration\.over\.slope\.angle: cannot be fitted: the measurements give it, in their column angle",
        ),
        (
            '[calibration.over]\n"grid.cells" = { low = 10.0, high = 20.0 }\n',
            r"calibration\.over\.grid\.cells: cannot be fitted: all runs share one grid",
        ),
        (
            '[calibration.over]\n"rheology.mu1" = { low = 0.8, high = 0.9 }\n',
            r"rheology\.mu2: 0\.73 is out of range; .* \(in the middle of the priors\)",
        ),
        (
            '[calibration.over]\n"rheology.mu1" = { low = 0.3, high = 0.6 }\n'
            "[[calibration.experiments]]\nset = { rheology.mu1 = 0.4 }\n",
            r"calibration\.experiments\[0\]\.set\.rheology\.mu1: is fitted by calibration\.over; take one of them out",
        ),
        (
            '[calibration.over]\n"rheology.mu1" = { low = 0.3, high = 0.6 }\n'
            '[[calibration.experiments]]\nfolder = "a"\nset = { "slope.angle" = 3.0, "column.fi" = 0.5 }\n',
            r"\[0\]\.folder: unknown key(.|\n)*slope\.angle: cannot be set(.|\n)*column\.fi: unknown key",
        ),
        (
            "[calibration.over]\nrheology.mu1 = { low = 0.3, high = 0.6 }\n"
            '"rheology.mu1" = { low = 0.3, high = 0.5 }\n',
            r"calibration\.over\.rheology\.mu1: is given twice",
        ),
        (
            "[calibration.over]\nrheology.mu1 = { low = 0.3, high = 0.6 }\n"
            '[[calibration.experiments]]\nset = { column.phi = 0.55, "column.phi" = 0.6 }\n',
            r"calibration\.experiments\[0\]\.set\.column\.phi: is given twice",
        ),
        (
            "[calibration]\nscreening = 8\nchains = 4\n[calibration.over]\n"
            '"rheology.mu1" = { low = 0.3, high = 0.6 }\n"rheology.K" = { low = 0.0, high = 8.0 }\n',
            r"calibration\.screening: 8 is too few for 4 populations of 2 parameters; allowed: >= 16$",
        ),
        (
            '[calibration]\nexperiments = 3\n[calibration.over]\n"rheology.mu1" = { low = 0.3, high = 0.6 }\n',
            r"calibration\.experiments: 3 is not a list of tables; write \[\[calibration\.experiments\]\]",
        ),
        (
            '[calibration]\n[calibration.over]\n"rheology.mu1" = { low = 0.3, high = 0.6 }\n[grid]\ncells = 1\n',
            r"case\.toml: grid\.cells: 1 is out of range",
        ),
    ],
)
def test_what_is_wrong_is_refused(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(CaseError, match=message):
        read_calibration(written(tmp_path, text))
