"""The results of a batch in memory, and as a labelled dataset."""

from __future__ import annotations

import platform
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import numpy as np

from warpgran.case import Case
from warpgran.schema import COORDINATES, FIELDS, PER_RUN, SCHEMA_VERSION, SERIES, Status, Variable

if TYPE_CHECKING:
    import xarray as xr

Array = np.ndarray


class Results:
    """Results of a batch whose cases share their output times; what was not computed is NaN.

    Attributes:
        cases: one a run.
        fields: h [m], v [m/s], phi [-], each (runs, snapshots, cells).
        series: the variables of schema.SERIES, each (runs, samples).
        status, steps, end_time: per run.
        attributes: of the whole, as in the file.
    """

    def __init__(self, cases: Sequence[Case]) -> None:
        if len({(case.snapshot_times, case.sample_times) for case in cases}) != 1:
            raise ValueError("the cases of a batch must share time.snapshots, time.series and time.end")
        self.cases = tuple(cases)
        self.time = np.array(cases[0].snapshot_times)
        self.series_time = np.array(cases[0].sample_times)
        runs, cells = len(cases), max(case.grid.cells for case in cases)
        self.fields = {name: np.full((runs, self.time.size, cells), np.nan) for name in FIELDS}
        self.series = {name: np.full((runs, self.series_time.size), np.nan) for name in SERIES}
        self.status = np.full(runs, Status.OK, dtype=np.int8)
        self.steps = np.zeros(runs, dtype=np.int64)
        self.end_time = np.zeros(runs)
        self.attributes: dict[str, Any] = {}
        self._volume = np.array([_volume(case) for case in cases])

    def put_profiles(self, t: float, runs: Array, profiles: Sequence[Sequence[Array]]) -> None:
        """Store h, v, phi (one array a run) of the snapshot at t [s]; `runs` masks those to store."""
        at = int(np.flatnonzero(self.time == t)[0])
        for name, values in zip(FIELDS, profiles, strict=True):
            for r, value in enumerate(values):
                if runs[r]:
                    self.fields[name][r, at, : value.size] = value

    def put_scalars(self, t: float, runs: Array, scalars: Mapping[str, Array]) -> None:
        """Store the scalars, each (runs,), of the sample at t [s]; `runs` masks those to store."""
        at = int(np.flatnonzero(self.series_time == t)[0])
        for name in ("front", "h_max", "v_max", "v_flow", "mass", "energy"):
            self.series[name][runs, at] = scalars[name][runs]
        change = scalars["volume"][runs] / self._volume[runs] - 1.0
        self.series["volume_change"][runs, at] = change

    @property
    def stop_time(self) -> Array:
        """First sample [s] after which v_flow stays below time.rest_speed, NaN if it never does, per run."""
        return np.array([
            stop_time(self.series_time, v_flow, case.time.rest_speed)
            for v_flow, case in zip(self.series["v_flow"], self.cases, strict=True)
        ])  # fmt: skip

    def last_sample(self, r: int) -> dict[str, float]:
        """The last value of each series that run r has; NaN where it has none."""
        known = np.flatnonzero(np.isfinite(self.series["front"][r]))
        return {name: float(values[r, known[-1]]) if known.size else np.nan for name, values in self.series.items()}

    def status_word(self, r: int) -> str:
        """How run r ended."""
        return Status(self.status[r]).word

    @property
    def x(self) -> Array:
        """Cell centres [m]: (cells,), or (runs, cells) padded with NaN where the grids differ."""
        return _shared_or_stacked([case.x for case in self.cases])

    @property
    def bed(self) -> Array:
        """Bed elevation [m], shaped as x."""
        return _shared_or_stacked([case.bed for case in self.cases], shared=self.x.ndim == 1)

    @property
    def parameters(self) -> dict[str, list[Any]]:
        """Values by run of the keys in which the cases differ."""
        flats = [case.flat() for case in self.cases]
        keys = [key for key, value in flats[0].items() if _simple(value) and any(f[key] != value for f in flats)]
        return {key: [flat[key] for flat in flats] for key in keys}

    def finish(self, attributes: Mapping[str, Any]) -> None:
        """Complete what depends on whole series, and the attributes."""
        if self.series_time.size > 1:
            self.series["front_speed"][:] = np.gradient(self.series["front"], self.series_time, axis=1)
        cells = np.array([case.grid.cells for case in self.cases])
        self.attributes = {
            "title": self.cases[0].title,
            "schema_version": SCHEMA_VERSION,
            "run_file": self.cases[0].source,
            "case_toml": self.cases[0].to_toml(),
            "warpgran_version": version("warpgran"),
            "warp_version": version("warp-lang"),
            "numpy_version": version("numpy"),
            "python_version": platform.python_version(),
            "date": datetime.now(UTC).isoformat(timespec="seconds"),
            "cell_steps": int((self.steps * cells).sum()),
            **attributes,
        }

    def variables(self) -> dict[str, tuple[Variable, Array]]:
        """All variables by name, each with its schema."""
        values = {
            **self.fields,
            **self.series,
            "x": self.x,
            "bed": self.bed,
            "time": self.time,
            "series_time": self.series_time,
            "status": self.status,
            "steps": self.steps,
            "stop_time": self.stop_time,
            "end_time": self.end_time,
        }
        schemas = {**COORDINATES, **FIELDS, **SERIES, **PER_RUN}
        for name in ("x", "bed"):
            if values[name].ndim == 2:
                schemas[name] = schemas[name]._replace(dims=("run", "cell"))
        return {name: (schemas[name], value) for name, value in values.items()}

    def to_dataset(self) -> xr.Dataset:
        """The results as an xarray.Dataset; the keys in which runs differ are coordinates of `run`."""
        import xarray as xr

        variables = {
            name: xr.Variable(schema.dims, value, {"units": schema.units, "long_name": schema.long_name})
            for name, (schema, value) in self.variables().items()
        }
        variables["status"].attrs |= status_attributes()
        coordinates: dict[str, Any] = {name: variables.pop(name) for name in COORDINATES}
        coordinates |= {name: np.arange(n) for name, n in self.sizes.items()}
        coordinates |= {key: ("run", values) for key, values in self.parameters.items()}
        return xr.Dataset(variables, coordinates, self.attributes)

    @property
    def sizes(self) -> dict[str, int]:
        """Lengths of the dimensions that are counted, not measured."""
        runs, _, cells = self.fields["h"].shape
        return {"run": runs, "sample": self.series_time.size, "cell": cells}


def stop_time(t: Array, v_flow: Array, rest_speed: float) -> float:
    """First sample time [s] after which the speed stays below rest_speed [m/s]; NaN if it never does.

    The initial state is at rest without having stopped: what counts is after the mass has moved.
    """
    moving = np.flatnonzero(~(v_flow < rest_speed))
    if moving.size == 0 or moving[-1] == t.size - 1:
        return float("nan")
    return float(t[moving[-1] + 1])


def status_attributes() -> dict[str, Any]:
    """Meaning of the status codes, as CF has it."""
    return {
        "flag_values": np.array([int(s) for s in Status], dtype=np.int8),
        "flag_meanings": " ".join(s.word for s in Status),
    }


def _volume(case: Case) -> float:
    """Volume per unit width [m2] of the cells that start thicker than h_front; NaN if there are none."""
    h, _ = case.initial_state()
    return float(h[h > case.scheme.h_front].sum() * case.dx) or float("nan")


def _shared_or_stacked(values: Sequence[Array], shared: bool = True) -> Array:
    if shared and all(np.array_equal(values[0], other) for other in values[1:]):
        return values[0]
    stacked = np.full((len(values), max(v.size for v in values)), np.nan)
    for row, v in zip(stacked, values, strict=True):
        row[: v.size] = v
    return stacked


def _simple(value: Any) -> bool:
    return isinstance(value, bool | int | float | str)
