"""What the page holds of each run: its profiles at the snapshots, on a share of its cells, and its series.

Of a long grid every second, third, ... cell is taken, and those without which a profile would be another one: of each
snapshot where the mass begins and ends, and where it is thickest and fastest. Nothing is a mean: what is read on the
page is a number of the file.

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
FACTS = {
    "angle": "slope.angle", "phi_stat": "rheology.phi_stat", "h_front": "scheme.h_front",
    "rest_speed": "time.rest_speed",
}  # fmt: skip
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
        marks: cells that are kept for what happens in them, -1 for none, shape (run, mark).
        computed: snapshots that a run reached, shape (run, time).
        deepest: largest thickness [m], shape (run,).
    """

    ever: np.ndarray
    marks: np.ndarray
    computed: np.ndarray
    deepest: Array

    def cells(self, run: int, grid: int) -> np.ndarray:
        """The cells of a run from the first to the last that is ever in the mass, with a margin of 4 %; all if none."""
        found = np.flatnonzero(self.ever[run, :grid])
        if not found.size:
            return np.arange(grid)
        margin = max(2, round(0.04 * (found[-1] - found[0])))
        return np.arange(max(0, found[0] - margin), min(grid, found[-1] + margin + 1))

    def chosen(self, run: int, grid: int, most: int) -> tuple[np.ndarray, int]:
        """The cells of a run that the page holds, and how many of the grid stand for one that is taken evenly.

        At least half of `most` are taken evenly; those that are kept for what happens in them come on top.
        """
        cells = self.cells(run, grid)
        if cells.size <= most:
            return cells, 1
        kept = np.unique(self.marks[run])
        kept = kept[(kept >= cells[0]) & (kept <= cells[-1])]
        stride = -(-cells.size // max(most - kept.size, most // 2))
        return np.union1d(cells[::stride], kept), stride


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
    parts = list(_in_parts(data.isel(time=instants)))
    wet = _wet(parts)
    x, bed = _of_grids(data, "x"), _of_grids(data, "bed")
    grids = np.isfinite(x).sum(axis=1).tolist()
    chosen = [wet.chosen(run, grid, most_cells) for run, grid in enumerate(grids)]
    fields = _fields(parts, chosen[0][0] if len(rows) == 1 else None)
    series = {name: data[name].transpose("run", "series_time").values.astype(float) for name in SERIES}
    facts = {key: _of_runs(data, name) for key, name in FACTS.items()}
    texts = []
    for run, row in enumerate(rows):
        (here, stride), reached = chosen[run], wet.computed[run]
        samples = _samples([values[run] for values in series.values()])
        packing = Packing(
            {
                "row": row,
                "time": data["time"].values[instants][reached].tolist(),
                "series_time": data["series_time"].values[samples].tolist(),
                "x": [float(x[run, here[0]]), float(x[run, here[-1]])],
                "cells": int(here.size),
                "stride": stride,
                "grid": grids[run],
                "thinned": {
                    "snapshots": _share(instants, data.sizes["time"]),
                    "samples": _share(samples, data.sizes["series_time"]),
                },
                "deepest": float(wet.deepest[run]),
                **{key: float(values[run]) for key, values in facts.items()},
            }
        )
        if stride > 1:
            packing.add("gap", np.diff(here).astype(float))
        packing.add("bed", bed[run, here])
        for name, values in fields.items():
            packing.add(name, values[run][reached][:, slice(None) if len(rows) == 1 else here])
        for name, values in series.items():
            packing.add(name, values[run, samples])
        texts.append(packing.text())
    return texts


def _share(chosen: np.ndarray, size: int) -> str:
    """`500 of 2000` where not all are chosen."""
    return f"{chosen.size} of {size}" if chosen.size < size else ""


def _even(size: int, most: int) -> np.ndarray:
    """At most so many of the numbers 0 to size - 1, evenly spread, the first and the last among them."""
    return np.arange(size) if size <= most else np.linspace(0, size - 1, most).round().astype(int)


def _samples(series: Sequence[Array]) -> np.ndarray:
    """At most so many samples, evenly spread, and beside them the least and the largest value of each series."""
    even = _even(series[0].size, MOST_SAMPLES)
    finite = [np.where(np.isfinite(values), values, np.nan) for values in series if np.isfinite(values).any()]
    return np.union1d(even, [f(values) for values in finite for f in (np.nanargmin, np.nanargmax)]).astype(int)


def _of_runs(data: xr.Dataset, key: str) -> Array:
    """A parameter in each run, shape (run,)."""
    return np.broadcast_to(parameter(data, key).values.astype(float), data.sizes["run"])


def _of_grids(data: xr.Dataset, name: str) -> Array:
    """x or the bed of each run, shape (run, x), also where all have the same."""
    values = data[name].values.astype(float)
    return np.broadcast_to(values, (data.sizes["run"], values.shape[-1]))


def _in_parts(data: xr.Dataset) -> Iterator[xr.Dataset]:
    """Groups of snapshots that are small enough to read at once; in memory already if there is but one."""
    names = {"h", "v", "phi"}
    fields = data.drop_vars(set(data.data_vars) - names)
    if not data.sizes["time"]:  # of a file no numbers can be read where there are none
        yield fields.assign({name: (data[name].dims, np.empty(data[name].shape)) for name in names})
        return
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
        held = part.compute()  # not load, by which the part would keep it
        h, v = (held[name].transpose("run", "time", ...).values for name in ("h", "v"))
        mass = thick(held).transpose("run", "time", ...).values
        finite = np.isfinite(h)
        deepest = np.max(h, axis=(1, 2), where=finite, initial=0.0)
        found.append((mass.any(axis=1), _marks(mass, h, v), finite.any(axis=2), deepest))
    ever, marks, computed, deepest = zip(*found, strict=True)
    return Wet(
        np.any(ever, axis=0), np.concatenate(marks, axis=1), np.concatenate(computed, axis=1), np.max(deepest, axis=0)
    )


def _marks(mass: np.ndarray, h: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Cells at the ends of the mass, on both sides of each, and where it is thickest and fastest.

    Args:
        mass: whether a cell is in it, shape (run, time, x).
        h: thickness, of the same shape.
        v: velocity, of the same shape.

    Returns:
        Numbers of cells, -1 where there is no mass, shape (run, 6 time).
    """
    if not mass.shape[1]:
        return np.zeros((len(mass), 0), dtype=int)
    rear, front = mass.argmax(axis=2), mass.shape[2] - 1 - mass[..., ::-1].argmax(axis=2)
    peaks = [np.where(mass & np.isfinite(size), size, -1.0).argmax(axis=2) for size in (h, np.abs(v))]
    marks = np.stack([rear - 1, rear, front, front + 1, *peaks])
    return np.concatenate(np.where(mass.any(axis=2), marks, -1), axis=1)


def _fields(parts: Sequence[xr.Dataset], cells: np.ndarray | None) -> dict[str, np.ndarray]:
    """Each profile, at some cells or at all, shape (run, time, cells)."""
    found: dict[str, list[np.ndarray]] = {name: [] for name in PROFILES}
    for part in parts:
        here = part.compute() if len(parts) > 1 else part
        here = here if cells is None else here.isel({along(part): cells})
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
