"""The figure of one run, on results made by hand."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from helpers.collapses import collapse, two_runs, with_values
from matplotlib.figure import Figure

from warpgran.analysis.run_columns import RunColumns
from warpgran.figures import one_run as figures
from warpgran.figures.selection import one_run
from warpgran.schema import SERIES


def page(data: xr.Dataset, run: int = 0) -> Figure:
    """The page before it is written."""
    return figures.draw_run(RunColumns.of(data), run)


def heading(figure: Figure) -> str:
    return figure.get_suptitle()


def test_page_names_quantities_symbols_and_units() -> None:
    figure = page(collapse())
    labels = [ax.get_ylabel() for ax in figure.axes]
    assert [ax.get_title(loc="left") for ax in figure.axes] == [f"({c})" for c in "aebfcgdh"]
    assert labels[::2] == [
        "thickness $h$ (cm)",
        "velocity $v$ (m/s)",
        r"volume fraction $\varphi$ (-)",
        r"dilatancy angle $\psi$ (°)",
    ]
    assert labels[1::2] == [
        r"front position $x_\mathrm{f}$ (m)",
        r"max. thickness $h_\mathrm{max}$ (cm)",
        r"speed $|v|$, $\dot{x}_\mathrm{f}$ (m/s)",
        r"volume change $\Delta V/V_0$ (%)",
    ]
    assert all("$" in label and label.endswith(")") for label in labels)
    assert [ax.get_xlabel() for ax in figure.axes[-2:]] == ["position along the slope $x$ (m)", "time $t$ (s)"]
    assert heading(figure).splitlines() == [
        "Dense column, 22 degrees",
        r"$\theta$ = $22$°, $\varphi_0$ = $0.62$, $K$ = $4.09$",
    ]


def test_profiles_are_in_the_units_of_their_labels_and_cut_where_thin() -> None:
    data = collapse()
    thickness, speed = page(data).axes[0].lines[1], page(data).axes[2].lines[1]
    x = np.asarray(thickness.get_xdata())
    cells = np.isin(data["x"].values, x)
    h = data["h"].values[0, 1][cells]
    np.testing.assert_allclose(np.asarray(thickness.get_ydata()), 100 * h)
    np.testing.assert_array_equal(np.isnan(np.asarray(speed.get_ydata())), h <= 1e-3)
    assert np.isnan(np.asarray(speed.get_ydata())).any()
    assert 0.6 < x[-1] < 0.65  # the grid goes on to 1.0


def test_every_panel_of_the_series_is_one_of_the_schema_and_the_speed_leaves_out_the_thinnest_flow() -> None:
    assert {panel.name for panel in figures.SERIES} <= SERIES.keys()
    data = collapse()
    np.testing.assert_array_equal(np.asarray(page(data).axes[5].lines[0].get_ydata()), data["v_flow"].values[0])


def test_stop_time_is_marked_where_the_run_stopped() -> None:
    legends = [page(two_runs(), run).axes[7].get_legend() for run in (0, 1)]
    texts = [[text.get_text() for text in legend.get_texts()] for legend in legends if legend is not None]
    assert "at rest, $t$ = 0.6 s" in texts[0]
    assert not any("at rest" in text for text in texts[1])


def test_page_of_a_diverged_run_says_so_and_shows_what_there_is() -> None:
    figure = page(two_runs(), run=1)
    for fact in ("$-12.5$°", "column.length = 0.25", "run 1 (0 to 1)", "ended early: diverged"):
        assert fact in " ".join(heading(figure).split())
    profiles = [line for line in figure.axes[0].lines if str(line.get_label()).startswith("$t$")]
    assert len(profiles) == figures.MAX_INSTANTS
    assert "diverged" not in heading(page(two_runs(), run=0))


def test_page_says_what_its_results_must_not_be_read_without() -> None:
    def said(**changes: object) -> str:
        data = collapse(samples=7)
        for name, value in changes.items():
            data[name][0] = value
        return " ".join(heading(page(with_values(data))).split())

    assert "lower bound" not in said() and "moving" not in said()
    assert "left the grid: its run-out is a lower bound" in said(outflow=np.linspace(0.0, 0.01, 7))
    assert "still moving at the end" in said(v_flow=np.full(7, 0.3))
    for status, words in (("interrupted", "interrupted at $t$ = 0.4 s"), ("pending", "still to be computed")):
        told = said(status=status, end_time=0.4)
        assert words in told and "ended early" not in told


def test_page_says_how_many_snapshots_it_shows() -> None:
    assert "8 of the 12 snapshots" in page(two_runs()).axes[6].texts[0].get_text()
    assert "snapshots" not in page(collapse()).axes[6].texts[0].get_text()
    assert "> 1.4 mm." in page(collapse()).axes[6].texts[0].get_text()


@pytest.mark.parametrize(("snapshots", "samples", "label"), [(4, 0, "thickness $h$ (cm)"), (0, 9, "front position")])
def test_page_leaves_out_what_was_not_stored(snapshots: int, samples: int, label: str) -> None:
    figure = page(collapse(snapshots=snapshots, samples=samples))
    assert len(figure.axes) == 4
    assert figure.axes[0].get_ylabel().startswith(label)


def test_one_snapshot_and_one_sample_at_rest_are_drawn() -> None:
    figure = page(collapse(snapshots=1, samples=1))
    figure.canvas.draw()
    assert figure.axes[5].get_yscale() == "linear"


def test_grids_that_differ_are_drawn_without_their_padding() -> None:
    data = collapse(runs=2)
    x, bed = (np.stack([data[name].values] * 2) for name in ("x", "bed"))
    x[1, 100:] = bed[1, 100:] = np.nan
    data = data.drop_vars(("x", "bed")).rename_dims(x="cell")
    data = data.assign_coords(x=(("run", "cell"), x), cell=np.arange(x.shape[1])).assign(bed=(("run", "cell"), bed))
    assert one_run(data, 1).x.size == 100
    assert len(page(data, 1).axes) == 8


def test_long_headings_are_broken_between_facts_and_fit_the_page() -> None:
    data = two_runs().assign_coords({f"rheology.key{n}": ("run", [0.1, 0.2]) for n in range(9)})
    data.attrs["case_toml"] = data.attrs["case_toml"].replace("Dense column", "Dense column " * 9)
    figure = page(data, 1)
    figure.canvas.draw()
    title = figure.texts[0].get_window_extent()
    assert title.x0 >= 0
    assert title.x1 <= figure.bbox.x1
    assert all(line.endswith(("°", ",", "diverged")) or "=" not in line for line in heading(figure).splitlines())


def test_a_run_from_a_profile_has_no_packing_in_its_heading() -> None:
    data = collapse()
    data.attrs["case_toml"] = data.attrs["case_toml"].replace("phi = 0.62\n", "")
    assert heading(page(data)).splitlines()[1] == r"$\theta$ = $22$°, $K$ = $4.09$"


def test_a_run_that_came_to_rest_did_not_end_early() -> None:
    data = collapse()
    data["status"][0] = "at_rest"
    assert "ended" not in heading(page(data))


def scaled(factor: float) -> xr.Dataset:
    """The collapse with all of its lengths so many times as large."""
    data = collapse(runs=2)
    for name in ("x", "bed", "h", "front", "h_max"):
        data[name] = factor * data[name]
    return data


@pytest.mark.parametrize(
    ("factor", "along", "thick"), [(0.02, "cm", "mm"), (1.0, "m", "cm"), (2e3, "m", "m"), (2e4, "km", "m")]
)
def test_units_of_lengths_are_those_of_their_typical_size_in_all_runs(factor: float, along: str, thick: str) -> None:
    data = scaled(factor)
    data["h_max"][1] = data["h_max"][1] * 1e-3
    for run in (0, 1):
        figure = page(data, run)
        labels = [figure.axes[n].get_ylabel() for n in (0, 3)] + [figure.axes[n].get_xlabel() for n in (6,)]
        assert [label.split()[-1] for label in labels] == [f"({thick})", f"({thick})", f"({along})"]
    scale = {"km": 1e-3, "m": 1.0, "cm": 100.0, "mm": 1000.0}
    (top,) = {round(float(np.max(np.asarray(line.get_ydata()))), 9) for line in page(data).axes[0].lines[:1]}
    assert top == pytest.approx(scale[thick] * float(data["h"][0, 0].max()))
    assert np.asarray(page(data).axes[1].lines[0].get_ydata())[-1] == pytest.approx(
        scale[along] * data["front"].values[0, -1]
    )


def test_a_bed_far_higher_than_the_mass_leaves_the_thickness_an_axis_of_its_own() -> None:
    data = scaled(1.0)
    data["bed"] = "x", 400.0 * np.exp(-data["x"].values)
    figure = page(data)
    on_bed, thickness = figure.axes[-1], figure.axes[0]
    assert on_bed.get_ylabel() == "bed $b$, $b + h$ (m)"
    figure.canvas.draw()
    assert on_bed.yaxis.label.get_window_extent().x0 > 0.0  # on the page
    assert thickness.get_ylim()[1] < 30.0  # cm
    bed = np.asarray(on_bed.lines[-1].get_ydata())
    surfaces = [np.asarray(line.get_ydata()) for line in on_bed.lines[:-1]]
    assert len(surfaces) == 4
    np.testing.assert_allclose(np.nanmax(surfaces[0] - bed), float(data["h"][0, 0].max()), rtol=0.01)
    assert [ax.get_title(loc="left") for ax in (on_bed, thickness)] == ["(a)", "(b)"]


def test_a_flat_bed_has_no_panel() -> None:
    assert len(page(collapse()).axes) == 8
