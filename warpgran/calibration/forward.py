"""The model as a function: parameters to what would have been measured, all experiments and points in one batch."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from warpgran.analysis.runs import status_words
from warpgran.arrays import Array
from warpgran.calibration.experiments import Experiments, Observed
from warpgran.case.case import Case
from warpgran.case.problems import CaseError
from warpgran.case.study import Study
from warpgran.results.reading import load_dataset
from warpgran.results.seal import seal, sealed
from warpgran.run.options import Options
from warpgran.run.simulate import simulate_quietly
from warpgran.run.to_file import bring_up_to_date
from warpgran.schema import CLEAN

if TYPE_CHECKING:
    import xarray as xr

Progress = Callable[[float, float], None]
"""Called with the number of runs done and their total."""
MOST_BYTES = 2**28
"""Of the profiles that are kept in memory at once."""


@dataclass
class Tally:
    """What the runs of a calibration took, and how they ended.

    Attributes:
        runs: Runs that were computed.
        refused: Points of which a case cannot be made, such as mu2 < mu1, times the experiments.
        ended: Runs that did not end cleanly, by how they ended.
        engine_seconds: Wall time of the engine.
    """

    runs: int = 0
    refused: int = 0
    ended: Counter[str] = field(default_factory=Counter)
    engine_seconds: float = 0.0

    def add(self, data: xr.Dataset, computed: bool = True) -> None:
        """Count the runs of a result, and what they took unless they were there already."""
        self.ended.update(word for word in status_words(data).tolist() if word not in CLEAN)
        if computed:
            self.runs += data.sizes["run"]
            self.engine_seconds += float(data.attrs["wall_seconds"])

    def join(self, other: Tally) -> None:
        """Count what another has counted."""
        self.runs += other.runs
        self.refused += other.refused
        self.ended += other.ended
        self.engine_seconds += other.engine_seconds


class Forward:
    """The model as a function of the parameters.

    Attributes:
        experiments: What is predicted.
        names: The parameters, dotted keys.
        options: How runs are computed.
        tally: What was computed so far.
    """

    def __init__(self, experiments: Experiments, names: Sequence[str], options: Options) -> None:
        self.experiments, self.names, self.options = experiments, tuple(names), options
        self.tally = Tally()
        base = experiments.base
        self._bytes = 24 * base.grid.cells * max(1, len(base.snapshot_times))

    def study(self, theta: Array) -> tuple[Study | None, Array]:
        """The runs of points theta (points, parameters), an experiment after the other for each point.

        Returns:
            The runs, None where no case can be made, and the points that have them: (points,) of bool.
        """
        columns: dict[str, list[object]] = {}
        first: Case | None = None
        valid = np.zeros(len(theta), dtype=bool)
        base = self.experiments.base
        differ = dict.fromkeys(key for experiment in self.experiments.each for key in experiment.changes)
        shared = {key: base.flat()[key] for key in differ}
        for i, point in enumerate(theta.tolist()):
            values = dict(zip(self.names, point, strict=True))
            rows = [{**shared, **experiment.changes, **values} for experiment in self.experiments.each]
            try:
                cases = [base.with_(**row, title=base.title) for row in rows]
            except CaseError:
                self.tally.refused += len(rows)
                continue
            valid[i] = True
            first = first or cases[0]
            for row in rows:
                for key, value in row.items():
                    columns.setdefault(key, []).append(value)
        return (Study(first, columns) if first else None), valid

    def __call__(self, theta: Array, progress: Progress = lambda done, of: None) -> Array:
        """Predictions (points, data) of points theta (points, parameters); NaN for a point with a run that failed."""
        each = len(self.experiments.each)
        most = max(1, int(MOST_BYTES / (self._bytes * each)))
        found = []
        for begin in range(0, len(theta), most):
            study, valid = self.study(theta[begin : begin + most])
            if study is None:
                found.append(np.full((valid.size, self.experiments.size), np.nan))
                continue
            options = self.options
            data = simulate_quietly(
                study,
                device=options.device,
                precision=options.precision,
                engine=options.engine,
                threads=options.threads,
            )
            found.append(self.predictions(data, valid))
            self.tally.add(data)
            progress(float(begin + valid.size) * each, float(len(theta)) * each)
        return np.concatenate(found)

    def kept(self, theta: Array, path: Path, progress: Progress = lambda done, of: None) -> tuple[Array, xr.Dataset]:
        """The same with the runs in a result file, which is gone on with if it is there, and sealed when it is whole.

        Returns:
            The predictions and the result.

        Raises:
            CaseError: No point can be run.
            StorageError: What is there is damaged.
            KeyboardInterrupt: Ctrl-C; what was computed is kept.
        """
        study, valid = self.study(theta)
        if study is None:
            self.experiments.base.with_(**dict(zip(self.names, theta[0].tolist(), strict=True)))
            raise AssertionError("a study without runs has a case that cannot be made")
        before = path.stat().st_mtime_ns if path.exists() else 0
        if not bring_up_to_date(study, path, self.options, progress=lambda done: progress(done, float(len(study)))):
            raise KeyboardInterrupt
        data = load_dataset(path)
        if not sealed(path):
            seal(path, ())
        self.tally.add(data, path.stat().st_mtime_ns != before)
        found = self.predictions(data, valid)
        return found, data

    def predictions(self, data: xr.Dataset, valid: Array) -> Array:
        """What would have been measured in the runs of a study, (points, data); NaN where a run failed."""
        each = len(self.experiments.each)
        clean = np.isin(status_words(data), CLEAN).reshape(-1, each)
        found = np.full((clean.shape[0], self.experiments.size), np.nan)
        for number, observed, where in self.experiments.slices():
            found[:, where] = _measured(data.isel(run=slice(number, None, each)), observed)
        found[~clean.all(axis=1) | ~np.isfinite(found).all(axis=1)] = np.nan
        whole = np.full((valid.size, self.experiments.size), np.nan)
        whole[valid] = found
        return whole


def _measured(data: xr.Dataset, observed: Observed) -> Array:
    """What would have been measured in runs of one experiment, shape (runs, data)."""
    if observed.kind != "profiles":
        name = {"front": "front", "volume": "volume_change"}[observed.kind]
        return np.asarray(data[name].values[:, _nearest(data["series_time"].values, observed.t)])
    x = data["x"].values
    left = np.clip(np.searchsorted(x, observed.x, side="right") - 1, 0, x.size - 2)
    share = np.clip((observed.x - x[left]) / (x[left + 1] - x[left]), 0.0, 1.0)  # in the outer half of an end cell
    at = _nearest(data["time"].values, observed.t)
    h = data["h"].values
    return np.asarray((1.0 - share) * h[:, at, left] + share * h[:, at, left + 1])


def _nearest(times: Array, t: Array) -> Array:
    """Places of the nearest of some increasing times."""
    if times.size == 1:
        return np.zeros(t.size, dtype=int)
    right = np.clip(np.searchsorted(times, t), 1, times.size - 1)
    return np.where(t - times[right - 1] < times[right] - t, right - 1, right)
