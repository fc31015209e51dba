"""A slice of one run is read without the rest of the file."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest

import warpgran as wg
from warpgran.case.case import Case
from warpgran.results.layout import Layout
from warpgran.results.part_file import PartFile
from warpgran.run.options import Options
from warpgran.run.outcome import Outcome, attributes
from warpgran.schema import FIELDS, Status

RUNS, SNAPSHOTS, CELLS = 4, 10, 20_000
WAITING = 2
SLICE = 8 * CELLS  # bytes
READ = Path("/proc/self/io")
"""Where Linux counts the bytes that a process has read."""
pytestmark = pytest.mark.skipif(not READ.exists(), reason="the bytes that are read are counted on Linux alone")


def bytes_read() -> int:
    return int(READ.read_text().split()[1])


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """A part file with a run that is not computed, and the finished file that comes of it."""
    folder = tmp_path_factory.mktemp("lazy")
    paths = {name: folder / name for name in ("out.h5.part", "out.h5")}
    base = Case().with_(**{"grid.cells": CELLS, "time.snapshots": np.linspace(0.0, 1.0, SNAPSHOTS).tolist()})
    layout = Layout(base.sweep({"slope.angle": [0.0, 10.0, 20.0, 30.0]}))
    random = np.random.default_rng(1)
    facts = attributes(Options(), Outcome())
    with PartFile(paths["out.h5.part"], layout, layout.attributes(**facts)) as part:
        for run in set(range(RUNS)) - {WAITING}:
            rows = {name: np.zeros((1, *column.shape), column.dtype) for name, column in layout.columns.items()}
            rows |= {name: random.random((1, SNAPSHOTS, CELLS)) for name in FIELDS}
            part.put([run], rows | {"status": np.array([Status.OK])})
        kept = paths["out.h5.part"].read_bytes()
        part.finish(paths["out.h5"], facts)
    paths["out.h5.part"].write_bytes(kept)
    return paths


@pytest.mark.parametrize(
    ("name", "most"), [("out.h5.part", 2 * SLICE), ("out.h5", 2**21)]
)  # a chunk of the latter is 2**20
def test_a_snapshot_of_one_run_is_read_alone(files: dict[str, Path], name: str, most: int) -> None:
    path = files[name]
    with wg.open_dataset(path) as data:  # imports what reading needs
        assert data["status"].values.tolist() == [0, 0, Status.PENDING, 0]
    assert path.stat().st_size > 5 * most
    before = bytes_read()
    with wg.open_dataset(path) as data:
        opened = bytes_read()
        last = data["h"].isel(run=3, time=-1).values
        assert bytes_read() - opened <= most
        assert opened - before <= 2**20
        assert last.shape == (CELLS,)
        assert 0.0 < last.min() < last.max() < 1.0


@pytest.mark.parametrize("name", ["out.h5.part", "out.h5"])
def test_runs_that_wait_are_nan_however_they_are_selected(files: dict[str, Path], name: str) -> None:
    with wg.open_dataset(files[name]) as data:
        h = data["h"]
        assert np.isnan(h.isel(run=WAITING, time=-1)).all()
        assert np.isnan(h.isel(run=WAITING, time=-1, x=5)).all()
        assert np.isnan(h.isel(run=[3, WAITING, 0], x=slice(3, 9)).values).any(axis=(1, 2)).tolist() == [0, 1, 0]
        assert np.isnan(h.isel(run=slice(WAITING, None), time=[0, 2]).values).any(axis=(1, 2)).tolist() == [1, 0]
        assert np.isnan(h.sel(x=0.3, method="nearest").isel(time=0).values).tolist() == [0, 0, 1, 0]
        assert np.isfinite(h.isel(run=[0, 1, 3])).all()
        assert np.isnan(data["run_out"].values).tolist() == [0, 0, 1, 0]
        assert np.isnan(data["front"][WAITING]).all()


@pytest.mark.parametrize("name", ["out.h5.part", "out.h5"])
def test_a_dataset_that_is_closed_lets_go_of_the_file(files: dict[str, Path], name: str) -> None:
    with wg.open_dataset(files[name]) as data:
        assert data.sizes["run"] == RUNS
    h5py.File(files[name], "r+").close()  # which is refused to who holds it for reading
