"""Runs of several results over each other."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from helpers.collapses import batch, collapse, two_runs
from matplotlib.figure import Figure
from typer.testing import CliRunner

import warpgran as wg
from warpgran.cli.app import app


def changed(**text: str) -> xr.Dataset:
    """The collapse with other texts in its run file."""
    data = collapse()
    for name, value in text.items():
        before = next(line for line in data.attrs["case_toml"].splitlines() if line.startswith(f"{name} = "))
        data.attrs["case_toml"] = data.attrs["case_toml"].replace(before, f"{name} = {value}")
    return data


def labels(figure: Figure) -> list[str]:
    (legend,) = figure.legends
    return [text.get_text() for text in legend.get_texts()]


def test_lines_are_of_all_runs_in_the_units_of_the_axes() -> None:
    thicker = collapse(cells=100)
    thicker["h"] = 2.0 * thicker["h"]
    figure = wg.plot(collapse(), thicker)
    assert len(figure.axes) == 8
    last = figure.axes[3]
    assert last.texts[0].get_text() == "$t$ = 0.9 s"
    assert last.get_ylabel() == "thickness $h$ (cm)"
    for line, data in zip(last.lines, (collapse(), thicker), strict=True):
        np.testing.assert_allclose(np.nanmax(np.asarray(line.get_ydata())), 100 * data["h"].values[0, -1].max())
    assert len({(line.get_color(), str(line.get_linestyle())) for line in last.lines}) == 2
    fronts = figure.axes[4].lines
    np.testing.assert_allclose(np.asarray(fronts[0].get_ydata()), collapse()["front"].values[0])


def test_beds_that_are_not_flat_have_a_panel_with_every_surface() -> None:
    bumpy, steep = collapse(), collapse()
    bumpy["bed"] = "x", 0.05 * np.exp(-(((bumpy["x"].values - 0.3) / 0.1) ** 2))
    steep["bed"] = "x", 300.0 - 30.0 * steep["x"].values
    for other, unit, factor in ((bumpy, "cm", 100.0), (steep, "m", 1.0)):
        figure = wg.plot(collapse(), other)
        assert len(figure.axes) == 9
        panel = figure.axes[0]
        assert panel.get_ylabel() == f"bed $b$, surface\n$b + h$ ({unit})"
        surface, bed = (np.asarray(line.get_ydata()) for line in panel.lines[2:])
        x = np.asarray(panel.lines[2].get_xdata())
        there = other.isel(run=0, time=-1).sel(x=x, method="nearest")
        np.testing.assert_allclose(bed, factor * there["bed"].values)
        mass = np.isfinite(surface)
        np.testing.assert_allclose(surface[mass], factor * (there["bed"] + there["h"]).values[mass])
        assert 0.9 < mass.mean() < 1.0
    assert len(wg.plot(collapse(), collapse()).axes) == 8


def test_only_instants_that_all_share_are_drawn() -> None:
    instants = [ax.texts[0].get_text() for ax in wg.plot(collapse(snapshots=4), collapse(snapshots=7)).axes if ax.texts]
    assert instants == [f"$t$ = {t} s" for t in ("0", "0.3", "0.6", "0.9")]
    later = collapse()
    later["time"] = later["time"] + 0.01
    assert not [ax for ax in wg.plot(collapse(), later).axes if ax.texts]
    many = [ax.texts[0].get_text() for ax in wg.plot(collapse(snapshots=10), collapse(snapshots=10)).axes if ax.texts]
    assert len(many) == 4
    assert many[-1] == "$t$ = 0.9 s"


def test_labels_say_what_differs_and_what_holds_with_a_reserve() -> None:
    moving = changed(angle="5.0", right="1.1")
    moving["v_flow_final"][:] = 0.3
    moving["stop_time"][:] = np.nan
    figure = wg.plot(collapse(), moving)
    assert labels(figure) == [
        r"$\theta$ = $22$°",
        r"$\theta$ = $5$° (still moving at the end)",
    ]  # the grid is no matter
    assert figure.get_suptitle().splitlines()[0] == "Dense column, 22 degrees"
    assert labels(wg.plot(collapse(), changed(cells="480"))) == ["$n$ = 240", "$n$ = 480"]
    assert labels(wg.plot(collapse(), collapse(), labels=["a", "b"])) == ["a", "b"]
    assert labels(wg.plot(collapse(), changed(title='"Other"'))) == ["Dense column, 22 degrees", "Other"]


def test_runs_that_nothing_tells_apart_are_numbered() -> None:
    found = labels(wg.plot(collapse(), collapse(runs=2)))
    assert found == ["result 0", "result 1, run 0", "result 1, run 1"]


def test_runs_of_a_batch_are_drawn_all_or_one_of_each() -> None:
    assert len(labels(wg.plot(collapse(), two_runs()))) == 3
    assert len(labels(wg.plot(two_runs(), two_runs(), run=1))) == 2


def test_what_cannot_be_drawn_over_each_other_is_refused() -> None:
    with pytest.raises(wg.ResultError, match="9 runs are too many"):
        wg.plot(collapse(), batch(slope__angle=list(range(8))))
    with pytest.raises(wg.ResultError, match="1 labels do not name 2 results"):
        wg.plot(collapse(), collapse(), labels=["a"])
    with pytest.raises(wg.ResultError, match="nothing to draw over each other"):
        wg.plot(collapse(snapshots=0, samples=0), collapse(snapshots=0, samples=0))
    with pytest.raises(wg.OptionError, match="path="):
        wg.plot(collapse(), "page.png")  # type: ignore[arg-type]
    with pytest.raises(wg.OptionError, match="none is given"):
        wg.plot()


def test_files_are_named_in_the_legend(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    case = wg.Case(grid={"right": 0.2, "cells": 60}, time={"end": 0.02})
    seen: list[Figure] = []
    monkeypatch.setattr("warpgran.figures.plot.save", lambda figure, path: seen.append(figure))
    for name in ("a", "b"):
        Path(f"{name}.toml").write_text(case.to_toml())
        CliRunner().invoke(app, ["run", f"{name}.toml", "--no-picture"])
    result = CliRunner().invoke(app, ["plot", "a.h5", "b.h5"])
    assert result.stdout == "wrote a_b.png\n"
    assert labels(seen[0]) == ["a (still moving at the end)", "b (still moving at the end)"]
    assert [line.split(": ")[1] for line in result.stderr.splitlines()] == ["a.h5", "b.h5"]
