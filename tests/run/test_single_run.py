"""A run that is the only one of its file goes on from its last checkpoint: killed or interrupted, to the same bits."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import xarray as xr
from helpers.cases import DEVICES, FIRST, small

import warpgran as wg
from warpgran.case.study import Study
from warpgran.files import StorageError
from warpgran.results.kept_run import KEPT, SUMS, KeptRun
from warpgran.results.part_file import part_of
from warpgran.run.options import Options
from warpgran.run.to_file import run_to_file
from warpgran.schema import Status
from warpgran.solve.checkpoint import Checkpoint

SERIES = {"time.series": {"every": 0.01}}


class KilledError(Exception):
    """Stands for the signal that ends the process."""


def study(**changes: Any) -> Study:
    """A single run, of which some half is the start on finer cells."""
    return Study.of([small(**{**SERIES, **changes})])


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "out.h5"


@pytest.fixture(autouse=True)
def kept_often(monkeypatch: pytest.MonkeyPatch) -> None:
    """A checkpoint after every twenty steps."""
    monkeypatch.setattr("warpgran.solve.solver.MOST_STEPS", 20)
    monkeypatch.setattr("warpgran.solve.engines.KEEP_EVERY", 0.0)
    monkeypatch.setattr("warpgran.solve.engines.MOST_KEEPING", np.inf)


@contextmanager
def killed_after(checkpoints: int) -> Iterator[list[Checkpoint]]:
    """A block that ends with a KilledError once so many checkpoints are kept; and these."""
    kept: list[Checkpoint] = []
    keep = KeptRun.keep

    def counting(self: KeptRun, checkpoint: Checkpoint) -> None:
        keep(self, checkpoint)
        kept.append(checkpoint)
        if len(kept) == checkpoints:
            raise KilledError

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(KeptRun, "keep", counting)
        yield kept


def kill(study: Study, path: Path, checkpoints: int, **options: Any) -> list[Checkpoint]:
    """Compute a study until so many checkpoints are kept."""
    with killed_after(checkpoints) as kept, pytest.raises(KilledError):
        run_to_file(study, path, Options(**options), resume=True)
    return kept


def interrupt(study: Study, path: Path) -> Any:
    """Compute a study until Ctrl-C, pressed at once."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("warpgran.run.threads.POLL", 0.0)

        @contextmanager
        def pressed() -> Iterator[Any]:
            yield lambda: True

        patch.setattr("warpgran.run.threads.interruptible", pressed)
        return run_to_file(study, path, Options(), resume=True)


def assert_same(path: Path, other: Path) -> None:
    """Equal to the bit, steps and cell-steps included."""
    a, b = (wg.open_dataset(each).load() for each in (path, other))
    for name in a.data_vars:
        xr.testing.assert_identical(a[name].variable, b[name].variable)
    assert a.attrs["cell_steps"] == b.attrs["cell_steps"]


@pytest.mark.parametrize("device", DEVICES)
@pytest.mark.parametrize("precision", ["float64", "float32"])
@pytest.mark.parametrize("changes", [{}, FIRST, {"scheme.start": 0, "scheme.window": False}])
def test_killed_again_and_again_it_ends_with_the_same_bits(
    tmp_path: Path, changes: dict[str, Any], precision: str, device: str
) -> None:
    path, whole = tmp_path / "out.h5", tmp_path / "whole.h5"
    how: dict[str, Any] = {"precision": precision, "device": device}
    run_to_file(study(**changes), whole, Options(**how))
    reached = []
    for checkpoints in (1, 3):
        reached += [kept.numbers["t"] for kept in kill(study(**changes), path, checkpoints, **how)]
    assert reached == sorted(set(reached)), "each session goes on where the last has ended"
    outcome = run_to_file(study(**changes), path, Options(**how), resume=True)
    assert outcome.resumed_at == reached[-1] > 0.0
    assert_same(path, whole)
    with h5py.File(path) as file:
        assert "checks" not in file
    assert not part_of(path).exists()


def test_interrupted_it_goes_on_from_its_file(tmp_path: Path, path: Path) -> None:
    on_one_grid = {"scheme.start": 0, "grid.cells": 1600}
    run_to_file(study(**on_one_grid), tmp_path / "whole.h5", Options())
    reached: list[float] = []
    for _ in range(2):
        outcome = interrupt(study(**on_one_grid), path)
        assert outcome.interrupted
        assert outcome.kept_at > (outcome.resumed_at or 0.0)
        assert outcome.resumed_at == (reached[-1] if reached else None)
        reached.append(outcome.kept_at)
        assert not part_of(path).exists()
        data = wg.open_dataset(path)
        assert data["status"].item() == Status.INTERRUPTED
        assert data["end_time"].item() == reached[-1]
    assert run_to_file(study(**on_one_grid), path, Options(), resume=True).resumed_at == reached[-1]
    assert_same(path, tmp_path / "whole.h5")


def test_what_was_spent_is_that_of_all_sessions(path: Path) -> None:
    run = study()
    before = kill(run, path, 2)[-1]
    outcome = run_to_file(run, path, Options(), resume=True)
    spent = wg.open_dataset(path).attrs
    assert spent["cell_steps"] == before.cell_steps + outcome.cell_steps
    assert spent["kernel_seconds"] == before.numbers["seconds"] + outcome.kernel_seconds
    assert spent["wall_seconds"] >= spent["kernel_seconds"]


def test_what_was_spent_counts_a_run_that_was_done_when_it_was_killed(tmp_path: Path, path: Path) -> None:
    run_to_file(study(), tmp_path / "whole.h5", Options())
    with pytest.MonkeyPatch.context() as patch, pytest.raises(KilledError):

        def killed(*arguments: Any) -> None:
            raise KilledError

        patch.setattr("warpgran.results.part_file.PartFile.finish", killed)
        run_to_file(study(), path, Options())
    run_to_file(study(), path, Options(), resume=True)
    assert_same(path, tmp_path / "whole.h5")


def test_the_start_on_finer_cells_is_not_kept(path: Path) -> None:
    outcome = interrupt(study(**{"scheme.start": 3, "grid.cells": 400}), path)
    assert outcome.interrupted
    assert outcome.kept_at is None
    assert run_to_file(study(**{"scheme.start": 3, "grid.cells": 400}), path, Options()).resumed_at is None


def test_a_shard_of_one_run_is_kept_and_a_batch_is_not(tmp_path: Path) -> None:
    two = small(**SERIES).sweep({"slope.angle": [0.0, 10.0]})
    with killed_after(2) as kept, suppress(KilledError):
        run_to_file(two, tmp_path / "all.h5", Options())
    assert not kept
    with killed_after(2) as kept, pytest.raises(KilledError):
        run_to_file(two, tmp_path / "shard.h5", Options(), runs=[1])
    assert run_to_file(two, tmp_path / "shard.h5", Options(), runs=[1], resume=True).resumed_at is not None
    whole, shard = (wg.open_dataset(tmp_path / name) for name in ("all.h5", "shard.h5"))
    np.testing.assert_array_equal(shard["h"][0], whole["h"][1])


def test_the_reference_begins_anew(path: Path) -> None:
    few = study(**{"grid.cells": 40, "time.end": 0.01, "time.snapshots": []})
    with killed_after(1) as kept:
        run_to_file(few, path, Options(engine="numpy"))
    assert not kept


def test_it_is_not_begun_anew_unasked(path: Path) -> None:
    run = study()
    t = kill(run, path, 2)[-1].numbers["t"]
    words = rf"out\.h5\.part holds the run of an earlier start until t = {t:.4g} s: --resume .*, --force begins anew"
    with pytest.raises(StorageError, match=words):
        run_to_file(run, path, Options())
    with pytest.raises(StorageError, match=r"out\.h5\.part is of another study"):
        run_to_file(study(**{"rheology.mu1": 0.4}), path, Options())
    assert run_to_file(run, path, Options(), force=True).resumed_at is None
    assert not part_of(path).exists()


def test_an_interrupted_file_is_not_replaced_unasked(path: Path) -> None:
    run = study(**{"scheme.start": 0, "grid.cells": 1600})
    interrupt(run, path)
    with pytest.raises(StorageError, match=r"out\.h5 holds the run of an earlier start until t = "):
        run_to_file(run, path, Options())


def spoil(path: Path, name: str, places: list[int]) -> None:
    """Change a bit of checkpoints in a file."""
    with h5py.File(path) as file:
        offset, size = file[name].id.get_offset(), file[name].nbytes // file[name].shape[0]
    data = bytearray(path.read_bytes())
    for place in places:
        data[offset + place * size] ^= 2
    path.write_bytes(data)


@pytest.mark.parametrize("name", [KEPT, SUMS])
def test_a_spoiled_checkpoint_is_not_gone_on_with(tmp_path: Path, path: Path, name: str) -> None:
    run = study()
    run_to_file(run, tmp_path / "whole.h5", Options())
    reached = [kept.numbers["t"] for kept in kill(run, path, 4)]
    spoil(part_of(path), name, [1])  # the last of the four
    before = part_of(path).read_bytes()
    outcome = run_to_file(run, path, Options(), resume=True)
    assert (outcome.resumed_at, outcome.spoiled) == (reached[-2], 0)
    assert_same(path, tmp_path / "whole.h5")
    path.unlink()
    part_of(path).write_bytes(before)
    spoil(part_of(path), name, [0])  # now neither is whole
    outcome = run_to_file(run, path, Options(), resume=True)
    assert (outcome.resumed_at, outcome.spoiled) == (None, 1)
    assert_same(path, tmp_path / "whole.h5")


def test_a_spoiled_checkpoint_of_an_interrupted_file_is_not_gone_on_with(path: Path) -> None:
    run = study(**{"scheme.start": 0, "grid.cells": 1600})
    interrupt(run, path)
    spoil(path, KEPT, [0])
    outcome = run_to_file(run, path, Options(), resume=True)
    assert (outcome.resumed_at, outcome.spoiled) == (None, 1)


def test_a_checkpoint_that_is_cut_off_leaves_the_one_before(tmp_path: Path, path: Path) -> None:
    run = study()
    run_to_file(run, tmp_path / "whole.h5", Options())
    reached = [kept.numbers["t"] for kept in kill(run, path, 3)]
    with pytest.MonkeyPatch.context() as patch, pytest.raises(KilledError):
        write = KeptRun.__init__

        def tearing(self: KeptRun, layout: Any, put: Any) -> None:
            def half(name: str, place: int, data: bytes) -> None:
                put(name, 2 * place, data[: len(data) // 2])  # the first half of the element
                raise KilledError

            write(self, layout, half)

        patch.setattr(KeptRun, "__init__", tearing)
        run_to_file(run, path, Options(), resume=True)
    assert run_to_file(run, path, Options(), resume=True).resumed_at == reached[-1]
    assert_same(path, tmp_path / "whole.h5")
