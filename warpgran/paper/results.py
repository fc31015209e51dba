"""The results of the run files under one setting, computed when they are first asked for."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import xarray as xr

from warpgran.analysis.selection import one_run
from warpgran.case.read_study import read_study
from warpgran.case.study import Study
from warpgran.paper.settings import Setting
from warpgran.results.reading import load_dataset
from warpgran.run.options import Options
from warpgran.run.to_file import bring_up_to_date
from warpgran.schema import Status, is_key

LOOSE, DENSE = 0.55, 0.62  # initial volume fractions
K_PAPER = 4.09


class NotComputedError(ValueError):
    """A run, or an instant of it, that the results do not hold; the message says why."""


class Results(Protocol):
    """What figures and claims ask for."""

    def run(self, name: str, **where: float | str) -> xr.Dataset:
        """One run of a run file, by the last part of its swept keys: `run("collapses", angle=22, phi=0.62, K=0)`."""


class StoredResults:
    """Results kept in a folder, a file for each run file.

    Attributes:
        setting: How they are computed.
        ended_early: A line for each run that did not end cleanly and was returned all the same.
    """

    def __init__(
        self,
        setting: Setting,
        runs: Path,
        folder: Path,
        options: Options,
        overrides: Sequence[str] = (),
        progress: Callable[[str, int, float], None] = lambda name, runs, done: None,
        whole: bool = True,
    ) -> None:
        """Nothing is computed yet.

        Args:
            setting: How they are computed.
            runs: Folder of the run files.
            folder: Where the results are kept; made when the first is there.
            options: Device, precision and so on.
            overrides: `KEY=VALUE` for every run file.
            progress: Called with the name of a run file, its number of runs and how many are done.
            whole: Whether a run that did not end cleanly is refused; else it is NaN from there on.
        """
        self.setting = setting
        self.ended_early: list[str] = []
        self._whole = whole
        self._runs, self._folder, self._options = runs, folder, options
        self._overrides, self._progress = overrides, progress
        self._data = cache(self._compute)

    def _compute(self, name: str) -> xr.Dataset:
        study = study_of(self._runs / f"{name}.toml", self.setting, self._overrides)
        self._folder.mkdir(parents=True, exist_ok=True)
        path = self._folder / f"{name}.h5"

        def report(done: float) -> None:
            self._progress(name, len(study), done)

        if not bring_up_to_date(study, path, self._options, progress=report):
            raise KeyboardInterrupt
        self._progress(name, len(study), len(study))
        return load_dataset(path)

    def run(self, name: str, **where: float | str) -> xr.Dataset:
        """One run of a run file.

        Raises:
            NotComputedError: There is none such, or it did not end cleanly.
            KeyboardInterrupt: Ctrl-C while it was computed.
        """
        one = one_of(self._data(name), name, where)
        status = Status(int(one["status"]))
        if not status.clean:
            ended = f"the run with {_words(where)} {status.word} at t = {float(one['end_time']):.3g} s"
            if self._whole:
                raise NotComputedError(ended)
            self.ended_early += [ended] if ended not in self.ended_early else []
        return one


def study_of(path: Path, setting: Setting, overrides: Sequence[str] = ()) -> Study:
    """A run file under a setting.

    Raises:
        CaseError: With all that is wrong with the run file or the overrides.
    """
    study = read_study(path, overrides)
    return Study.of([setting.apply(case) for case in study])


def one_of(data: xr.Dataset, name: str, where: Mapping[str, float | str]) -> xr.Dataset:
    """The one run with these values of the keys in which the runs differ, named by their last part.

    Raises:
        NotComputedError: There is none such.
    """
    chosen = np.ones(data.sizes["run"], dtype=bool)
    for key, value in where.items():
        (column,) = [data[c].values for c in data.coords if is_key(str(c)) and str(c).rpartition(".")[2] == key]
        chosen &= column == value
    if chosen.sum() != 1:
        raise NotComputedError(f"{name} holds {chosen.sum()} runs with {_words(where)}")
    return one_run(data, int(np.flatnonzero(chosen)[0]))


def _words(where: Mapping[str, float | str]) -> str:
    return ", ".join(f"{key} = {value}" for key, value in where.items())


def at(one: xr.Dataset, t: float) -> xr.Dataset:
    """A run at one of its snapshots.

    Raises:
        NotComputedError: It has no snapshot then.
    """
    times = one["time"].values
    n = int(np.argmin(abs(times - t))) if times.size else 0
    if not times.size or abs(times[n] - t) > 1e-6:
        raise NotComputedError(f"there is no snapshot at {t:g} s")
    return one.isel(time=n)


PACKINGS: dict[str, dict[str, Any]] = {
    "dense": {"phi": DENSE, "K": K_PAPER},
    "loose": {"phi": LOOSE, "K": K_PAPER},
    "incompressible": {"phi": DENSE, "K": 0.0},
}
THREE = tuple(PACKINGS)
TWO = ("dense", "loose")
"""The packings, and those that dilatancy acts on."""
ANGLES = (0.0, 10.0, 16.0, 22.0)


def collapse(
    results: Results, angle: float, packing: str, K: float | None = None, source: str = "collapses"
) -> xr.Dataset:
    """One of the paper's three packings on a slope.

    Args:
        results: Where it is taken from.
        angle: Slope, degrees.
        packing: "dense", "loose" or "incompressible".
        K: Another dilation coefficient than the packing's.
        source: The run file.
    """
    where = PACKINGS[packing] if K is None else PACKINGS[packing] | {"K": K}
    return results.run(source, angle=angle, **where)
