"""`warpgran verify`: every case on coarse grids, what a wrong solution gives, the page, and the command."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from helpers.places import DOCS
from matplotlib.figure import Figure
from typer.testing import CliRunner, Result

from warpgran.cli.app import app
from warpgran.verification import collection, dams, exact, manufactured, uniform
from warpgran.verification.check import CheckOptions, CheckResult, Row
from warpgran.verification.grids import compare, computed, coulomb, falling, observed_order, of_constant_phi
from warpgran.verification.report import PAGE, write

COARSE = CheckOptions(grids=4)
ASYMPTOTIC = {"riemann": 6, "sliding": 5}
"""Grids on which slow shocks and the layer at the speed of its waves come to the order that is asked."""
DOCUMENT = DOCS / "verification.md"


LIMITS = ("convergence", "columns")  # which have no coarse grids here, and tests of their own


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in collection.CASES if name not in LIMITS])
def test_holds_on_coarse_grids(name: str) -> None:
    options = CheckOptions(grids=ASYMPTOTIC[name]) if name in ASYMPTOTIC else COARSE
    outcome = collection.run({name: collection.CASES[name]}, options)[name]
    assert [row.compared for row in outcome.rows if row.holds is False] == []
    assert any(row.holds for row in outcome.rows)
    assert outcome.figures and all(str(figure.get_label()).endswith(".") for figure in outcome.figures.values())


@pytest.mark.slow
def test_holds_in_single_precision() -> None:
    names = ("stoker", "uniform", "relaxation")
    outcomes = collection.run(collection.chosen(names), CheckOptions(precision="float32", grids=4))
    assert {name: [r.compared for r in o.rows if r.holds is False] for name, o in outcomes.items()} == {
        name: [] for name in names
    }


@pytest.mark.parametrize(("h_0", "g_c"), [(0.103, 9.81), (0.1, 10.1)])
def test_a_solution_that_is_off_by_three_percent_does_not_hold(h_0: float, g_c: float) -> None:
    start = dams.dam(1, 0.1, 0.02, -1.0, 1.0, **coulomb(0.0))
    wrong = of_constant_phi(lambda x, t: exact.stoker(x, t, h_0, 0.02, g_c))
    found = compare(CheckOptions(grids=5, order=1), start, wrong, (0.6,), 100)
    assert found.row("h v", 0, 0.5, 0.05).holds is False


@pytest.mark.slow
@pytest.mark.parametrize("order", [1, 2])
def test_a_wrong_source_does_not_hold(order: int, monkeypatch: pytest.MonkeyPatch) -> None:
    right = manufactured.sources
    monkeypatch.setattr(manufactured, "sources", lambda x, t, case: 1.02 * right(x, t, case))
    monkeypatch.setattr(manufactured, "VARIANTS", {order: {"defaults": {}}})
    assert not manufactured.manufactured(CheckOptions(grids=5, order=order)).holds


@pytest.mark.parametrize("h", [0.05, 0.02, 0.01, 0.005, 0.002])
def test_thin_layers_feel_too_little_of_gravity_and_friction(h: float) -> None:
    """By 1 - z/(2 h) over a step z of the bed less friction, by h/(2 z) where z > h: docs/verification.md."""
    theta, delta = np.radians(35.0), np.radians(20.0)
    case = uniform.layer(1, 20, h, 0.0, 0.6, [0.2], **{"slope.angle": 35.0}, **coulomb(float(np.tan(delta))))
    z = case.dx * (np.tan(theta) - np.tan(delta))
    share = 1.0 - z / (2.0 * h) if z < h else h / (2.0 * z)
    v = computed(case, CheckOptions()).v[0]
    assert v == pytest.approx(0.2 * exact.acceleration(theta, delta, 9.81) * share, rel=1e-12)


def test_order_is_the_slope_over_the_three_finest() -> None:
    errors = [(50, 9.0), (100, 4.0), (200, 2.0), (400, 1.0)]
    assert observed_order(errors) == pytest.approx(1.0)
    assert falling("x", "-", errors, 0.9, 1.5).holds is True
    assert falling("x", "-", errors, 1.1, 1.5).holds is False
    assert falling("x", "-", errors, 0.9, 0.5).holds is False
    assert falling("x", "-", [(n, 0.01) for n, _ in errors], 0.5, 1.0).holds is False
    assert falling("x", "-", [(n, 0.0) for n, _ in errors], 0.5, 1.0).holds is True
    assert falling("x", "-", [(n, np.nan) for n, _ in errors], 0.5, 1.0).holds is False


def test_cases_are_chosen_by_name() -> None:
    assert list(collection.chosen([])) == list(collection.CASES)
    assert list(collection.chosen(["cap", "ritter"])) == ["ritter", "cap"]
    with pytest.raises(ValueError, match="'Riter' is not a case; did you mean ritter\\? allowed: rest, ritter"):
        collection.chosen(["cap", "Riter"])


def test_long_cases_run_when_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(collection, "DEEP", {"long": lambda options: CheckResult("", (), ())})
    assert "long" not in collection.chosen([])
    assert list(collection.chosen([], deep=True))[-1] == "long"
    assert list(collection.chosen(["cap"], deep=True)) == ["cap", "long"]
    assert list(collection.chosen(["long"])) == ["long"]


def broken(options: CheckOptions) -> CheckResult:
    raise RuntimeError("a run with 4 cells did not reach its end")


def test_a_run_that_breaks_off_does_not_hold() -> None:
    outcome = collection.run({"broken": broken}, COARSE)["broken"]
    assert not outcome.holds
    assert outcome.text == ("a run with 4 cells did not reach its end",)


def test_the_page_holds_everything(tmp_path: Path) -> None:
    figure = Figure()
    figure.set_label("A figure.")
    errors = ((10, 0.2), (20, 0.1))
    rows = (Row("h, L1", 0.1, "-", "<= 1", True, 1.0, errors), Row("v", 2.0, "m/s", "<= 1", False))
    outcome = CheckResult("A < B", ("Some text.",), rows, {"figure": figure}, {"failed.toml": 'title = "x"'})
    page = write({"one": outcome}, tmp_path, COARSE)
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "failed.toml", "figure.png", "verification.csv", PAGE
    ]  # fmt: skip
    html = page.read_text()
    for words in (
        "A &lt; B",
        "Some text.",
        "A figure.",
        "1 of 2",
        "20 cells",
        "1.00e-01",
        "title = ",
        "data:image/png",
    ):
        assert words in html, words
    with (tmp_path / "verification.csv").open(newline="") as file:
        table = list(csv.DictReader(file))
    assert [(row["case"], row["compared"], row["holds"]) for row in table] == [
        ("one", "h, L1", "yes"), ("one", "v", "no")
    ]  # fmt: skip


def test_orders_stand_side_by_side() -> None:
    def check(options: CheckOptions) -> CheckResult:
        figure = Figure()
        figure.set_label("A figure.")
        rows = tuple(Row(words, 1.0 / options.order, "-", "<= 1", True) for words in ("h", f"{options.order}", "v"))
        return CheckResult("It", ("Of both.", f"Of {options.order}."), rows, {"it": figure}, {"it.toml": ""})

    outcome = collection.run({"it": check}, COARSE)["it"]
    found = [(row.compared, row.scheme) for row in outcome.rows]
    assert found == [("h", 1), ("h", 2), ("1", 1), ("v", 1), ("v", 2), ("2", 2)]
    assert outcome.text == ("Of both.", "Of 1.", "Of 2.")
    assert {name: figure.get_label() for name, figure in outcome.figures.items()} == {
        "it_order_1": "Order 1. A figure.", "it_order_2": "Order 2. A figure."
    }  # fmt: skip
    assert list(outcome.run_files) == ["order_1_it.toml", "order_2_it.toml"]
    assert {row.scheme for row in collection.run({"it": check}, COARSE, (2,))["it"].rows} == {2}


def verify(*arguments: str) -> Result:
    return CliRunner().invoke(app, ["verify", *arguments])


@pytest.mark.slow
def test_the_command_prints_and_writes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    result = verify("relaxation", "stoker", "--order", "2")
    assert result.exit_code == 0, result.output
    assert result.stderr == ""
    lines = result.stdout.splitlines()
    assert lines[-2:] == ["2 of 2 cases hold", "wrote verification/verification.html"]
    assert any("stoker" in line and "order >= 0.9" in line and "yes" in line for line in lines)
    assert sorted(path.name for path in Path("verification").iterdir()) == [
        "relaxation_order_2.png", "stoker_order_2.png", "verification.csv", "verification.html"
    ]  # fmt: skip


def test_the_command_refuses_another_order() -> None:
    assert verify("stoker", "--order", "3").exit_code == 2


def test_the_command_fails_with_a_case(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(collection, "CASES", {"broken": broken})
    result = verify("-o", str(tmp_path / "a" / "b"))
    assert result.exit_code == 1
    assert "0 of 1 cases hold" in result.stdout
    assert result.stderr == "warpgran: these do not: broken\n"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["riter"], "'riter' is not a case; did you mean ritter? allowed: rest,"),
        (["stoker", "--device", "cuda:7"], "device: 'cuda:7' is not on this machine"),
        (["stoker", "-o", "taken"], "taken"),
    ],
)
def test_the_command_refuses_in_a_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], words: str
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "taken").write_text("")
    result = verify(*arguments)
    assert result.exit_code == 2
    assert words in result.stderr and result.stderr.count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["taken"]


def test_the_document_tells_of_every_case() -> None:
    text = DOCUMENT.read_text(encoding="utf-8")
    for name in collection.CASES | collection.DEEP:
        assert f"| `{name}` |" in text, name


def test_cells_beside_a_place_can_be_left_out() -> None:
    """Of an error that sits at x = 0 nothing is left farther from it."""
    start = dams.dam(1, 0.1, 0.1, -1.0, 1.0, **coulomb(0.0))
    wrong = of_constant_phi(lambda x, t: exact.Flow(np.where(np.abs(x) < 0.1, 0.11, 0.1), np.zeros_like(x)))
    found = compare(CheckOptions(grids=2, order=1), start, wrong, (0.01,), 100)
    assert found.error("h", 0, found.grids[0]) > 0.005
    assert found.error("h", 0, found.grids[0], apart=(0.0, 0.1)) < 1e-12
    assert found.error("h", 0, found.grids[0], apart=(0.5, 0.1)) > 0.005
