"""What overrides leave of the title of a run file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import warpgran as wg
from warpgran.case.identity import identity

FILE = """title = "Dense column, 22 degrees"
[slope]
angle = 22.0
"""
TITLE = "Dense column, 22 degrees"
LONG = [0.001 * n for n in range(30)]


@pytest.mark.parametrize(
    ("overrides", "title"),
    [
        (["slope.angle=5"], f"{TITLE} [slope.angle = 5]"),
        (["slope.angle=5", "rheology.phi_eq=f1"], f"{TITLE} [slope.angle = 5, rheology.phi_eq = f1]"),
        (["slope.angle=5", "slope.angle=7"], f"{TITLE} [slope.angle = 7]"),
        (["slope.angle=22"], TITLE),
        (["slope.angle=5", "slope.angle=22.0"], TITLE),
        (["time.snapshots=[]", "scheme.window=false", "time.series={every=0.1}"], TITLE),
        (["slope.angle=5", "title=Flat"], "Flat"),
        ([], TITLE),
    ],
)
def test_a_title_names_what_was_changed(tmp_path: Path, overrides: list[str], title: str) -> None:
    path = tmp_path / "a.toml"
    path.write_text(FILE)
    assert wg.Case.from_toml(path, overrides).title == title
    assert wg.read_study(path, overrides).base.title == title


def test_a_sweep_that_is_set_is_named_briefly(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text(FILE)
    study = wg.read_study(path, ["sweep.over.slope.angle=[0, 10]"])
    assert study.base.title == study[1].title == f"{TITLE} [sweep.over.slope.angle = [0, 10]]"
    title = wg.read_study(path, [f"sweep.over.slope.angle={LONG}"]).base.title
    assert len(title) < 110
    assert title.endswith("...]")


def test_no_title_stays_none_and_a_wrong_one_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text("")
    assert wg.Case.from_toml(path, ["slope.angle=5"]).title == ""
    path.write_text("title = 3")
    with pytest.raises(wg.CaseError, match="title: 3 is not text"):
        wg.Case.from_toml(path, ["slope.angle=5"])


def test_the_title_is_no_part_of_the_identity(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text(FILE)
    assert identity(wg.Case.from_toml(path, ["slope.angle=5"])) == identity(wg.Case().with_(slope={"angle": 5.0}))


def test_a_change_in_python_is_named_as_on_the_command_line(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text(FILE)
    case = wg.Case.from_toml(path, ["slope.angle=5"])
    steeper = case.with_(slope={"angle": np.float64(16.0)}, rheology={"K": 0.0})
    assert steeper.title == f"{TITLE} [slope.angle = 16, rheology.K = 0]"
    assert steeper.with_(slope={"angle": None}).title == f"{TITLE} [slope.angle = default, rheology.K = 0]"
    assert case.with_(slope={"angle": 16.0}, title="Less steep").title == "Less steep"
    assert case.with_(time={"series": []}, scheme={"window": False}).title == case.title
    first = case.with_(scheme={"order": 1, "xi": np.array([2.0, 2.0, 5.0])})
    assert first.title == f"{TITLE} [slope.angle = 5, scheme.order = 1, scheme.xi = [2.0, 2.0, 5.0]]"
    assert wg.Case().with_(slope={"angle": 5.0}).title == ""
    with pytest.raises(wg.CaseError, match=r"slope\.angle: "):
        case.with_(slope={"angle": object()})


def test_a_sweep_in_python_is_named_and_no_single_value_of_what_it_varies() -> None:
    case = wg.Case(title=TITLE).with_(slope={"angle": 5.0}, rheology={"K": 1.0})
    study = case.sweep({"slope.angle": [0, 10]})
    assert study.base.title == study[1].title == f"{TITLE} [rheology.K = 1, sweep.over.slope.angle = [0, 10]]"
    assert case.sweep({"column.phi": [0.55, 0.6]}).base.title == case.title
    given = wg.Study.of([case, case.with_(slope={"angle": 7.0})])
    assert given.base.title == f"{TITLE} [rheology.K = 1]"
    assert [each.title for each in given] == [case.title, f"{TITLE} [slope.angle = 7, rheology.K = 1]"]
