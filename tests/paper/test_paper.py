"""`warpgran reproduce`: claims on results made by hand, laboratory data, what is reused, a figure from end to end."""

from __future__ import annotations

import csv
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from helpers.cases import small
from typer.testing import CliRunner, Result

from warpgran.case.case import Case
from warpgran.case.read_study import read_study
from warpgran.case.study import Study
from warpgran.case.tables import TableError
from warpgran.cli.app import app
from warpgran.files import StorageError
from warpgran.paper import claims_coefficients, claims_dilatancy, claims_motion, claims_regime, claims_scheme, panels
from warpgran.paper.catalogue import CLAIMS, PICTURES, chosen
from warpgran.paper.claim import Claim, Finding
from warpgran.paper.laboratory import read_laboratory
from warpgran.paper.measures import front_of, mass, rise, slow_regime
from warpgran.paper.remarks import OURS, REMARKS
from warpgran.paper.reproduce import shipped_runs
from warpgran.paper.results import NotComputedError, StoredResults, one_of
from warpgran.paper.settings import DEFAULTS, SETTINGS
from warpgran.results.part_file import part_of
from warpgran.results.reading import open_dataset
from warpgran.run.options import Options
from warpgran.run.threads import compute
from warpgran.run.to_file import bring_up_to_date

T = np.arange(0.0, 1.805, 0.01)
DIVERGING = """
[rheology]
K = 0.0
[grid]
cells = 40
[time]
end = 0.1
series = { every = 0.01 }
[scheme]
order = 1
viscosity = "paper"
[sweep.over]
"slope.angle" = [0, 22]
"""
X = np.linspace(-0.1995, 1.5995, 1800)


def series(**values: Any) -> xr.Dataset:
    """One run with series at T; what is not given is 0."""
    names = ("front", "front_speed", "h_max", "v_flow", "volume_change")
    data = {name: ("series_time", np.broadcast_to(values.get(name, 0.0), T.shape)) for name in names}
    one = xr.Dataset(data, {"series_time": ("series_time", T)}, {"case_toml": Case().to_toml()})
    one["stop_time"] = values.get("stop_time", np.nan)
    return one


def profile(h: Any, v: Any = 0.0, phi: Any = 0.6, times: tuple[float, ...] = (0.36,)) -> xr.Dataset:
    """One run with the same profile at some instants."""
    fields = {"h": h, "v": v, "phi": phi}
    shape = (len(times), X.size)
    data = {name: (("time", "x"), np.broadcast_to(values, shape)) for name, values in fields.items()}
    return xr.Dataset(data, {"x": ("x", X), "time": list(times)}, {"case_toml": Case().to_toml()})


class Made:
    """Results made by a function of the run file and the keys."""

    def __init__(self, make: Callable[..., xr.Dataset]) -> None:
        self.make = make

    def run(self, name: str, **where: Any) -> xr.Dataset:
        """What the function makes."""
        return self.make(name, **where)


def verdict(claim: Claim, make: Callable[..., xr.Dataset]) -> bool | None:
    return claim.evaluate(Made(make)).holds


# Claims


@pytest.mark.parametrize(("value", "holds"), [("0.2 m", True), ("nan m", None), ("0: 0.1, 22: nan %", None)])
def test_a_number_that_is_missing_decides_nothing(value: str, holds: bool | None) -> None:
    claim = Claim("reach", "4", (), "It reaches far.", "", "How far.", lambda results: Finding(value, True))
    assert verdict(claim, lambda name, **where: profile(0.1)) is holds


@pytest.mark.parametrize(
    ("dilation", "holds"),
    [([0.04, 0.06, 0.08, 0.10], True), ([0.04, 0.06, 0.05, 0.10], False), ([0.04, 0.06, 0.08, 0.15], False)],
)
def test_dilation_grows_with_the_slope_to_ten_percent(dilation: list[float], holds: bool) -> None:
    by_angle = dict(zip((0.0, 10.0, 16.0, 22.0), dilation, strict=True))
    bump = np.sin(np.pi * T / 1.8)
    make = lambda name, angle, phi, K: series(volume_change=by_angle[angle] * bump)  # noqa: E731
    assert verdict(claims_dilatancy.dilation_grows, make) is holds


@pytest.mark.parametrize(("lead", "holds"), [(0.002, True), (-0.002, False)])
def test_the_dense_front_is_ahead(lead: float, holds: bool) -> None:
    late = np.where(T > 1.0, lead, 0.001)  # it counts at any time, here after 1 s
    make = lambda name, angle, phi, K: series(front=0.5 + (late if phi == 0.62 else 0.0))  # noqa: E731
    assert verdict(claims_motion.dense_front_ahead, make) is holds


@pytest.mark.parametrize(("loose", "holds"), [(0.10, True), (0.13, False)])
def test_the_dense_mass_is_thickest(loose: float, holds: bool) -> None:
    height = {(0.62, 4.09): 0.14, (0.62, 0.0): 0.12, (0.55, 4.09): loose}
    make = lambda name, angle, phi, K: series(h_max=height[phi, K])  # noqa: E731
    assert verdict(claims_motion.thickest_is_dense, make) is holds


@pytest.mark.parametrize(("factor", "holds"), [(1.0, True), (0.7, False), (1.5, False)])
def test_stop_times(factor: float, holds: bool) -> None:
    said = {0.0: 0.48, 10.0: 0.66}
    fall = {a: 10.0 ** (-4.0 - 20 * (T - factor * t)) for a, t in said.items()}  # 0.1 mm/s at the paper's instants
    make = lambda name, angle, phi, K: series(v_flow=fall[angle])  # noqa: E731
    assert verdict(claims_motion.stop_times, make) is holds


def test_a_run_that_diverged_leaves_a_claim_open() -> None:
    def make(name: str, **where: Any) -> xr.Dataset:
        raise NotComputedError("the run with angle = 22 diverged at t = 2 s")

    finding = claims_motion.full_stop.evaluate(Made(make))
    assert (finding.holds, finding.verdict) == (None, "cannot be told")
    assert finding.value == "the run with angle = 22 diverged at t = 2 s"


def test_steady_at_last_or_slowing_on() -> None:
    slowing = np.maximum(1.5 - T, 0.0)
    steady = np.where(slowing > 0.4, slowing, 0.4)
    half = np.where(slowing > 0.4, slowing, 0.4 - 0.5 * (T - 1.1))
    assert slow_regime(T, slowing) == pytest.approx(1.0)
    assert slow_regime(T, steady) == pytest.approx(0.0, abs=1e-12)
    assert slow_regime(T, half) == pytest.approx(0.5)
    assert np.isnan(slow_regime(T, np.full_like(T, 0.8)))  # it never gets slow
    make = lambda name, angle, phi, K: series(front_speed=steady if K == 4.09 else slowing)  # noqa: E731
    assert verdict(claims_regime.dense_slow_regime, make) is True
    assert verdict(claims_regime.no_slow_regime, make) is False  # the loose mass has it too here
    assert verdict(claims_regime.dense_slow_regime, lambda *a, **b: series(front_speed=slowing)) is False


def wedge(end: float = 0.3) -> np.ndarray:
    return np.clip(0.2 * (end - X), 0.0, 0.14)


def test_oscillations_of_the_thickness_are_told_from_a_smooth_front() -> None:
    ripple = np.where((X > 0.25) & (X < 0.28), 1.5e-3 * (1 + np.sin(2 * np.pi * (X - 0.25) / 0.01 - np.pi / 2)), 0.0)
    times = (0.3, 0.36)

    def make(name: str, angle: float, phi_eq: str, phi_eq_N: float) -> xr.Dataset:
        return profile(wedge() + (ripple if phi_eq == "f0" else 0.0), times=times).assign(stop_time=0.4)

    assert rise(profile(wedge()).isel(time=0)) == 0.0
    assert rise(profile(wedge() + ripple).isel(time=0)) > 1e-3
    assert verdict(claims_scheme.f0_oscillates, make) is True
    assert verdict(claims_scheme.f2_does_not_oscillate, make) is True
    assert verdict(claims_scheme.f1_oscillates_a_little, make) is False


@pytest.mark.parametrize(("phi_front", "holds"), [(0.50, True), (0.58, False)])
def test_contraction_lowers_friction_at_the_front(phi_front: float, holds: bool) -> None:
    phi = np.where(X > 0.25, phi_front, 0.58)  # so slow that phi_eq is phi_stat = 0.582
    late = lambda name, **where: profile(wedge(), 1e-4, phi, times=(0.36, 0.42))  # noqa: E731
    assert verdict(claims_dilatancy.friction_falls_late, late) is holds
    assert verdict(claims_dilatancy.friction_rises_at_first, late) is None  # there is no snapshot at 0.06 s


@pytest.mark.parametrize(("top", "holds"), [((0.10, 0.14, 0.12, 0.11), True), ((0.14, 0.13, 0.12, 0.11), False)])
def test_the_greatest_speed_is_at_K_1(top: tuple[float, ...], holds: bool) -> None:
    speed = dict(zip((0.0, 1.0, 4.09, 8.0), top, strict=True))
    make = lambda name, angle, phi, K: profile(wedge(), speed[K])  # noqa: E731
    assert verdict(claims_coefficients.fastest_at_K_1, make) is holds


@pytest.mark.parametrize(("change", "holds"), [(0.5, True), (1.0, False)])
def test_walls_change_the_slow_regime(change: float, holds: bool) -> None:
    def make(name: str, angle: float, K: float, mu_wall: float) -> xr.Dataset:
        return series(front_speed=np.where((T > 0.95) & (mu_wall > 0), change, 1.0))

    assert verdict(claims_coefficients.walls_change_regime, make) is holds


def test_a_front_is_compacted_and_thickness_is_not() -> None:
    void = np.where(X > 0.2, 0.06, 0.6)  # a film thicker than a grain that holds next to nothing
    shot = profile(np.where(X > 0.2, 5e-3, 0.05) * (X < 0.5), phi=void).isel(time=0)
    assert front_of(shot) == pytest.approx(0.2, abs=2e-3)
    assert X[mass(shot)].max() < 0.2 and X[mass(shot, 1e-4)].max() == pytest.approx(0.5, abs=1e-3)
    drawn = panels.values(shot, "h")
    assert X[np.isfinite(drawn)].max() == pytest.approx(0.5, abs=2e-3)
    assert X[np.isfinite(panels.values(shot, "phi"))].max() < 0.2


def test_the_stabilization_is_judged_only_where_there_is_one() -> None:
    def make(order: int) -> Callable[..., xr.Dataset]:
        text = Case().with_(**{"scheme.order": order}).to_toml()
        still = profile(wedge(), times=(0.36, 1.38, 1.8)).assign_attrs(case_toml=text)
        return lambda name, **where: still

    assert verdict(claims_scheme.viscosity_on_profiles, make(1)) is True
    for claim in (claims_scheme.viscosity_at_22, claims_scheme.viscosity_at_0, claims_scheme.viscosity_on_profiles):
        finding = claim.evaluate(Made(make(2)))
        assert (finding.holds, finding.value) == (None, "the scheme of order 2 has no viscosity")


# What there is


def test_every_figure_with_results_is_there_and_every_claim_belongs_to_one() -> None:
    names = [picture.name for picture in PICTURES]
    assert names == [f"fig{n:02d}" for n in (2, 3, *range(5, 26))]
    claims = [claim.name for claim in CLAIMS]
    assert len(set(claims)) == len(claims)
    assert REMARKS.keys() | OURS <= set(claims)
    for claim in CLAIMS:
        assert claim.figures and set(claim.figures) <= set(names), claim.name
        assert claim.says and claim.how and claim.place, claim.name
    assert all(picture.title and picture.caption for picture in PICTURES)
    pictures, some = chosen(["fig20", "fig09"])
    assert [picture.name for picture in pictures] == ["fig09", "fig20"]
    assert {claim.name for claim in some} >= {"dense-front-ahead", "loose-slow-regime"}


@pytest.mark.parametrize("file", sorted(shipped_runs().glob("*.toml")), ids=lambda path: path.stem)
def test_run_files_can_be_run_under_every_setting(file: Path) -> None:
    for setting in SETTINGS:
        cases = [setting.apply(case) for case in read_study(file)]
        assert {case.grid.cells for case in cases} == {1800 * setting.refinement}
        for case in cases if setting.as_paper else []:
            assert case.scheme.viscosity == ("paper" if case.rheology.K > 0 else "bounded")
            assert case.scheme.h_bed > 0
        for case in cases if setting.name.startswith("order_2") else []:
            assert case.scheme.order == 2  # which refuses what only order 1 has
            grains = 1 if setting.name == "order_2_grain" else 5
            assert case.flat()["scheme.h_min"] == pytest.approx(grains * case.rheology.grain_diameter)


def test_settings_that_refine_another_name_it_before_them() -> None:
    for n, setting in enumerate(SETTINGS):
        assert not setting.base or setting.base in [other.name for other in SETTINGS[:n] if not other.base]


def test_one_run_is_found_by_its_keys() -> None:
    data = xr.Dataset({"status": ("run", [0, 1]), "end_time": ("run", [1.0, 0.5])}, {"rheology.K": ("run", [0.0, 1.0])})
    data = data.assign(x=("x", [0.0, 1.0]))
    assert float(one_of(data, "a", {"K": 0.0})["end_time"]) == 1.0
    assert float(one_of(data, "a", {"K": 1.0})["end_time"]) == 0.5
    with pytest.raises(NotComputedError, match=r"a holds 0 runs with K = 2\.0"):
        one_of(data, "a", {"K": 2.0})


def test_a_run_that_diverged_is_drawn_to_its_end_and_not_judged(tmp_path: Path) -> None:
    (tmp_path / "bad.toml").write_text(DIVERGING)
    draws, judges = (StoredResults(DEFAULTS, tmp_path, tmp_path / "results", Options(), whole=w) for w in (False, True))
    assert np.isnan(draws.run("bad", angle=0.0)["front"].values[-1])
    assert draws.ended_early == ["the run with angle = 0.0 diverged at t = 0.01 s"]
    with pytest.raises(NotComputedError, match=r"the run with angle = 0\.0 diverged at t = 0\.01 s"):
        judges.run("bad", angle=0.0)


# Laboratory data


def test_laboratory_data_lie_over_the_panels(tmp_path: Path) -> None:
    from matplotlib.figure import Figure

    (tmp_path / "profiles.csv").write_text("angle,t,x,h\n22,0.06,0.0,0.07\n22,0.06,0.1,0.0\n22,0.48,0.0,0.05\n")
    (tmp_path / "front.csv").write_text("# by hand\nt,x,angle\n0.1,0.0,22\n0.2,0.2,22\n0.3,0.3,22\n0.1,0.1,0\n")
    laboratory = read_laboratory(tmp_path)
    ax = Figure().subplots()
    laboratory.profile(ax, 22, 0.06)
    assert list(np.asarray(ax.lines[0].get_ydata())) == pytest.approx([7.0, 0.0])
    laboratory.front_speed(ax, 22)
    assert list(np.asarray(ax.lines[1].get_ydata())) == pytest.approx([2.0, 1.5, 1.0])
    laboratory.front_speed(ax, 0)  # a single position has no speed
    laboratory.profile(ax, 22, 1.38)
    laboratory.volume(ax, 22)
    assert len(ax.lines) == 2


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        (
            "front.csv",
            "angle,t,y\n0,0,0\n",
            r'front\.csv:1: the columns are "angle,t,y"; allowed: angle,t,x and optionally sigma, in',
        ),
        (
            "front.csv",
            "angle,t,x\n0,0.2,1\n0,0.1,1\n",
            r"front\.csv:3: t = 0\.1 after 0\.2; allowed: increasing for each",
        ),
        ("profiles.csv", "angle,t,x,h\n0,0,0,-1\n", r"profiles\.csv:2: h = -1\.0 is out of range; allowed: >= 0"),
        ("volume.csv", "angle,t,change\n0,0,nan\n", r"volume\.csv:2: change = nan is not a finite number"),
        ("front.csv", "angle,t,x,sigma\n0,1,1,0\n", r"front\.csv:2: sigma = 0\.0 is out of range; allowed: > 0"),
        ("front.csv", "angle,t,x\n0,inf,1\n", r"front\.csv:2: t = inf is not a finite number"),
        ("volume.csv", "angle,t,change\n95,0,0\n", r"angle = 95\.0 is out of range; allowed: >= -80 and <= 80"),
        ("notes.txt", "", r"holds no measurements; allowed: profiles\.csv, front\.csv, volume\.csv"),
    ],
)
def test_wrong_laboratory_data_are_refused(tmp_path: Path, name: str, text: str, message: str) -> None:
    (tmp_path / name).write_text(text)
    with pytest.raises(TableError, match=message):
        read_laboratory(tmp_path)


# Results that are kept


def study(angle: float = 20.0) -> Study:
    return small(**{"time.series": {"every": 0.05}, "slope.angle": angle}).sweep({"column.phi": [0.55, 0.62]})


def test_what_matches_is_left_alone_and_what_does_not_is_computed_anew(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    told: list[float] = []
    assert bring_up_to_date(study(), path, Options(), progress=told.append)
    first, runs = path.stat().st_mtime_ns, told.copy()
    assert bring_up_to_date(study(), path, Options(), progress=told.append)
    assert path.stat().st_mtime_ns == first and told == runs and runs[-1] == 2.0
    assert bring_up_to_date(study(10.0), path, Options(), progress=told.append)
    assert "angle = 10.0" in open_dataset(path).attrs["case_toml"]
    path.write_bytes(b"no result")
    with pytest.raises(StorageError, match="is damaged, or no result; remove it first"):
        bring_up_to_date(study(), path, Options())
    path.unlink()
    assert bring_up_to_date(study(), path, Options())
    assert open_dataset(path).sizes["run"] == 2


def test_an_interrupted_study_is_gone_on_with(tmp_path: Path) -> None:
    path, computed = tmp_path / "a.h5", []

    def first_run_only(sink: Any, options: Options, places: Any, progress: Any) -> Any:
        outcome = compute(sink, options, places[:1], progress)
        outcome.interrupted = True
        return outcome

    def told(sink: Any, options: Options, places: Any, progress: Any) -> Any:
        computed.append(list(places))
        return compute(sink, options, places, progress)

    assert not bring_up_to_date(study(), path, Options(), compute=first_run_only)
    assert bring_up_to_date(study(), path, Options(), compute=told)
    assert computed == [[1]] and not part_of(path).exists()


# The command


def warpgran(*arguments: str) -> Result:
    return CliRunner().invoke(app, ["reproduce", *arguments])


@pytest.mark.slow
def test_a_figure_from_end_to_end(tmp_path: Path) -> None:
    out = tmp_path / "out"
    result = warpgran("fig07", "-o", str(out), "--set", "grid.cells=60")
    assert result.exit_code == 0, result.output
    assert result.stdout.splitlines()[-1] == f"wrote {out}/index.html"
    assert sorted(path.name for path in out.iterdir()) == [
        "claims.csv",
        "fig07.png",
        "fig07.svg",
        "index.html",
        "results",
    ]
    assert sorted(path.name for path in (out / "results").iterdir()) == sorted(setting.name for setting in SETTINGS)
    with (out / "claims.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["claim"] for row in rows] == ["same-speed-at-first", "speeds-at-036"]
    assert all(row[f"{setting.name}_verdict"] for row in rows for setting in SETTINGS)
    html = (out / "index.html").read_text()
    assert all(
        text in html for text in ("Fig. 7: Velocity at 0 degrees", "grid.cells=60", "collapses.toml", "data:image")
    )
    kept = (out / "results" / "defaults" / "collapses.h5").stat().st_mtime_ns
    again = warpgran("fig07", "-o", str(out), "--set", "grid.cells=60", "--no-claims", "--setting", "defaults")
    assert again.exit_code == 0
    assert (out / "results" / "defaults" / "collapses.h5").stat().st_mtime_ns == kept
    assert not (out / "claims.csv").exists()  # no table of claims beside a page that judged none


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["fig04"], "fig04: no such figure; allowed: fig02, fig03, fig05"),
        (["--setting", "fine"], "setting: 'fine' is not known; allowed: defaults, paper_form, order_2, defaults_2x"),
        (["--runs", "nowhere"], "runs: nowhere is not a folder of run files"),
        (["--data", "nowhere"], "nowhere: is not a folder of measurements"),
        (["fig07", "--set", "grid.cell=90"], "grid.cell: unknown key; did you mean grid.cells?"),
    ],
)
def test_bad_input_is_told_in_a_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], message: str
) -> None:
    monkeypatch.chdir(tmp_path)
    result = warpgran(*arguments)
    assert result.exit_code == 2
    assert message in result.stderr
    assert not list(tmp_path.rglob("*.png"))
