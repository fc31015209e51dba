"""The output schedule that all runs of a batch share."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from warpgran.arrays import Array
from warpgran.case.case import Case


@dataclass(frozen=True, eq=False)
class Outputs:
    """Output times, each a snapshot, a sample of the series, both, or (the end) perhaps neither.

    Attributes:
        times: s, increasing, shape (outputs,).
        snapshot_at: place of each time among the snapshots, -1 if it is none.
        sample_at: place of each time among the samples, -1 if it is none. The end is one even if no series has it.
        series: number of the samples that belong to the series, the first ones.
    """

    times: Array
    snapshot_at: Array
    sample_at: Array
    series: int = 0

    @staticmethod
    def of(case: Case) -> Outputs:
        """The schedule of a case."""
        times, of_series = np.array(case.output_times), case.sample_times
        sampled = tuple(dict.fromkeys((*of_series, case.time.end)))
        return Outputs(times, _places(times, case.snapshot_times), _places(times, sampled), len(of_series))

    @staticmethod
    def none() -> Outputs:
        """No output at all."""
        nothing = np.zeros(0, dtype=np.int32)
        return Outputs(np.zeros(0), nothing, nothing)

    @staticmethod
    def never() -> Outputs:
        """An output that is never reached, for runs that pause where they are to stop."""
        none = np.full(1, -1, dtype=np.int32)
        return Outputs(np.full(1, np.inf), none, none)

    @property
    def snapshots(self) -> int:
        """Number of snapshots."""
        return int(self.snapshot_at.max(initial=-1)) + 1

    @property
    def samples(self) -> int:
        """Number of samples."""
        return int(self.sample_at.max(initial=-1)) + 1


def _places(times: Array, chosen: tuple[float, ...]) -> Array:
    places = {t: n for n, t in enumerate(chosen)}
    return np.array([places.get(t, -1) for t in times.tolist()], dtype=np.int32)
