"""Derived fields against values worked out by hand from step 2 of the scheme."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest
import xarray as xr
from helpers.cases import small

import warpgran as wg
from warpgran.analysis.fields import derive, parameter
from warpgran.case.study import Study
from warpgran.errors import ResultError
from warpgran.run.options import Options
from warpgran.run.to_file import run_to_file

CASE = """
[rheology]
mu1 = 0.48
mu2 = 0.73
I0 = 0.279
grain_diameter = 7e-4
K = 4.0
K_tilde = 0.2
phi_stat = 0.582
phi_eq = "f2"
phi_eq_N = 1.0
mu_wall = 0.18
channel_width = 0.2
[slope]
angle = 60.0
gravity = 9.81
[scheme]
h_min = 7e-4
"""
# h_e = 0.1, v = 2: gamma = 50; g_c = 9.81/2 = 4.905; phi g_c h_e = 0.62 * 0.4905 = 0.30411;
# I = 50 * 7e-4 / sqrt(0.30411) = 0.063467690; phi_eq = 0.582^2 / (0.582 + 0.2 I) = 0.569577401
GAMMA, INERTIAL, PHI_EQ = 50.0, 0.063467690, 0.569577401
TAN_PSI = 4.0 * (0.62 - PHI_EQ)
MU = 0.48 + 0.25 * INERTIAL / (INERTIAL + 0.279) + TAN_PSI + 0.18 * 0.1 / 0.2


def result(h: Any = 0.1, v: Any = 2.0, phi: Any = 0.62, runs: int = 1) -> xr.Dataset:
    """One snapshot of one cell, the same in every run."""
    dims, shape = ("run", "time", "x"), (runs, 1, 1)
    fields = {name: (dims, np.full(shape, value)) for name, value in (("h", h), ("v", v), ("phi", phi))}
    return xr.Dataset(fields, attrs={"case_toml": CASE})


def value(data: xr.Dataset, name: str) -> float:
    return float(derive(data, name)[name].values.flat[0])


@pytest.mark.parametrize(
    ("name", "expected"),
    [("gamma", GAMMA), ("I", INERTIAL), ("phi_eq", PHI_EQ), ("psi", np.degrees(np.arctan(TAN_PSI))), ("mu", MU)],
)
@pytest.mark.parametrize("v", [2.0, -2.0])
def test_values_by_hand(name: str, expected: float, v: float) -> None:
    assert value(result(v=v), name) == pytest.approx(expected, rel=1e-6)


def test_at_rest_only_packing_counts() -> None:
    fields = derive(result(v=0.0, phi=0.55)).squeeze()
    assert [float(fields[name]) for name in ("gamma", "I", "phi_eq")] == [0.0, 0.0, 0.582]
    assert float(fields["psi"]) == pytest.approx(np.degrees(np.arctan(-0.128)))
    assert float(fields["mu"]) == pytest.approx(0.48 - 0.128 + 0.09)


def test_friction_is_cut_at_zero_before_the_walls() -> None:
    assert value(result(v=0.0, phi=0.3), "mu") == pytest.approx(0.09)


def test_thinner_than_one_grain_is_as_one_grain() -> None:
    assert value(result(h=1e-5), "gamma") == pytest.approx(2.5 * 2.0 / 7e-4)
    data = result(h=1e-5)
    data.attrs["case_toml"] = CASE.replace("h_min = 7e-4", "h_min = 1e-3")
    assert value(data, "gamma") == pytest.approx(2.5 * 2.0 / 1e-3)


def test_each_run_has_its_own_parameters() -> None:
    data = result(runs=4).assign_coords(
        {
            "rheology.phi_eq": ("run", ["f0", "f1", "f2", "f2"]),
            "rheology.phi_eq_N": ("run", [1.0, 1.0, 1.0, 3.0]),
            "rheology.K": ("run", [0.0, 1.0, 4.0, 4.0]),
        }
    )
    kt_i = 0.2 * INERTIAL
    expected = [
        0.582 - kt_i,
        0.582 * np.exp(-kt_i / 0.582),
        PHI_EQ,
        0.582 / (1 + kt_i / (3 * 0.582)) ** 3,
    ]
    fields = derive(data)
    np.testing.assert_allclose(fields["phi_eq"].values[:, 0, 0], expected, rtol=1e-6)
    tan_psi = np.array([0.0, 1.0, 4.0, 4.0]) * (0.62 - np.array(expected))
    np.testing.assert_allclose(fields["psi"].values[:, 0, 0], np.degrees(np.arctan(tan_psi)), rtol=1e-5, atol=1e-12)
    one = derive(data.isel(run=1), "phi_eq")
    assert one["phi_eq"].dims == ("time", "x")
    assert one["phi_eq"].item() == fields["phi_eq"].values[1, 0, 0]


def test_slope_of_each_run() -> None:
    data = result(runs=2).assign_coords({"slope.angle": ("run", [60.0, 0.0])})
    np.testing.assert_allclose(derive(data, "I")["I"].values[:, 0, 0], [INERTIAL, INERTIAL / np.sqrt(2)], rtol=1e-6)


def joined(*results: xr.Dataset) -> xr.Dataset:
    return xr.concat(results, "run", data_vars="all", coords="different", compat="equals", join="outer")


def assert_as_alone(together: xr.Dataset, *alone: xr.Dataset) -> None:
    """The derived fields and forces of joined results are those of each of its results."""
    for compute in (derive, wg.forces):
        fields = compute(together)
        for name in fields:
            each = np.concatenate([compute(result)[name].values for result in alone])
            np.testing.assert_allclose(fields[name], each, rtol=1e-14, err_msg=str(name))


@pytest.mark.slow
def test_runs_of_joined_results_keep_their_own_parameters(tmp_path: Path) -> None:
    a, b = small(**{"rheology.K": 1.0, "slope.angle": 0.0}), small(**{"rheology.phi_eq": "f0"})
    one, other = wg.simulate(a), wg.simulate(b)
    assert_as_alone(joined(one, other), one, other)
    run_to_file(Study.of([a]), tmp_path / "a.h5", Options())
    together = joined(wg.open_dataset(tmp_path / "a.h5"), other)
    assert_as_alone(together, one, other)
    assert parameter(together, "rheology.K").values.tolist() == [1.0, 4.09]
    assert parameter(together.isel(run=0), "rheology.K").item() == 1.0
    assert parameter(together, "rheology.mu1").dims == ()


def test_a_sweep_may_be_joined_with_a_run_that_lacks_its_keys() -> None:
    sweep = wg.simulate(small().sweep({"rheology.K": [1.0, 2.0], "rheology.phi_eq": ["f0", "f1"]}, mode="zip"))
    alone = wg.simulate(small(**{"rheology.K": 3.0}))
    together = joined(
        sweep.reset_coords(["rheology.K", "rheology.phi_eq"]), alone
    )  # concat fills what is no coordinate
    assert together["rheology.K"].values.tolist()[:2] == [1.0, 2.0] and np.isnan(together["rheology.K"][2])
    assert parameter(together, "rheology.K").values.tolist() == [1.0, 2.0, 3.0]
    assert parameter(together, "rheology.phi_eq").values.tolist() == ["f0", "f1", "f2"]
    assert_as_alone(together, sweep, alone)


def test_thickness_of_one_grain_follows_a_swept_grain() -> None:
    grains = [1e-3, 2e-2]
    sweep = wg.simulate(small().sweep({"rheology.grain_diameter": grains}))
    for run, d in enumerate(grains):
        alone = wg.simulate(small(**{"rheology.grain_diameter": d}))
        np.testing.assert_array_equal(derive(sweep, "gamma").gamma[run], derive(alone, "gamma").gamma[0])


def test_the_text_is_parsed_once(monkeypatch: pytest.MonkeyPatch) -> None:
    data = result(runs=3).assign_attrs(case_toml=CASE + "# another text\n")
    parsed = Mock(wraps=tomllib.loads)
    monkeypatch.setattr("tomllib.loads", parsed)
    derive(data)
    assert parsed.call_count == 1


def test_a_law_that_is_not_known_is_an_error() -> None:
    data = result(runs=2).assign_coords({"rheology.phi_eq": ("run", ["f2", "other"])})
    with pytest.raises(ResultError, match="the law 'other' is not known; known: f0, f1, f2"):
        derive(data, "mu")


def test_f0_does_not_fall_below_zero() -> None:
    data = result(h=7e-4, v=50.0).assign_coords({"rheology.phi_eq": ("run", ["f0"])})
    assert value(data, "phi_eq") == 0.0


def test_what_was_not_computed_stays_so() -> None:
    fields = derive(result(h=np.nan, v=np.nan, phi=np.nan))
    assert all(np.isnan(fields[name].values).all() for name in fields)


def test_fields_say_what_they_are() -> None:
    fields = derive(result(runs=2))
    assert list(fields) == ["gamma", "I", "phi_eq", "psi", "mu"]
    assert [fields[name].attrs["units"] for name in fields] == ["s-1", "1", "1", "degree", "1"]
    for field in fields.values():
        assert field.dims == ("run", "time", "x")
        assert "(2." in field.attrs["long_name"]


def test_errors_name_what_is_wrong() -> None:
    with pytest.raises(ValueError, match="cannot derive tau: the known fields are gamma, I, phi_eq, psi, mu"):
        derive(result(), "I", "tau")
    with pytest.raises(ValueError, match=r"does not say what scheme\.h_min was"):
        derive(result().drop_attrs(), "gamma")


def test_parameter_of_the_run_file_and_its_default() -> None:
    assert parameter(result(), "rheology.mu1").item() == 0.48
    assert parameter(result(), "column.phi", 0.6).item() == 0.6


def test_gravity_is_that_of_the_run_file() -> None:
    data = result()
    data.attrs["case_toml"] = CASE.replace("9.81", "1.62")  # on the moon
    assert value(data, "I") == pytest.approx(INERTIAL * np.sqrt(9.81 / 1.62), rel=1e-6)
