"""Result files that are malformed, locked or of another kind: refused in a line that says why."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from helpers.cases import small
from typer.testing import CliRunner

import warpgran as wg
from warpgran.case.study import Study
from warpgran.cli.app import app
from warpgran.files import StorageError
from warpgran.results.merging import merge
from warpgran.results.part_file import part_of
from warpgran.run.options import Options
from warpgran.run.to_file import run_to_file

QUICK = {"grid.cells": 40, "time.end": 0.02, "time.snapshots": [0.01, 0.02], "time.series": [0.0, 0.02]}


def study() -> Study:
    return small(**QUICK).sweep({"slope.angle": [0.0, 10.0]})


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("sound") / "sound.h5"
    run_to_file(study(), path, Options())
    return path


def without(name: str) -> Callable[[h5py.File], None]:
    return lambda file: file.__delitem__(name)


def replaced(name: str, values: Any) -> Callable[[h5py.File], None]:
    def change(file: h5py.File) -> None:
        del file[name]
        file[name] = values

    return change


def attribute(name: str, value: Any) -> Callable[[h5py.File], None]:
    return lambda file: file.attrs.__setitem__(name, value)


def stored_elsewhere(file: h5py.File) -> None:
    shape = file["run_out"].shape
    del file["run_out"]
    file.create_dataset("run_out", shape, "f8", external=[("/etc/passwd", 0, 16)])


def virtual(file: h5py.File) -> None:
    layout = h5py.VirtualLayout(file["run_out"].shape, "f8")
    layout[:] = h5py.VirtualSource("other.h5", "a", shape=file["run_out"].shape)
    del file["run_out"]
    file.create_virtual_dataset("run_out", layout)


def references(file: h5py.File) -> None:
    del file["run_out"]
    file.create_dataset("run_out", data=[file["h"].ref, file["v"].ref], dtype=h5py.ref_dtype)


def of_another_dimension(file: h5py.File) -> None:
    file["run_out"].dims[0].detach_scale(file["run"])
    file["run_out"].dims[0].attach_scale(file["time"])


def with_checkpoints(file: h5py.File) -> None:
    file["checks/rows"] = np.zeros(2, "u8")
    file["checks/run"], file["checks/run_sums"] = np.zeros((2, 9)), np.zeros((1, 2), "u8")


MALFORMED: dict[str, tuple[Callable[[h5py.File], None], str]] = {
    "no status": (without("status"), "status is missing"),
    "no field": (without("phi"), "phi is missing"),
    "a group for a field": (lambda file: (without("h")(file), file.create_group("h"))[0], "h is missing"),
    "external link": (replaced("h", h5py.ExternalLink("/etc/passwd", "h")), "h is a link to another place"),
    "soft link": (replaced("h", h5py.SoftLink("/phi")), "h is a link to another place"),
    "external storage": (stored_elsewhere, "run_out is stored in another place"),
    "virtual": (virtual, "run_out is stored in another place"),
    "checksums in another place": (
        lambda file: file.create_group("checks").__setitem__("rows", h5py.ExternalLink("/dev/zero", "h")),
        "rows is a link to another place",
    ),
    "checkpoints without their checksums": (
        with_checkpoints,
        "checks/run and checks/run_sums are not of as many checkpoints",
    ),
    "checksums of other runs": (
        lambda file: file.create_dataset("checks/rows", data=np.zeros(3, "u8")),
        "checks/rows has not a number a run",
    ),
    "references": (references, "run_out has the type object"),
    "one dimension": (replaced("h", np.zeros(2)), "h has not the dimensions run, time, x"),
    "another length": (replaced("run_out", np.zeros(3)), "run_out has another length than run"),
    "no scales": (replaced("run_out", np.zeros(2)), "run_out has not the dimensions run"),
    "another scale": (of_another_dimension, "run_out has not the dimensions run"),
    "text for numbers": (replaced("steps", np.array([b"a", b"b"])), "steps has the type"),
    "nothing for numbers": (replaced("steps", h5py.Empty("i8")), "steps has not the dimensions run"),
    "an unknown status": (lambda file: file["status"].write_direct(np.array([0, 77], "i1")), "an unknown code"),
    "times that go back": (lambda file: file["time"].write_direct(np.array([0.2, 0.1])), "time does not increase"),
    "a huge array": (
        lambda file: (without("run_out")(file), file.create_dataset("run_out", (2**40,), "f8", chunks=(2**10,)))[0],
        "run_out is larger than the file can hold",
    ),
    "schema as text": (attribute("schema_version", "2"), "it is not a warpgran result"),
    "schema as array": (attribute("schema_version", [2, 2]), "it is not a warpgran result"),
    "an older schema": (attribute("schema_version", 1), "its schema is version 1"),
    "a newer schema": (attribute("schema_version", 99), "its schema is version 99"),
    "a case that is no TOML": (attribute("case_toml", "= ="), "malformed"),
    "no case": (lambda file: file.attrs.__delitem__("case_toml"), "the attribute case_toml is not text"),
    "a text for a time": (attribute("wall_seconds", "long"), "the attribute wall_seconds is not a number"),
}


@pytest.mark.parametrize("name", MALFORMED)
def test_malformed_files_are_refused_in_a_line(tmp_path: Path, sound: Path, name: str) -> None:
    change, words = MALFORMED[name]
    path = Path(shutil.copy(sound, tmp_path / "bad.h5"))
    with h5py.File(path, "r+") as file:
        change(file)
    with pytest.raises(StorageError, match=f"cannot read .*bad.h5: .*{words}"):
        wg.open_dataset(path)
    with pytest.raises(StorageError, match=words):
        merge([path], tmp_path / "out.h5")
    with pytest.raises(StorageError, match=r"cannot go on with .*bad\.h5: it is damaged, or no warpgran result"):
        run_to_file(study(), path, Options(), resume=True)
    for command in ("plot", "animate", "summary"):
        result = CliRunner().invoke(app, [command, str(path)])
        assert result.exit_code == 2
        assert len(result.stderr.splitlines()) == 1
        assert words in result.stderr


@pytest.mark.parametrize("keep", [100, 0.5, 0.99])
def test_truncated_files_are_refused_in_a_line(tmp_path: Path, sound: Path, keep: float) -> None:
    data = sound.read_bytes()
    (tmp_path / "bad.h5").write_bytes(data[: int(keep if keep > 1 else keep * len(data))])
    with pytest.raises(StorageError, match=r"cannot read .*bad\.h5: it is (truncated|not an HDF5 file)"):
        wg.open_dataset(tmp_path / "bad.h5")


def test_numbers_that_cannot_be_read_are_told_with_the_name_of_the_file(tmp_path: Path, sound: Path) -> None:
    path = Path(shutil.copy(sound, tmp_path / "bad.h5"))
    with h5py.File(path) as file:
        chunk = file["h"].id.get_chunk_info(0)
    data = bytearray(path.read_bytes())
    data[chunk.byte_offset : chunk.byte_offset + chunk.size] = bytes(chunk.size)
    path.write_bytes(data)
    result = CliRunner().invoke(app, ["animate", str(path)])
    assert result.exit_code == 2
    assert f"cannot read {path}: it is damaged" in result.stderr
    with pytest.raises(StorageError, match=r"cannot read .*bad\.h5: it is damaged"):
        merge([path], tmp_path / "out.h5")


def test_whatever_hdf5_raises_is_a_line(tmp_path: Path, sound: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a spoiled structure HDF5 raises RuntimeError as well as OSError, in several lines."""

    def spoiled(*arguments: Any, **options: Any) -> None:
        raise RuntimeError("Unspecified error in H5Oopen\n(return value <0)")

    monkeypatch.setattr("h5py.Dataset.__getitem__", spoiled)
    for command in ("summary", "plot", "view"):
        result = CliRunner().invoke(app, [command, str(sound)])
        assert result.exit_code == 2
        assert len(result.stderr.splitlines()) == 1 and "Unspecified error in H5Oopen (return value" in result.stderr
    monkeypatch.setattr("h5py.File.__init__", spoiled)
    with pytest.raises(StorageError, match=r"cannot read .*sound\.h5: it is not an HDF5 file \(Unspecified error"):
        wg.open_dataset(sound)


def test_attributes_that_hdf5_cannot_read_are_a_line(tmp_path: Path, sound: Path) -> None:
    data = bytearray(sound.read_bytes())
    at = data.index(b"flag_meanings") + 16  # of the type of this attribute
    data[at : at + 8] = b"\xff" * 8
    path = tmp_path / "bad.h5"
    path.write_bytes(data)
    with h5py.File(path) as file, pytest.raises(RuntimeError):
        dict(file["status"].attrs)
    with pytest.raises(StorageError, match=r"cannot read .*bad\.h5: it is malformed \(.*version number"):
        wg.open_dataset(path)
    with pytest.raises(StorageError, match=r"cannot go on with .*bad\.h5: it is damaged"):
        run_to_file(study(), path, Options(), resume=True)
    for command in ("summary", "plot", "animate"):
        result = CliRunner().invoke(app, [command, str(path)])
        assert result.exit_code == 2 and len(result.stderr.splitlines()) == 1
    data = bytearray(sound.read_bytes())
    at = data.index(b"long_name", data.index(b"dilation_max")) + 16  # of one that only xarray and a merge read
    data[at : at + 8] = b"\xff" * 8
    path.write_bytes(data)
    with pytest.raises(StorageError, match=r"cannot read .*bad\.h5: it is (malformed|damaged)"):
        wg.open_dataset(path)
    with pytest.raises(StorageError, match=r"cannot read .*bad\.h5: it is (malformed|damaged)"):
        merge([path], tmp_path / "out.h5")


HOLD = "import h5py, sys; f = h5py.File(sys.argv[1], 'r+'); print('held', flush=True); sys.stdin.read()"


def test_a_file_that_another_process_holds_is_called_locked(tmp_path: Path, sound: Path) -> None:
    path = shutil.copy(sound, tmp_path / "held.h5")
    with subprocess.Popen([sys.executable, "-c", HOLD, path], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        assert process.stdout is not None and process.stdout.readline() == b"held\n"
        with pytest.raises(StorageError, match=r"cannot read .*held\.h5: it is locked"):
            wg.open_dataset(path)
        process.communicate()
    assert wg.open_dataset(path).sizes["run"] == 2


def test_a_part_file_is_a_sound_result(tmp_path: Path) -> None:
    def killed(sink: Any, options: Options, runs: Any, progress: Any) -> Any:
        from warpgran.run import threads

        threads.compute(sink, options, runs[:1], progress)
        raise RuntimeError

    with pytest.raises(RuntimeError):
        run_to_file(study(), tmp_path / "out.h5", Options(), compute=killed)
    data = wg.open_dataset(part_of(tmp_path / "out.h5"))
    assert np.isfinite(data["h"][0]).all() and np.isnan(data["h"][1]).all()


def test_a_heap_that_hdf5_would_walk_forever_is_damage(sound: Path, tmp_path: Path) -> None:
    data = bytearray(sound.read_bytes())
    heap = data.index(b"GCOL")
    end = heap + int.from_bytes(data[heap + 8 : heap + 16], "little")
    data[end - 200 : end] = bytes(200)
    (tmp_path / "spoiled.h5").write_bytes(data)
    read = [sys.executable, "-c", "from warpgran.cli.app import app; app(['summary', 'spoiled.h5'])"]
    done = subprocess.run(read, cwd=tmp_path, capture_output=True, text=True, check=False, timeout=30)
    assert done.returncode == 2 and done.stderr == "warpgran: cannot read spoiled.h5: it is damaged\n"
