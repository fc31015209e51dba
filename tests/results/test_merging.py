"""Shards of a study joined: as the whole study would be, with what all of them took."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py
import pytest
from helpers.cases import small

import warpgran as wg
from warpgran.case.study import Study
from warpgran.files import StorageError
from warpgran.results.layout import Layout
from warpgran.results.merging import merge
from warpgran.results.part_file import PartFile
from warpgran.run import threads
from warpgran.run.options import Options
from warpgran.run.outcome import Outcome, attributes
from warpgran.run.to_file import run_to_file


def study() -> Study:
    over = {"slope.angle": [0.0, 10.0, 22.0], "rheology.phi_eq": ["f0", "f1", "f2"]}
    return small(**{"time.series": {"every": 0.05}}).sweep(over, mode="zip")


@pytest.fixture
def shards(tmp_path: Path) -> list[Path]:
    paths = [tmp_path / "a.h5", tmp_path / "b.h5"]
    for path, runs in zip(paths, ([0, 2], [1]), strict=True):
        run_to_file(study(), path, Options(), runs=runs)
    return paths


def test_what_shards_took_is_added_and_the_history_says_so(shards: list[Path], tmp_path: Path) -> None:
    assert merge(shards, tmp_path / "all.h5") == (3, [])
    parts, whole = [wg.open_dataset(path) for path in shards], wg.open_dataset(tmp_path / "all.h5")
    for name in ("cell_steps", "kernel_seconds", "wall_seconds"):
        assert whole.attrs[name] == pytest.approx(sum(part.attrs[name] for part in parts))
    before, merged = whole.attrs["history"].split("\n")
    assert before == parts[0].attrs["history"]
    assert merged.endswith("merged from 2 files by warpgran merge")
    assert whole["run"].values.tolist() == [0, 1, 2]
    assert whole["rheology.phi_eq"].values.tolist() == ["f0", "f1", "f2"]


def test_a_run_that_was_not_computed_is_no_loss(tmp_path: Path) -> None:
    """A file of the study in which some runs are only begun is replaced by one that has all the others."""

    def interrupted(sink: Any, options: Options, runs: Any, progress: Any) -> Outcome:
        outcome = threads.compute(sink, options, runs[:2], progress)
        outcome.interrupted = True
        return outcome

    out, shard = tmp_path / "all.h5", tmp_path / "a.h5"
    run_to_file(study(), out, Options(), compute=interrupted)
    run_to_file(study(), shard, Options(), runs=[0, 1])
    assert merge([shard], out) == (2, [2])


def test_a_merged_file_is_described_as_that_of_the_whole_study(shards: list[Path], tmp_path: Path) -> None:
    merge(shards, tmp_path / "all.h5")
    run_to_file(study(), tmp_path / "whole.h5", Options())
    with h5py.File(tmp_path / "all.h5") as merged, h5py.File(tmp_path / "whole.h5") as whole:
        assert merged.keys() == whole.keys()
        for name, data in whole.items():
            assert merged[name].is_scale == data.is_scale
            assert merged[name].dtype == data.dtype
            assert [scales.keys() for scales in merged[name].dims] == [scales.keys() for scales in data.dims]
            described = ("units", "long_name", "standard_name", "coordinates", "flag_meanings")
            assert [merged[name].attrs.get(word) for word in described] == [data.attrs.get(word) for word in described]


def test_the_file_of_a_running_study_is_not_merged(tmp_path: Path) -> None:
    layout = Layout(study())
    path = tmp_path / "out.h5.part"
    PartFile(path, layout, layout.attributes(**attributes(Options(), Outcome()))).close()
    with pytest.raises(StorageError, match="still being computed"):
        merge([path], tmp_path / "all.h5")
    assert not (tmp_path / "all.h5").exists()


def test_a_file_of_schema_1_is_refused_in_one_line(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "old.h5", "w") as file:
        file.attrs["schema_version"] = 1
    for read in (wg.open_dataset, lambda path: merge([path], tmp_path / "all.h5")):
        with pytest.raises(StorageError, match=r"^cannot read .*old\.h5: its schema is version 1, .*compute it again$"):
            read(tmp_path / "old.h5")
