"""The forces of the momentum equation: by hand, and their balance in a computed run."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from helpers.cases import small

import warpgran as wg

CASE = """
[rheology]
mu1 = 0.4
mu2 = 0.4
I0 = 0.3
grain_diameter = 1e-3
K = 0.0
K_tilde = 0.2
phi_stat = 0.6
phi_eq = "f2"
phi_eq_N = 1.0
mu_wall = 0.0
channel_width = 0.2
[slope]
angle = 30.0
gravity = 10.0
[scheme]
h_min = 1e-3
[time]
rest_speed = 1e-3
"""
G_C = 10.0 * np.cos(np.pi / 6)


def wedge(v0: float, v1: float) -> xr.Dataset:
    """h = 0.1 (1 - x), phi = 0.5, and a uniform velocity that goes from v0 to v1 within 0.01 s; bed b = 0.2 x."""
    x = np.linspace(0.05, 0.95, 10)
    h = np.tile(0.1 * (1 - x), (1, 2, 1))
    v = np.stack([np.full(10, v0), np.full(10, v1)])[None]
    dims = ("run", "time", "x")
    fields = {"h": (dims, h), "v": (dims, v), "phi": (dims, np.full_like(h, 0.5)), "bed": ("x", 0.2 * x)}
    return xr.Dataset(fields, {"x": ("x", x), "time": [0.0, 0.01]}, {"case_toml": CASE})


def test_values_by_hand() -> None:
    found = wg.forces(wedge(1.0, 1.1)).isel(run=0, time=0, x=5)  # x = 0.55, h = 0.045
    solid = 0.5 * 0.045
    assert float(found["f_acc"]) == pytest.approx(solid * 0.1 / 0.01)
    assert float(found["f_inert"]) == pytest.approx(-0.5 * 0.1 * 1.0**2)
    assert float(found["f_press"]) == pytest.approx(G_C * 0.5 * 0.045 * 0.1)
    assert float(found["f_grav"]) == pytest.approx(G_C * solid * (np.tan(np.pi / 6) - 0.2))
    assert float(found["f_fric"]) == pytest.approx(-0.4 * G_C * solid)


def test_friction_turns_with_the_velocity_and_holds_what_is_at_rest() -> None:
    back = wg.forces(wedge(-1.0, -1.0)).isel(run=0, time=0, x=5)
    assert float(back["f_fric"]) == pytest.approx(0.4 * G_C * 0.5 * 0.045)
    still = wg.forces(wedge(0.0, 0.0)).isel(run=0, time=0, x=5)  # tan 30 - 0.2 + 0.1 = 0.477 is more than mu = 0.4
    assert float(still["f_fric"]) == pytest.approx(-0.4 * G_C * 0.5 * 0.045)
    gentle = wedge(0.0, 0.0)
    gentle["bed"] = 0.4 * gentle["x"]  # 0.277
    held = wg.forces(gentle).isel(run=0, time=0, x=5)
    assert float(held["f_fric"]) == pytest.approx(-float(held["f_press"] + held["f_grav"]))


def test_they_balance_in_a_computed_run() -> None:
    case = small(**{"time.snapshots": [0.099, 0.1, 0.101], "time.end": 0.101, "time.series": []})
    data = wg.simulate(case).isel(run=0)
    found = wg.forces(data).isel(time=1)
    shot = data.isel(time=1)
    moving = (shot["h"] > 0.02) & (abs(shot["v"]) > 0.05)
    rest = found["f_acc"] + found["f_inert"] - found["f_press"] - found["f_grav"] - found["f_fric"]
    assert moving.sum() > 20
    assert float(abs(rest).where(moving).mean()) < 0.1 * float(abs(found["f_press"]).where(moving).mean())


def test_runs_have_their_own_slope_and_names() -> None:
    data = wedge(1.0, 1.0).isel(run=[0, 0]).assign_coords({"slope.angle": ("run", [30.0, 0.0])})
    found = wg.forces(data)
    assert found["f_grav"].dims == ("run", "time", "x")
    assert float(found["f_grav"][1, 0, 5]) == pytest.approx(-10.0 * 0.5 * 0.045 * 0.2)
    assert all(found[name].attrs["units"] == "m2 s-2" for name in found)
    assert found["f_press"].isel(x=[0, -1]).isnull().all()


def test_one_snapshot_is_too_few() -> None:
    with pytest.raises(ValueError, match="the acceleration needs two snapshots or more, close to each other"):
        wg.forces(wedge(1.0, 1.0).isel(time=[0]))
