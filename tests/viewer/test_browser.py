"""The page in a real browser, which can resolve no name: what it shows, and that it asks for nothing."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from helpers.collapses import batch, collapse, two_runs

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

    def address(self) -> str:
        """The address when what was done before stands in it."""
        self.tab.wait_for_timeout(500)
        return str(self.tab.url)

    def pressed(self, place: str) -> str:
        """Whether a button that stays pressed is."""
        return str(self.tab.locator(place).get_attribute("aria-pressed"))

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
    x = float(re.search(r"[?&#]x=([^&]*)", page.address())[1])  # type: ignore[index]
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
    assert "view=flat" in page.address() and page.pressed("#tilt") == "false"
    colour = page.tab.evaluate(DARK)
    press("d")
    assert "theme=dark" in page.address() and page.tab.evaluate(DARK) != colour
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
    page.tab.locator("#table table").focus()
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
    assert page.pressed("#tilt") == "false"
    assert len(page.numbers("#flow")) == 2
    dashes = page.tab.locator("#legend line").all()
    assert len({line.evaluate("line => getComputedStyle(line).strokeDasharray") for line in dashes}) == len(dashes) == 2
    again = Opened(chromium, many[1], "#" + page.address().partition("#")[2])
    for part in ("#parallel", "#profiles", "#series"):
        assert again.drawn(part) == page.drawn(part)
    assert again.address() == page.address()
    again.tab.evaluate("location.hash = '#run=0.6'")
    again.wait_for_runs("run 6")
    assert len(again.rows()) == 7
    page.close()
    again.close()


def test_reserves_stand_where_the_run_out_is_shown(chromium: Any, tmp_path: Path) -> None:
    data = batch(column__phi=[0.55, 0.6])
    data["outflow_final"][1] = 0.2
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


def test_what_a_result_lacks_has_no_empty_place_and_the_page_says_so(chromium: Any, tmp_path: Path) -> None:
    data = collapse()
    page = Opened(chromium, view(data.isel(series_time=slice(0)), tmp_path / "a.html"), "#x=0.1")
    assert page.tab.locator("#absent").inner_text().startswith("The result holds no series")
    assert np.isfinite(page.numbers("#profiles figure[data-name=h]")).all()
    assert not page.tab.locator("#series").is_visible() and not page.tab.locator("#more").is_visible()
    page.close()
    page = Opened(chromium, view(data.isel(time=slice(0)), tmp_path / "b.html"), "#x=0.1")
    assert page.tab.locator("#absent").inner_text().startswith("The result holds no snapshots")
    assert not page.tab.locator("#flow").is_visible() and not page.tab.locator("#profiles").is_visible()
    page.tab.keyboard.press("End")  # the slider has the times of the series
    assert page.tab.locator("#instant").inner_text() == "t = 0.9 s"
    (front,) = page.numbers("#series figure[data-name=front]")
    assert front == pytest.approx(float(data["front"][0, -1]), abs=1e-4)
    page.close()


def test_a_run_that_ended_earlier_says_at_what_time_it_is_shown(chromium: Any, tmp_path: Path) -> None:
    data = two_runs()
    page = Opened(chromium, view(data, tmp_path / "page.html"), "#run=0.0,0.1")
    page.tab.keyboard.press("Home")
    notes = page.tab.locator("#legend .instant")
    assert [note.is_visible() for note in notes.all()] == [False, False]
    page.tab.keyboard.press("End")
    last = float(data["time"][7])
    assert [note.is_visible() for note in notes.all()] == [False, True]
    assert notes.nth(1).inner_text() == f"shown at t = {last:.4g} s, its last snapshot"
    page.close()


def test_speeds_and_inertial_numbers_are_logarithmic_or_linear(chromium: Any, one: tuple[xr.Dataset, Path]) -> None:
    page = Opened(chromium, one[1], "#x=0.1&t=0.3")
    places = ("#profiles figure[data-name=I]", "#series figure[data-name=v_flow]", "#profiles figure[data-name=phi]")
    before, read = [page.drawn(place) for place in places], page.numbers(places[0])
    page.tab.keyboard.press("l")
    assert [page.drawn(place) == drawn for place, drawn in zip(places, before, strict=True)] == [False, False, True]
    assert page.numbers(places[0]) == read
    assert "axes=linear" in page.address() and page.pressed("#log") == "false"
    page.tab.locator("#log").click()
    page.tab.mouse.move(0, 0)
    assert "axes" not in page.address() and page.pressed("#log") == "true"
    page.close()


def test_axes_have_labels_that_differ(chromium: Any, one: tuple[xr.Dataset, Path]) -> None:
    page = Opened(chromium, one[1])
    for value in (0.0, 0.5536, -3e-7, 4e6, 1.9975):
        texts = page.tab.evaluate(
            f"(() => {{ const {{ at, text }} = ticks(...roomy([{value}, {value}], 0), 4); return at.map(text); }})()"
        )
        assert len(set(texts)) == len(texts) >= 2, texts
        assert max(map(len, texts)) <= 8, texts
    assert page.tab.evaluate("[exact(-1e-12, 1e-6), exact(-2e-6, 1e-6)]") == ["0.000000", "\N{MINUS SIGN}0.000002"]
    for low, high in ((3e-4, 2.0), (0.5, 0.9), (1e-9, 1e3), (0.03, 4.0)):
        texts = page.tab.evaluate(
            f"(() => {{ const {{ at, text }} = decades({low}, {high}, 4); return at.map(text); }})()"
        )
        assert 1 <= len(set(texts)) == len(texts) <= 6, texts
    page.close()


def test_each_bed_is_drawn(chromium: Any, tmp_path: Path) -> None:
    data = collapse(runs=2)
    bed = 0.05 * np.exp(-(((data["x"] - 0.3) / 0.1) ** 2))
    count = """
        let grounds = 0;
        const ground = flow.ground;
        flow.ground = (...all) => { grounds += 1; ground.apply(flow, all); };
        draw();
        grounds"""
    for beds, heights in ((2, [1.0, 0.2]), (1, [1.0, 1.0])):
        bumpy = data.assign(bed=xr.DataArray(heights, dims="run") * bed)
        page = Opened(chromium, view(bumpy, tmp_path / f"{beds}.html"), "#run=0.0,0.1&t=0.2")
        assert page.tab.evaluate(count) == beds
        page.close()


def test_the_address_is_written_no_more_often_than_browsers_allow(chromium: Any, one: tuple[xr.Dataset, Path]) -> None:
    page = Opened(chromium, one[1])
    page.address()
    page.tab.evaluate("""
        window.calls = 0;
        const kept = history.replaceState.bind(history);
        history.replaceState = (...all) => { calls += 1; kept(...all); };
        0""")
    page.tab.evaluate("""async () => {
        for (let i = 0; i < 200; i += 1) {
            point(0.001 * i);
            await new Promise((go) => setTimeout(go, 4));
        }
    }""")
    assert page.address().endswith("x=0.199")
    assert 1 <= page.tab.evaluate("calls") < 50
    page.close()


def test_what_is_printed_is_light_and_has_no_buttons(chromium: Any, many: tuple[xr.Dataset, Path]) -> None:
    page = Opened(chromium, many[1], "#theme=dark&run=0.1,0.2")
    high = page.tab.evaluate("document.body.scrollHeight")
    dark, drawn = page.tab.evaluate(DARK), page.drawn("#series")
    page.tab.emulate_media(media="print")
    page.tab.evaluate("window.dispatchEvent(new Event('beforeprint'))")
    assert page.tab.evaluate(DARK) == "rgb(255, 255, 255)" and page.drawn("#series") != drawn
    buttons = page.tab.locator("button:visible")
    assert buttons.count() == page.tab.locator("#table th button").count()  # which are the names of the columns
    assert page.tab.locator("#instant").is_visible()
    assert page.tab.evaluate("document.body.scrollHeight") <= high
    page.tab.evaluate("window.dispatchEvent(new Event('afterprint'))")
    assert page.tab.evaluate(DARK) == dark and "theme=dark" in page.address()
    page.close()


def test_a_screen_reader_is_told_what_there_is(chromium: Any, many: tuple[xr.Dataset, Path]) -> None:
    page = Opened(chromium, many[1], "#run=0.0&t=0&sort=rheology.K")
    grid = page.tab.get_by_role("grid", name="Runs")
    assert grid.get_by_role("row", selected=True).get_attribute("id") == "row-0"
    assert grid.get_by_role("columnheader", name="status").count() == 1
    assert grid.get_attribute("aria-activedescendant") == "row-0"
    grid.press("ArrowDown")
    assert grid.get_attribute("aria-activedescendant") == "row-2"
    thickness = page.tab.locator("#profiles figure[data-name=h] canvas").get_attribute("aria-label")
    assert re.fullmatch(r"thickness h \(cm\) along the slope at t = 0 s: 0 to 18\.\d+", thickness), thickness
    slider = page.tab.get_by_role("slider", name="Time")
    assert slider.get_attribute("aria-valuetext") == "0 s"
    page.tab.locator("#ranges summary").click()
    page.tab.get_by_label("dilation coefficient K from").fill("99")
    page.tab.get_by_label("dilation coefficient K from").press("Enter")
    assert page.rows() == [] and page.tab.get_by_role("status").inner_text() == "0 of 7 runs"
    grid.press("Enter")
    assert page.shown() == ["run 0"]
    page.close()


def test_tab_reaches_everything_in_the_order_of_the_page(chromium: Any, many: tuple[xr.Dataset, Path]) -> None:
    page = Opened(chromium, many[1], "#run=0.0,0.1")
    reached = []
    for _ in range(40):
        page.tab.keyboard.press("Tab")
        outline, name = page.tab.evaluate(
            "[getComputedStyle(document.activeElement).outlineStyle, document.activeElement.id"
            " || document.activeElement.getAttribute('role') || document.activeElement.getAttribute('aria-label')"
            " || document.activeElement.textContent]"
        )
        if name.startswith("Keys"):
            break
        assert outline == "solid", name
        reached.append(name)
    expected = [
        "theme",
        "Ranges in numbers",
        "grid",
        "Leave out run 0",
        "Leave out run 1",
        "play",
        "slider",
        "tilt",
        "log",
    ]
    assert [name for name in reached if name in expected] == expected
    page.close()


def test_without_what_it_needs_the_page_says_what_that_is(chromium: Any, one: tuple[xr.Dataset, Path]) -> None:
    tab = chromium.new_page()
    tab.add_init_script("delete window.DecompressionStream")
    tab.goto(one[1].as_uri())
    tab.get_by_role("alert").wait_for()
    assert "It needs Chrome or Edge 80, Firefox 113, Safari 16.4, or later." in tab.locator("main").inner_text()
    assert tab.locator("main button:visible, main canvas:visible").count() == 0
    tab.close()
    tab = chromium.new_page(java_script_enabled=False)
    tab.goto(one[1].as_uri())
    assert "JavaScript, which is switched off here" in tab.locator("noscript").inner_text()
    assert not tab.locator("main").is_visible()
    tab.close()


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
