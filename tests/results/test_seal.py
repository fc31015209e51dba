"""The seal of a part file: whatever is spoiled outside of the runs is found before HDF5 reads it."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest
from helpers.cases import small

import warpgran as wg
from warpgran.case.study import Study
from warpgran.files import StorageError
from warpgran.results.layout import Layout
from warpgran.results.part_file import PartFile
from warpgran.results.seal import check_seal, seal
from warpgran.run.options import Options
from warpgran.run.outcome import Outcome, attributes


def two_runs() -> Layout:
    return Layout(Study.of([small(), small(**{"slope.angle": 10.0})]))


@pytest.fixture
def part(tmp_path: Path) -> Path:
    """A part file of two runs."""
    layout = two_runs()
    path = tmp_path / "out.h5.part"
    PartFile(path, layout, layout.attributes(**attributes(Options(), Outcome()))).close()
    return path


def of_runs(path: Path) -> np.ndarray:
    """Which bytes of a part file are those of runs."""
    found = np.zeros(path.stat().st_size, dtype=bool)
    with h5py.File(path) as file:
        for name in [*two_runs().columns, "checks/rows", "checks/spent"]:
            begin = file[name].id.get_offset() or 0  # None where it is empty
            found[begin : begin + file[name].nbytes] = True
    return found


def test_a_part_file_with_its_seal_is_read_by_all_that_read_hdf5(part: Path) -> None:
    check_seal(part)
    assert wg.open_dataset(part).sizes["run"] == 2


def test_any_bit_outside_of_the_runs_is_found(part: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    data, free, rng = part.read_bytes(), np.flatnonzero(~of_runs(part)), np.random.default_rng(1)
    monkeypatch.setattr(h5py, "File", None)  # HDF5 is not asked
    for at in [*rng.choice(free, 200), *range(len(data) - 40, len(data))]:
        spoiled = bytearray(data)
        spoiled[at] ^= 1 << int(rng.integers(8))
        part.write_bytes(spoiled)
        with pytest.raises(StorageError, match=r"cannot read .*out\.h5\.part: it is damaged"):
            wg.open_dataset(part)


@pytest.mark.parametrize("left", [0, 1, 40, 5000, -1, -8, -16])
def test_a_part_file_that_was_cut_is_refused(part: Path, left: int) -> None:
    part.write_bytes(part.read_bytes()[:left])
    with pytest.raises(StorageError, match="it is damaged"):
        check_seal(part)


def test_what_runs_write_may_change(part: Path) -> None:
    data = np.frombuffer(part.read_bytes(), dtype=np.uint8).copy()
    data[of_runs(part)] ^= 255
    part.write_bytes(data.tobytes())
    check_seal(part)


def test_other_files_need_no_seal(tmp_path: Path) -> None:
    path = tmp_path / "out.h5"
    path.write_bytes(b"whatever is here")
    check_seal(path)
    seal(path, [(4, 8)])
    check_seal(path)
    path.write_bytes(path.read_bytes().replace(b"what", b"that"))
    with pytest.raises(StorageError, match="it is damaged"):
        check_seal(path)
