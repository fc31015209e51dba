"""Parts of a result that figures draw: one run, the snapshots that it reached, the cells that the mass covers."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from warpgran.analysis import derived
from warpgran.analysis.run_columns import RunColumns
from warpgran.arrays import Array
from warpgran.errors import ResultError

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class OneRun:
    """One run of a result over x, in memory.

    Attributes:
        place: Of the run in the result, counted from 0.
        runs: How many the result holds.
        columns: The run alone.
        x, bed: Cell centres and bed [m], shape (cells,).
        time: Of the snapshots [s], shape (snapshots,).
        h, v, phi: Thickness [m], velocity [m/s] and volume fraction [-], shape (snapshots, cells).
    """

    place: int
    runs: int
    columns: RunColumns
    x: Array
    bed: Array
    time: Array
    h: Array
    v: Array
    phi: Array

    @property
    def status(self) -> str:
        """How it ended."""
        return str(self.columns.status.item())

    def series(self, name: str) -> Array:
        """A series, shape (samples,)."""
        return np.asarray(self.columns.series[name][0])

    def parameter(self, key: str, default: Any = None) -> Any:
        """What a dotted key of the run file was."""
        return self.columns.parameter(key, default).item()

    def at(self, instants: Any = slice(None), cells: Any = slice(None)) -> OneRun:
        """The same at some snapshots and cells."""
        fields = {name: getattr(self, name)[instants][:, cells] for name in ("h", "v", "phi")}
        return replace(self, x=self.x[cells], bed=self.bed[cells], time=self.time[instants], **fields)


def one_run(data: xr.Dataset | RunColumns, run: int) -> OneRun:
    """One run over x, without the cells that only pad its grid.

    Raises:
        ResultError: No such run.
    """
    columns = RunColumns.of(data)
    runs = columns.run.size
    if not 0 <= run < runs:
        raise ResultError(f"there is no run {run}: the result holds {runs}, counted from 0")
    alone = columns.pick(run)
    fields = {name: values[0] for name, values in alone.fields.items()}
    whole = OneRun(run, runs, alone, alone.x, alone.bed, alone.time, **fields)
    return whole.at(cells=np.isfinite(alone.x))


def computed_snapshots(one: OneRun) -> OneRun:
    """Only the snapshots that the run reached."""
    return one.at(np.isfinite(one.h).any(axis=1))


def wet_range(one: OneRun) -> slice:
    """The cells between the first and the last that is ever thicker than h_front [m], and a margin of 4 %."""
    cells = np.flatnonzero(derived.thick(one).any(axis=0))
    if cells.size == 0:
        return slice(0, one.x.size)
    margin = max(2, round(0.04 * (cells[-1] - cells[0])))
    return slice(max(0, int(cells[0]) - margin), int(cells[-1]) + margin + 1)
