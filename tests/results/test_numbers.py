"""Numbers that no flow has, where a result is read: a line that says where they are and what, no overflow after it."""

from __future__ import annotations

import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest
from helpers.cases import small
from typer.testing import CliRunner

import warpgran as wg
from warpgran.cli.app import app
from warpgran.results.columns import opened_columns
from warpgran.results.numbers import MOST, absurd
from warpgran.run.options import Options
from warpgran.run.to_file import run_to_file

QUICK = {"grid.cells": 40, "time.end": 0.02, "time.snapshots": [0.01, 0.02], "time.series": [0.0, 0.01, 0.02]}
COMMANDS = {
    "h": ["plot --run 1", "animate --run 1", "view", "compare"],
    "v": ["plot --run 1", "view"],
    "phi": ["plot --run 1", "animate --run 1"],
    "bed": ["animate", "view"],
    "front": ["plot", "summary"],
    "run_out": ["plot", "summary", "compare"],
    "column.height": ["plot", "summary"],
}
"""That read a variable."""


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("sound") / "sound.h5"
    run_to_file(small(**QUICK).sweep({"column.height": [0.1, 0.12]}), path, Options())
    return path


def spoiled(sound: Path, path: Path, name: str, value: float) -> Path:
    """A copy whose last number of a variable is another."""
    shutil.copy(sound, path)
    with h5py.File(path, "r+") as file:
        file[name][(-1,) * file[name].ndim] = value
    return path


@pytest.mark.parametrize("value", [1e308, -np.inf])
@pytest.mark.parametrize("name", COMMANDS)
def test_absurd_numbers_are_refused_in_a_line(tmp_path: Path, sound: Path, name: str, value: float) -> None:
    path = spoiled(sound, tmp_path / "bad.h5", name, value)
    where = "" if name == "bed" else " of run 1"
    words = f"cannot read {path}: it is malformed: {name}{where} holds {value:g}"
    with wg.open_dataset(path) as data, pytest.raises(wg.StorageError) as raised:
        data[name].load()
    assert str(raised.value) == words
    for command in COMMANDS[name]:
        name_of_command, *options = command.split()
        files = [str(path), *([str(sound)] if name_of_command == "compare" else [])]
        result = CliRunner().invoke(app, [name_of_command, *files, *options])
        assert (result.exit_code, result.stderr) == (2, f"warpgran: {words}\n"), result.output


def test_a_study_whose_file_has_such_numbers_is_not_reported(tmp_path: Path) -> None:
    (tmp_path / "case.toml").write_text(
        'grid.cells = 40\ntime = { end = 0.02, snapshots = [] }\nsweep.over = { "slope.angle" = [5, 10] }\n'
    )
    run = ["run", str(tmp_path / "case.toml"), "-o", str(tmp_path / "out.h5"), "--no-picture"]
    assert CliRunner().invoke(app, run).exit_code == 0
    with h5py.File(tmp_path / "out.h5", "r+") as file:
        file["front"][0, -1] = 1e308
    again = CliRunner().invoke(app, [*run, "--resume"])
    said = [line for line in again.output.splitlines() if "warning: " not in line]
    assert said == [f"warpgran: cannot read {tmp_path / 'out.h5'}: it is malformed: front of run 0 holds 1e+308"]


def test_times_and_positions_are_judged_when_the_file_is_opened(tmp_path: Path, sound: Path) -> None:
    for name in ("x", "time", "series_time"):
        path = spoiled(sound, tmp_path / f"{name}.h5", name, 1e308)
        with pytest.raises(wg.StorageError, match=rf"it is malformed: {name} holds 1e\+308"):
            wg.open_dataset(path)


def test_of_a_slice_that_is_read_the_run_is_named(tmp_path: Path, sound: Path) -> None:
    path = spoiled(sound, tmp_path / "bad.h5", "h", 1e308)
    with opened_columns(path) as columns:
        assert np.isfinite(columns.fields["h"][0]).all()
        for rows in (1, slice(1, 2), [0, 1]):
            with pytest.raises(wg.StorageError, match="h of run 1 holds"):
                columns.fields["h"][rows]
    with wg.open_dataset(path) as data:
        assert np.isfinite(data["h"].isel(run=0).values).all()
        with pytest.raises(wg.StorageError, match="h of run 1 holds"):
            data["h"].isel(run=1).load()


def test_what_is_missing_is_not_absurd_and_an_energy_may_be_a_product() -> None:
    assert absurd("h", np.array([np.nan, MOST, -MOST])) == ""
    assert absurd("energy", np.array([[MOST**3]]), np.array([7])) == ""
    assert absurd("mass", np.array([[1.0], [MOST**3]]), np.array([7, 9])) == "mass of run 9 holds 1e+120"
    assert absurd("h", np.array(np.inf), np.array(4)) == "h of run 4 holds inf"


def test_numbers_are_read_once_and_the_file_is_closed(tmp_path: Path, sound: Path) -> None:
    path = Path(shutil.copy(sound, tmp_path / "a.h5"))
    with wg.open_dataset(path) as data:
        before = data["h"].values
    with h5py.File(path, "r+") as file:  # which HDF5 refuses as long as another has it open
        file["h"][...] = 0.0
    assert np.array_equal(data["h"].values, before)
