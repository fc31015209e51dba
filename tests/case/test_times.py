"""Snapshots, samples and every time at which a run stops."""

import pytest

from warpgran.case.sections import Every, Time
from warpgran.case.times import output_times, sample_times, snapshot_times


@pytest.mark.parametrize(
    ("every", "end", "times"),
    [
        (0.1, 0.3, (0.0, 0.1, 0.2, 0.3)),
        (0.1, 0.35, (0.0, 0.1, 0.2, 0.3)),
        (1 / 3, 1.0, (0.0, 0.333333333333, 0.666666666667, 1.0)),
        (1e-13, 3e-13, (0.0, 1e-13, 2e-13, 3e-13)),
        (0.3, 0.3, (0.0, 0.3)),
        (0.7, 0.7 * 3, (0.0, 0.7, 1.4, 0.7 * 3)),
    ],
)
def test_equally_spaced_times(every: float, end: float, times: tuple[float, ...]) -> None:
    assert sample_times(Time(end=end, series=Every(every=every))) == times


def test_defaults_follow_the_end() -> None:
    time = Time(end=5.0)
    assert snapshot_times(time) == (0.0, 1.0, 2.0, 3.0, 4.0, 5.0)
    assert sample_times(time) == tuple(k / 40 for k in range(201))
    assert (snapshot_times(Time(snapshots=())), sample_times(Time(series=()))) == ((), ())


def test_output_times_are_the_union_and_the_end() -> None:
    time = Time(end=1.0, snapshots=(0.25, 0.5), series=Every(every=0.5))
    assert snapshot_times(time) == (0.25, 0.5)
    assert sample_times(time) == (0.0, 0.5, 1.0)
    assert output_times(time) == (0.0, 0.25, 0.5, 1.0)
    time = Time(end=1.0, snapshots=(), series=())
    assert (snapshot_times(time), sample_times(time), output_times(time)) == ((), (), (1.0,))
    time = Time(end=1.0, snapshots=Every(every=0.4), series=())
    assert (snapshot_times(time), output_times(time)) == ((0.0, 0.4, 0.8), (0.0, 0.4, 0.8, 1.0))


def test_times_that_nearly_agree_are_one_with_the_snapshots_value() -> None:
    near = 0.5 + 1e-10
    time = Time(end=1.0, snapshots=(near,), series=(0.25, 0.5, 0.5 + 1e-8))
    assert sample_times(time) == (0.25, near, 0.5 + 1e-8)
    assert output_times(time) == (0.25, near, 0.5 + 1e-8, 1.0)


def test_times_that_nearly_are_the_start_or_the_end_are_it() -> None:
    time = Time(end=1.0, snapshots=(1e-12, 1 - 1e-12), series=Every(every=1.0))
    assert snapshot_times(time) == sample_times(time) == output_times(time) == (0.0, 1.0)
