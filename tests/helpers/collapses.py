"""Results made by hand: a cap of material that slides and spreads."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from warpgran.analysis.run_values import final_values, run_values

CASE = """
title = "Dense column, 22 degrees"
[rheology]
mu1 = 0.48
mu2 = 0.73
I0 = 0.279
grain_diameter = 7e-4
K = 4.09
K_tilde = 0.2
phi_stat = 0.582
phi_eq = "f2"
phi_eq_N = 1.0
mu_wall = 0.0
channel_width = 0.2
[slope]
angle = 22.0
gravity = 9.81
[column]
height = 0.14
length = 0.2
phi = 0.62
start = -0.2
[grid]
left = -0.2
right = 1.0
cells = 240
[time]
end = 0.9
rest_speed = 1e-3
[scheme]
order = 2
start = 2
h_min = 3.5e-3
h_front = 1.4e-3
left = "wall"
right = "open"
"""


def collapse(cells: int = 240, snapshots: int = 4, samples: int = 100, runs: int = 1) -> xr.Dataset:
    """A parabolic cap that spreads from 0.2 m to 0.8 m and comes to rest after 0.6 s, in every run alike."""
    x = -0.2 + 1.2 * (np.arange(cells) + 0.5) / cells
    time, series_time = np.linspace(0.0, 0.9, snapshots), np.linspace(0.0, 0.9, samples)

    def length(t: np.ndarray) -> np.ndarray:
        return 0.2 + 0.6 * np.sin(np.pi / 2 * np.clip(t / 0.6, 0, 1)) ** 2

    def speed(t: np.ndarray) -> np.ndarray:
        return 0.6 * np.pi / 1.2 * np.sin(np.pi * np.clip(t / 0.6, 0, 1))

    s = (x + 0.2) / length(time)[:, None]
    phi = np.clip(0.62 - 0.06 * s, 0.5, 0.62)
    h = 0.042 / length(time)[:, None] * np.clip(1 - s**2, 0, None) * 0.62 / phi
    v = np.where(h > 0, speed(time)[:, None] * s, 0.0)
    series = {
        "front": -0.2 + length(series_time),
        "front_speed": speed(series_time),
        "h_max": 0.042 / length(series_time),
        "v_max": 2.0 * speed(series_time),
        "v_flow": speed(series_time),
        "volume_change": 0.05 * (1 - np.exp(-series_time / 0.2)),
        "mass": np.full(samples, 0.017),
        "energy": 1e-3 * np.exp(-series_time),
        "outflow": np.zeros(samples),
    }
    variables: dict[str, Any] = {
        "bed": ("x", np.zeros(cells)),
        "status": ("run", np.full(runs, "ok", dtype=object)),
        "steps": ("run", np.full(runs, 1000)),
        "end_time": ("run", np.full(runs, 0.9)),
    }
    coordinates = {"run": np.arange(runs), "time": time, "series_time": series_time, "x": x}
    variables |= {k: (("run", "time", "x"), np.stack([f] * runs)) for k, f in {"h": h, "v": v, "phi": phi}.items()}
    variables |= {k: (("run", "series_time"), np.stack([f] * runs)) for k, f in series.items()}
    return with_values(xr.Dataset(variables, coordinates, {"case_toml": CASE}))


def with_values(data: xr.Dataset) -> xr.Dataset:
    """The result with the values of each run that follow from its series."""
    series = {name: data[name].values for name in ("front", "h_max", "volume_change", "v_flow", "outflow")}
    values = run_values(data["series_time"].values, series, np.full(data.sizes["run"], 1e-3))
    values |= final_values(series, {name: each[:, -1:] for name, each in series.items()})
    return data.assign({name: ("run", value) for name, value in values.items()})


def two_runs() -> xr.Dataset:
    """Two runs at 0 and -12.5 degrees on a bump; the second diverged at two thirds."""
    data = collapse(snapshots=12, runs=2)
    data = data.assign_coords({"slope.angle": ("run", [0.0, -12.5]), "column.length": ("run", [0.2, 0.25])})
    data["bed"] = "x", 0.05 * np.exp(-(((data["x"].values - 0.3) / 0.1) ** 2))
    for name in ("h", "v", "phi"):
        data[name][1, 8:] = np.nan
    for name in ("front", "front_speed", "h_max", "v_max", "v_flow", "volume_change"):
        data[name][1, 66:] = np.nan
    data["status"] = "run", np.array([0, 1]), {"flag_values": np.array([0, 1]), "flag_meanings": "ok diverged"}
    return with_values(data)


def batch(samples: int = 100, diverged: tuple[int, ...] = (), **values: Any) -> xr.Dataset:
    """Runs whose front, thickness and dilation grow by 10 % from one to the next; some diverge after 50 samples.

    Values: of a swept key in each run, the dot of the key as two underscores.
    """
    runs = len(next(iter(values.values())))
    data = collapse(cells=8, snapshots=1, samples=samples, runs=runs)
    data = data.assign_coords({key.replace("__", "."): ("run", np.array(value)) for key, value in values.items()})
    growth = 1.0 + 0.1 * np.arange(runs)[:, None]
    data["front"] = data["front"] * growth
    for name in ("h_max", "volume_change"):
        data[name] = data[name] * growth
    for run in diverged:
        for name in ("front", "h_max", "volume_change"):
            data[name][run, 50:] = np.nan
        data["v_flow"][run, 50:] = np.nan
        data["status"][run] = "diverged"
    return with_values(data)


def by_hand() -> xr.Dataset:
    """Three runs of four samples: one to the end, one that diverged, one that has nothing."""
    series = {
        "front": [[0.0, 0.2, 0.5, 0.4], [0.1, 0.3, np.nan, np.nan], [np.nan] * 4],
        "h_max": [[0.14, 0.12, 0.1, 0.09], [0.14, 0.2, np.inf, np.nan], [np.nan] * 4],
        "volume_change": [[0.0, 0.05, 0.04, -0.01], [0.0, -0.1, np.inf, np.nan], [np.nan] * 4],
        "v_flow": [[0.0, 0.5, 1e-4, 1e-5], [0.0, 0.5, np.inf, np.nan], [np.nan] * 4],
        "outflow": [[0.0] * 4, [0.0, 0.2, np.inf, np.nan], [np.nan] * 4],
    }
    variables: dict[str, Any] = {name: (("run", "series_time"), np.array(values)) for name, values in series.items()}
    flags = {"flag_values": np.array([0, 1, 3]), "flag_meanings": "ok diverged interrupted"}
    variables |= {
        "status": ("run", np.array([0, 1, 3]), flags),
        "steps": ("run", np.array([900, 70, 0])),
        "end_time": ("run", np.array([0.3, 0.14, 0.0])),
    }
    coordinates = {"slope.angle": ("run", [0.0, 10.0, 22.0]), "rheology.phi_eq": ("run", np.array(["f0", "f1", "f2"]))}
    times = {"series_time": [0.0, 0.1, 0.2, 0.3]}
    return with_values(xr.Dataset(variables, {"run": [4, 5, 6], **times, **coordinates}))
