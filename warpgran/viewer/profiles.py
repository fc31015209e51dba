"""What the page holds of each run: its profiles at the snapshots, on a share of its cells, and its series.

Runs are read in blocks; of a large run no more than some snapshots are in memory at once.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from warpgran.analysis.fields import derive, parameter
from warpgran.analysis.front import thick
from warpgran.analysis.selection import along
from warpgran.arrays import Array
from warpgran.viewer.sixteen_bits import Packing

PROFILES = ("h", "v", "phi", "psi", "mu", "I")
MASS_ALONE = PROFILES[1:]
"""Profiles that are shown only where the compacted thickness exceeds h_front, as in the figures."""
SERIES = (
    "front", "h_max", "v_flow", "volume_change", "front_speed", "v_max", "mass", "energy", "outflow",
)  # fmt: skip
FACTS = {"angle": "slope.angle", "phi_stat": "rheology.phi_stat", "h_front": "scheme.h_front"}
"""Parameters that the page draws with."""
MOST_SNAPSHOTS = 500
MOST_SAMPLES = 1000
AT_ONCE = 1_000_000
"""Most values of a field that are read at once, if one snapshot has no more."""
MOST_RUNS = 64
"""Most runs of a block."""


@dataclass
class Wet:
    """Where the mass of the runs of a block is.

    Attributes:
        ever: cells that are in it at any snapshot, shape (run, x).
        computed: snapshots that a run reached, shape (run, time).
        deepest: largest thickness [m], shape (run,).
    """

    ever: np.ndarray
    computed: np.ndarray
    deepest: Array

    def cells(self, run: int, grid: int) -> np.ndarray:
        """The cells of a run from the first to the last that is ever in the mass, with a margin of 4 %; all if none."""
        found = np.flatnonzero(self.ever[run, :grid])
        if not found.size:
            return np.arange(grid)
        margin = max(2, round(0.04 * (found[-1] - found[0])))
        return np.arange(max(0, found[0] - margin), min(grid, found[-1] + margin + 1))


def runs_at_once(data: xr.Dataset) -> int:
    """How many runs of a result make a block."""
    return max(1, min(MOST_RUNS, AT_ONCE // max(1, data.sizes["time"] * data.sizes[along(data)])))


def packed_runs(data: xr.Dataset, rows: Sequence[int], most_cells: int) -> list[str]:
    """The pieces of the page that hold the runs of a block.

    Args:
        data: a result with the runs of the block alone.
        rows: their rows in the table of the page.
        most_cells: most cells of a profile.
    """
    instants = _even(data.sizes["time"], MOST_SNAPSHOTS)
    samples = _even(data.sizes["series_time"], MOST_SAMPLES)
    parts = list(_in_parts(data.isel(time=instants)))
    wet = _wet(parts)
    x, bed = _of_grids(data, "x"), _of_grids(data, "bed")
    grids = np.isfinite(x).sum(axis=1).tolist()
    cells = [wet.cells(run, grid) for run, grid in enumerate(grids)]
    strides = [max(1, -(-every.size // most_cells)) for every in cells]
    cells = [every[::stride] for every, stride in zip(cells, strides, strict=True)]
    alone = slice(int(cells[0][0]), int(cells[0][-1]) + 1, strides[0]) if len(rows) == 1 else slice(None)
    fields = _fields(parts, alone)
    series = {name: data[name].transpose("run", "series_time").values[:, samples].astype(float) for name in SERIES}
    facts = {key: _of_runs(data, name) for key, name in FACTS.items()}
    texts = []
    for run, row in enumerate(rows):
        here, reached = cells[run], wet.computed[run]
        packing = Packing(
            {
                "row": row,
                "time": data["time"].values[instants][reached].tolist(),
                "series_time": data["series_time"].values[samples].tolist(),
                "x": [float(x[run, here[0]]), float(x[run, here[-1]])],
                "cells": int(here.size),
                "stride": strides[run],
                "grid": grids[run],
                "thinned": {
                    "snapshots": _share(instants, data.sizes["time"]),
                    "samples": _share(samples, data.sizes["series_time"]),
                },
                "deepest": float(wet.deepest[run]),
                **{key: float(values[run]) for key, values in facts.items()},
            }
        )
        packing.add("bed", bed[run, here])
        for name, values in fields.items():
            packing.add(name, values[run][reached][:, slice(None) if len(rows) == 1 else here])
        for name, values in series.items():
            packing.add(name, values[run])
        texts.append(packing.text())
    return texts


def _share(chosen: np.ndarray, size: int) -> str:
    """`500 of 2000` where not all are chosen."""
    return f"{chosen.size} of {size}" if chosen.size < size else ""


def _even(size: int, most: int) -> np.ndarray:
    """At most so many of the numbers 0 to size - 1, evenly spread, the first and the last among them."""
    return np.arange(size) if size <= most else np.linspace(0, size - 1, most).round().astype(int)


def _of_runs(data: xr.Dataset, key: str) -> Array:
    """A parameter in each run, shape (run,)."""
    return np.broadcast_to(parameter(data, key).values.astype(float), data.sizes["run"])


def _of_grids(data: xr.Dataset, name: str) -> Array:
    """x or the bed of each run, shape (run, x), also where all have the same."""
    values = data[name].values.astype(float)
    return np.broadcast_to(values, (data.sizes["run"], values.shape[-1]))


def _in_parts(data: xr.Dataset) -> Iterator[xr.Dataset]:
    """Groups of snapshots that are small enough to read at once; in memory already if there is but one."""
    others = set(data.data_vars) - {"h", "v", "phi"}
    fields = data.drop_vars(others)
    together = max(1, AT_ONCE // (data.sizes["run"] * data.sizes[along(data)]))
    if data.sizes["time"] <= together:
        yield fields.load()
        return
    for start in range(0, data.sizes["time"], together):
        yield fields.isel(time=slice(start, start + together))


def _wet(parts: Sequence[xr.Dataset]) -> Wet:
    """Where the mass is, part by part."""
    found = []
    for part in parts:
        held = part.drop_vars("v").compute()  # not load, by which the part would keep it
        h = held["h"].transpose("run", "time", ...).values
        mass = thick(held).transpose("run", "time", ...).values
        finite = np.isfinite(h)
        found.append((mass.any(axis=1), finite.any(axis=2), np.max(h, axis=(1, 2), where=finite, initial=0.0)))
    ever, computed, deepest = zip(*found, strict=True)
    return Wet(np.any(ever, axis=0), np.concatenate(computed, axis=1), np.max(deepest, axis=0))


def _fields(parts: Sequence[xr.Dataset], cells: slice) -> dict[str, np.ndarray]:
    """Each profile at some cells, shape (run, time, cells)."""
    found: dict[str, list[np.ndarray]] = {name: [] for name in PROFILES}
    for part in parts:
        here = part.isel({along(part): cells}).load()
        here = (
            here.assign(derive(here, "psi", "mu", "I"))
            if here.sizes["time"]
            else here.assign(psi=here["h"], mu=here["h"], I=here["h"])
        )
        mass = thick(here).transpose("run", "time", ...).values
        for name, values in found.items():
            shown = here[name].transpose("run", "time", ...).values.astype(float)
            values.append(np.where(mass, shown, np.nan) if name in MASS_ALONE else shown)
    return {name: np.concatenate(values, axis=1) for name, values in found.items()}
