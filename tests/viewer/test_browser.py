"""The page in a real browser, which can resolve no name: what it shows, and that it asks for nothing."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from helpers.collapses import batch, collapse

import warpgran as wg
from warpgran.analysis.fields import derive
from warpgran.analysis.front import thick
from warpgran.viewer.page import view

pytestmark = pytest.mark.slow
DARK = "getComputedStyle(document.body).backgroundColor"


class Opened:
    """A page in a tab, which fails when the page complains or asks for anything."""

    def __init__(self, chromium: Any, path: Path, place: str = "", width: int = 1200) -> None:
        self.tab = chromium.new_page(viewport={"width": width, "height": 900}, color_scheme="light")
        self.url, self.complaints = path.as_uri(), list[str]()
        self.tab.on("console", lambda message: self.complaints.append(message.text))
        self.tab.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.tab.on("request", lambda request: self.asked(request.url))
        self.tab.goto(self.url + place)
        self.tab.locator("#legend li").first.wait_for()

    def wait_for_runs(self, *names: str) -> None:
        """Wait until these are shown."""
        from playwright.sync_api import expect

        expect(self.tab.locator("#legend strong")).to_have_text(list(names))

    def asked(self, url: str) -> None:
        """Note what the page asks for beside itself."""
        if url.partition("#")[0] != self.url:
            self.complaints.append(f"asked for {url}")

    def close(self) -> None:
        """Leave the page, which has kept quiet."""
        assert self.complaints == []
        self.tab.close()

    def drawn(self, place: str) -> str:
        """What a canvas shows, as text."""
        return str(self.tab.evaluate(f"document.querySelector('{place} canvas').toDataURL()"))

    def numbers(self, place: str) -> list[float]:
        """The numbers that are read beside a label."""
        texts = self.tab.locator(f"{place} .values span:not(.quiet)").all_inner_texts()
        return [float(text.replace("\N{MINUS SIGN}", "-").replace("\N{EN DASH}", "nan")) for text in texts]

    def shown(self) -> list[str]:
        """The names of the runs that are shown."""
        return list(self.tab.locator("#legend strong").all_inner_texts())

    def rows(self) -> list[str]:
        """The numbers of the runs in the table, in their order."""
        return list(self.tab.locator("#table tr[data-row] td:nth-child(2)").all_inner_texts())


@pytest.fixture(scope="module")
def one(tmp_path_factory: pytest.TempPathFactory) -> tuple[xr.Dataset, Path]:
    data = collapse(snapshots=10)
    return data, view({"one.h5": data}, tmp_path_factory.mktemp("one") / "one.html")


@pytest.fixture(scope="module")
def many(tmp_path_factory: pytest.TempPathFactory) -> tuple[xr.Dataset, Path]:
    data = batch(diverged=(5,), column__phi=np.linspace(0.5, 0.62, 7), rheology__K=[0.0, 5, 1, 4, 2, 3, 6])
    data["failure"] = "run", ["", "", "", "", "", "phi = 1.2 in cell 3", ""]
    return data, view({"many.h5": data}, tmp_path_factory.mktemp("many") / "many.html")


def test_numbers_under_the_pointer_are_those_of_the_result(chromium: Any, one: tuple[xr.Dataset, Path]) -> None:
    data, path = one
    page = Opened(chromium, path)
    page.tab.locator("#slider").fill("4")
    canvas = page.tab.locator("#profiles figure[data-name=v] canvas")
    canvas.scroll_into_view_if_needed()
    canvas.hover(position={"x": 200, "y": 60})
    x = float(re.search(r"[?&#]x=([^&]*)", page.tab.url)[1])  # type: ignore[index]
    whole = data.assign(derive(data, "psi", "mu", "I"))
    mass, here = whole.where(thick(data)), whole.isel(run=0, time=4).sel(x=x, method="nearest")
    factors = {"h": 100.0, "v": 1.0, "phi": 1.0, "psi": 1.0, "mu": 1.0, "I": 1.0}
    for name, factor in factors.items():
        (read,) = page.numbers(f"#profiles figure[data-name={name}]")
        values = (data if name == "h" else mass)[name]
        step = factor * float(values.max() - values.min()) / 65534
        assert read == pytest.approx(factor * float(here[name]), abs=1.01 * step), name
        assert step < 0.01 * abs(read), name
    assert page.numbers("#flow") == page.numbers("#profiles figure[data-name=h]")
    assert page.tab.locator("#exact").inner_text().endswith("stored in 16 bits here; the exact ones are in one.h5.")
    page.close()


def test_the_slider_changes_what_is_drawn_and_the_cursor_of_the_series(
    chromium: Any, one: tuple[xr.Dataset, Path]
) -> None:
    data, path = one
    page = Opened(chromium, path)
    places = [
        "#flow div > div:not([hidden])",
        *(f"#profiles figure[data-name={n}]" for n in ("h", "v", "phi", "psi", "mu", "I")),
    ]
    places += [f"#series figure[data-name={name}]" for name in ("front", "h_max", "v_flow", "volume_change")]
    page.tab.locator("#slider").fill("2")
    before = [page.drawn(place) for place in places]
    (front,) = page.numbers("#series figure[data-name=front]")
    page.tab.locator("#slider").fill("5")
    assert all(page.drawn(place) != drawn for place, drawn in zip(places, before, strict=True))
    assert page.numbers("#series figure[data-name=front]")[0] > front
    expected = data["front"].isel(run=0).sel(series_time=float(data["time"][5]), method="nearest")
    assert page.numbers("#series figure[data-name=front]")[0] == pytest.approx(float(expected), abs=2e-5)
    page.close()


def test_keys_alone_step_play_tilt_and_move_the_pointer(chromium: Any, one: tuple[xr.Dataset, Path]) -> None:
    page = Opened(chromium, one[1], "#x=-0.1")
    press = page.tab.keyboard.press
    press("Home")
    assert page.tab.locator("#instant").inner_text() == "t = 0 s"
    press("ArrowRight")
    assert page.tab.locator("#instant").inner_text() == "t = 0.1 s"
    press("End")
    assert page.tab.locator("#instant").inner_text() == "t = 0.9 s"
    press("Space")
    page.tab.get_by_role("button", name="Pause").wait_for()
    page.tab.get_by_role("button", name="Play").wait_for()  # it ends where the snapshots do
    assert page.tab.locator("#instant").inner_text() == "t = 0.9 s"
    press("Home")
    press("Space")
    press("Space")
    page.tab.get_by_role("button", name="Play").wait_for()
    stopped = page.tab.locator("#instant").inner_text()
    page.tab.wait_for_timeout(900)
    assert page.tab.locator("#instant").inner_text() == stopped != "t = 0.9 s"
    press("Home")
    press("Shift+ArrowRight")
    first = page.numbers("#flow")
    press("Shift+ArrowLeft")
    press("Shift+ArrowLeft")
    assert page.numbers("#flow")[0] > first[0]
    press("Escape")
    assert page.numbers("#flow") == []
    press("t")
    assert "view=flat" in page.tab.url and page.tab.locator("#tilt").inner_text() == "flat"
    colour = page.tab.evaluate(DARK)
    press("d")
    assert "theme=dark" in page.tab.url and page.tab.evaluate(DARK) != colour
    page.close()


def test_a_click_on_a_run_shows_it_and_plus_lays_it_over_the_others(
    chromium: Any, many: tuple[xr.Dataset, Path]
) -> None:
    data, path = many
    page = Opened(chromium, path)
    assert page.shown() == ["run 0"]
    page.tab.locator("#table tr[data-row='3'] td").nth(1).click()
    page.wait_for_runs("run 3")
    page.tab.locator("#slider").fill("0")
    (front,) = page.numbers("#series figure[data-name=front]")
    assert front == pytest.approx(float(data["front"][3, 0]), abs=2e-5)
    for row in (1, 5, 6, 2):
        page.tab.locator(f"#table tr[data-row='{row}'] .add").click()
        page.tab.locator(f"#table tr[data-row='{row}'].shown").wait_for()
    page.wait_for_runs("run 1", "run 5", "run 6", "run 2")
    fronts = page.numbers("#series figure[data-name=front]")
    assert fronts == pytest.approx(data["front"].values[[1, 5, 6, 2], 0].tolist(), abs=1e-4)
    assert "phi = 1.2 in cell 3" in page.tab.locator("#legend").inner_text()
    page.tab.locator("#table tr[data-row='5'] .add").click()
    page.wait_for_runs("run 1", "run 6", "run 2")
    page.close()


def test_the_table_is_sorted_and_walked_by_keys(chromium: Any, many: tuple[xr.Dataset, Path]) -> None:
    page = Opened(chromium, many[1])
    page.tab.locator("#table th[data-name='rheology.K'] button").click()
    assert page.rows() == ["0", "2", "4", "5", "3", "1", "6"]
    page.tab.locator("#table th[data-name='rheology.K'] button").click()
    assert page.rows() == ["6", "1", "3", "5", "4", "2", "0"]
    page.tab.locator("#table").focus()
    page.tab.keyboard.press("ArrowDown")
    page.tab.keyboard.press("Enter")
    page.wait_for_runs("run 1")
    page.close()


def test_a_brush_hides_what_lies_outside(chromium: Any, many: tuple[xr.Dataset, Path]) -> None:
    page = Opened(chromium, many[1])
    canvas = page.tab.locator("#parallel canvas")
    before = page.drawn("#parallel")
    box = canvas.bounding_box()
    columns = page.tab.locator("#parallel .names > div").count()
    x = box["x"] + 0.5 * box["width"] / columns  # the axis of the first key
    foot, top = box["y"] + box["height"] - 24, box["y"] + 12
    page.tab.mouse.move(x, foot + 2)
    page.tab.mouse.down()
    page.tab.mouse.move(x, (foot + top) / 2 + 4, steps=5)
    page.tab.mouse.up()
    assert page.rows() == ["0", "1", "2"]
    assert page.tab.locator("#counted").inner_text() == "3 of 7 runs"
    assert page.drawn("#parallel") != before
    page.tab.locator("#ranges summary").click()
    page.tab.get_by_label("dilation coefficient K from").fill("0.5")
    page.tab.get_by_label("dilation coefficient K to").fill("2")
    page.tab.get_by_label("dilation coefficient K to").press("Enter")
    assert page.rows() == ["2"]
    page.tab.mouse.move(0, 0)
    canvas.scroll_into_view_if_needed()
    page.tab.get_by_role("button", name="Keep all runs").click()
    assert len(page.rows()) == 7
    page.close()


def test_the_address_brings_everything_back(chromium: Any, many: tuple[xr.Dataset, Path]) -> None:
    place = "#run=0.4,0.2&t=0&view=flat&x=0.1&theme=dark&sort=-rheology.K&keep=rheology.K~1~4"
    page = Opened(chromium, many[1], place)
    assert page.shown() == ["run 4", "run 2"]
    assert page.rows() == ["3", "5", "4", "2"]
    assert page.tab.locator("#tilt").inner_text() == "flat"
    assert len(page.numbers("#flow")) == 2
    again = Opened(chromium, many[1], "#" + page.tab.url.partition("#")[2])
    for part in ("#parallel", "#profiles", "#series"):
        assert again.drawn(part) == page.drawn(part)
    assert again.tab.url == page.tab.url
    again.tab.evaluate("location.hash = '#run=0.6'")
    again.wait_for_runs("run 6")
    assert len(again.rows()) == 7
    page.close()
    again.close()


def test_reserves_stand_where_the_run_out_is_shown(chromium: Any, tmp_path: Path) -> None:
    data = batch(column__phi=[0.55, 0.6])
    data["outflow"][1, 60:] = 0.2
    page = Opened(chromium, view(data, tmp_path / "page.html"), "#run=0.1")
    assert "run-out \N{GREATER-THAN OR EQUAL TO} " in page.tab.locator("#legend").inner_text()
    assert "lower bound" in page.tab.locator("#legend").inner_text()
    assert "left the grid" in page.tab.locator("#table tr[data-row='1']").inner_text()
    assert "left the grid" not in page.tab.locator("#table tr[data-row='0']").inner_text()
    page.close()


def test_text_of_a_result_is_shown_as_text(chromium: Any, tmp_path: Path) -> None:
    bad = "</script><script>document.title='bad'</script><img src=x>"
    data = batch(column__phi=[0.55, 0.6])
    data = data.assign_coords({f"rheology.{bad}": ("run", [bad, "b"])})
    data["failure"] = "run", [bad, ""]
    data["status"] = "run", np.array(["diverged", "ok"], dtype=object)
    data.attrs["case_toml"] = data.attrs["case_toml"].replace("Dense column, 22 degrees", bad)
    page = Opened(chromium, view({bad: data, "b": data}, tmp_path / "page.html"))
    assert page.tab.title() == bad
    assert page.tab.locator("h1").inner_text() == bad
    assert page.tab.locator("img").count() == 0
    assert bad in page.tab.locator("#table").inner_text()
    page.close()


def test_what_a_result_lacks_leaves_its_place_empty(chromium: Any, tmp_path: Path) -> None:
    data = collapse()
    for name, part in {"no series": {"series_time": slice(0)}, "no snapshots": {"time": slice(0)}}.items():
        page = Opened(chromium, view(data.isel(part), tmp_path / f"{name}.html"), "#x=0.1")
        page.tab.keyboard.press("ArrowRight")
        assert np.isfinite(page.numbers("#profiles figure[data-name=h]")).all() == (name == "no series")
        assert np.isfinite(page.numbers("#series figure[data-name=front]")).all() == (name == "no snapshots")
        page.close()


def test_runs_of_different_grids_lie_over_each_other(chromium: Any, tmp_path: Path) -> None:
    case = wg.Case().with_(**{"grid.right": 0.6, "time.end": 0.2, "time.snapshots": [0.1, 0.2]})
    data = wg.simulate(case.sweep({"grid.cells": [120, 200]}))
    page = Opened(chromium, view(data, tmp_path / "page.html"), "#run=0.0,0.1&t=0.1&x=-0.05&view=flat")
    expected = [
        100.0 * float(data["h"][run, 0, int(np.nanargmin(np.abs(data["x"][run].values + 0.05)))]) for run in range(2)
    ]
    assert page.numbers("#flow") == pytest.approx(expected, abs=3e-4)
    page.close()


@pytest.mark.parametrize("width", [420, 1400])
def test_nothing_is_wider_than_the_window(chromium: Any, many: tuple[xr.Dataset, Path], width: int) -> None:
    page = Opened(chromium, many[1], width=width)
    assert page.tab.evaluate("document.documentElement.scrollWidth") <= width
    page.close()
