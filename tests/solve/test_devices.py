"""Devices: what may be asked for, how runs are shared between several, and what a GPU must give."""

from __future__ import annotations

import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from threading import Barrier

import numpy as np
import pytest
import warp as wp
import xarray as xr
from helpers.cases import GPUS, ON_ONE_GRID, VIOLENT, small
from helpers.places import TESTS

import warpgran as wg
from warpgran.case.case import Case
from warpgran.case.study import Study
from warpgran.errors import OptionError
from warpgran.kernels.build import SCHEMES
from warpgran.kernels.precision import MARGIN
from warpgran.results.layout import Layout
from warpgran.run.options import Options
from warpgran.run.threads import _Workers
from warpgran.solve.blocks import plan
from warpgran.solve.device import DeviceError, find_devices
from warpgran.solve.engines import run_kernels
from warpgran.solve.finished import SCALARS
from warpgran.solve.schedule import Outputs
from warpgran.solve.solver import Solver
from warpgran.solve.state import bytes_of_run, most_runs
from warpgran.solve.variant import variant_of


def cases() -> list[Case]:
    """Twelve runs that differ, the last of which diverges."""
    series = {"time.series": {"every": 0.05}}
    made = [small(**series, **{"slope.angle": 2.0 * r, "grid.cells": 100 + 10 * r}) for r in range(11)]
    return [*made, small(**series, **VIOLENT)]


def same_but_for_how(a: xr.Dataset, b: xr.Dataset) -> None:
    """Assert that two results differ at most in where and how fast they were computed."""
    for name in a.variables:
        np.testing.assert_array_equal(a[name].values, b[name].values, err_msg=str(name))
    assert a.attrs["cell_steps"] == b.attrs["cell_steps"]


# Which, and what of them


@pytest.mark.parametrize(
    ("names", "words"),
    [
        ("cuda:99", "'cuda:99' is not on this machine; there is: cpu"),
        ("cpu,cuda:99", "'cuda:99' is not on this machine"),
        ("cpu,", "'' is not on this machine"),
    ],
)
def test_devices_that_are_not_there(names: str, words: str, capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(DeviceError, match=words):
        find_devices(names)
    assert capfd.readouterr() == ("", "")


@pytest.mark.skipif(wp.is_cuda_available(), reason="there is an NVIDIA GPU here")
def test_a_gpu_where_there_is_none(capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(DeviceError, match="'cuda' is not on this machine; there is: cpu"):
        find_devices("cuda")
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("gpu", GPUS)
def test_devices_that_do_not_go_together(gpu: str) -> None:
    for names, words in ((f"cpu,{gpu}", "of two kinds"), (f"{gpu},{gpu}", "names a GPU twice")):
        with pytest.raises(DeviceError, match=words):
            find_devices(names)


def test_threads_must_suit_the_devices() -> None:
    with pytest.raises(OptionError, match="threads: 1 for 2 devices"):
        wg.simulate(small(), device="cpu,cpu", threads=1)


@pytest.mark.parametrize("gpu", GPUS)
def test_a_gpu_has_one_thread(gpu: str) -> None:
    with pytest.raises(OptionError, match="threads: 2 for 1 devices; allowed: one for each"):
        wg.simulate(small(), device=gpu, threads=2)


# Several


def test_a_device_a_thread_in_turn() -> None:
    workers, together = _Workers(Options(device="cuda:0, cuda:1"), Layout(Study.of([small()]))), Barrier(2)

    def devices(_: int) -> list[str]:
        together.wait()
        return [workers.device() for _ in range(3)]

    with ThreadPoolExecutor(2) as pool:
        assert sorted(pool.map(devices, range(2))) == [["cuda:0"] * 3, ["cuda:1"] * 3]


def test_devices_share_the_runs_and_change_no_bit() -> None:
    one, two = wg.simulate(cases(), threads=1), wg.simulate(cases(), device="cpu,cpu", threads=2)
    assert wg.simulate(small(), device="cpu,cpu").attrs["threads"] == 2
    same_but_for_how(one, two)


@pytest.mark.skipif(wp.get_cuda_device_count() < 2, reason="there are no two NVIDIA GPUs here")
def test_two_gpus_change_no_bit() -> None:
    same_but_for_how(wg.simulate(cases(), device="cuda:0"), wg.simulate(cases(), device="cuda:0,cuda:1"))


@pytest.mark.parametrize(("workers", "sizes"), [(1, [10]), (2, [5, 5]), (4, [3, 2, 3, 2])])
def test_every_gpu_gets_runs(workers: int, sizes: list[int]) -> None:
    study = Study.of([small()] * 10)
    made = plan(study, range(10), Outputs.of(small()), "float64", on_cpu=False, threads=workers, memory=1e12)
    assert [len(block.runs) for block in made] == sizes


# Memory


@pytest.mark.parametrize("padded", [96, 1024, 16_032])
def test_a_state_of_most_runs_fits_the_largest_array(padded: int) -> None:
    few, variant = Outputs.of(small()), variant_of(small(), "float64")
    arrays = len(SCHEMES[variant.order].arrays)
    runs = most_runs(padded, few, variant)
    assert arrays * (runs * (padded + MARGIN) + 4 * MARGIN) < 2**31
    assert arrays * (1.001 * runs + 1) * (padded + MARGIN) > 2**31
    many = Outputs.of(small(**{"time.snapshots": {"every": 0.002}}))
    assert many.snapshots == 101
    assert most_runs(padded, many, variant) == (2**31 - 1 - arrays * 5 * MARGIN) // (101 * padded)


@pytest.mark.parametrize(("fit", "sizes"), [(2.5, [2, 2, 1]), (4.0, [3, 2]), (9.0, [5])])
def test_blocks_are_cut_to_the_memory(fit: float, sizes: list[int]) -> None:
    case = small(**ON_ONE_GRID)  # for the memory of the start: test_start.py
    study, outputs = Study.of([case] * 5), Outputs.of(case)
    (whole,) = plan(study, range(5), outputs, "float64", on_cpu=False, threads=1, memory=1e12)
    memory = fit * bytes_of_run(whole.padded - 1, outputs, whole.variant)
    made = plan(study, range(5), outputs, "float64", on_cpu=False, threads=1, memory=memory)
    assert [len(block.runs) for block in made] == sizes


def test_blocks_are_cut_to_the_largest_array() -> None:
    case = small(**ON_ONE_GRID, **{"grid.cells": 9_000_000})
    study = Study.of([case] * 12)
    made = plan(study, range(12), Outputs.of(case), "float32", on_cpu=False, threads=1, memory=1e15)
    most = most_runs(made[0].padded, Outputs.of(case), made[0].variant)
    assert most < 12
    assert len(made) == -(-12 // most) and max(len(block.runs) for block in made) <= most


NO_ROOM = """
import resource
from helpers.cases import small
from warpgran.solve.schedule import Outputs
from warpgran.solve.solver import Solver
from warpgran.solve.variant import variant_of
with open("/proc/self/statm") as file:
    used = int(file.read().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (used + 2**29, used + 2**29))
Solver(5000, 1024, variant_of(small(), "float64"), Outputs.of(small()))
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="limits the memory of a process in the way of Linux")
def test_no_room_is_told_with_what_would_fit() -> None:
    done = subprocess.run([sys.executable, "-c", NO_ROOM], capture_output=True, text=True, check=False, cwd=TESTS)
    said = done.stderr.splitlines()[-1]
    assert said.startswith("MemoryError: cpu: no room for 5000 runs of 1023 cells, 1.6 GiB; ")
    assert said.endswith(": give less to a block by --memory")


# What a GPU must give: the scheme's numbers, and always the same


def bits(device: str, precision: str, lanes: int | None = None, chunk: int = 1024) -> list[np.ndarray]:
    """Snapshots, steps and samples of a batch."""
    batch = cases()[:-1]
    padded = 256
    solver = Solver(len(batch), padded, variant_of(batch[0], precision), Outputs.of(batch[0]), device, lanes=lanes,
                    chunk=chunk)  # fmt: skip
    done = run_kernels(solver, batch, lambda t: True)
    return [*done.profiles, done.steps, done.scalars]


@pytest.mark.parametrize("gpu", GPUS)
@pytest.mark.parametrize(("precision", "tolerance"), [("float64", 1e-10), ("float32", 1e-4)])
def test_a_gpu_agrees_with_the_cpu(gpu: str, precision: str, tolerance: float) -> None:
    ours, theirs = (bits(device, precision) for device in (gpu, "cpu"))
    assert np.abs(ours.pop(3) - theirs.pop(3)).max() <= 1  # steps
    for a, b in zip(ours, theirs, strict=True):
        np.testing.assert_allclose(a, b, rtol=0.0, atol=tolerance * np.nanmax(np.abs(b)))


@pytest.mark.parametrize("gpu", GPUS)
@pytest.mark.parametrize("precision", ["float64", "float32"])
def test_a_gpu_gives_the_same_bits_every_time(gpu: str, precision: str) -> None:
    first = bits(gpu, precision)
    for _ in range(3):
        for a, b in zip(bits(gpu, precision), first, strict=True):
            np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize("gpu", GPUS)
@pytest.mark.parametrize(("lanes", "chunk"), [(32, 32), (64, 128), (512, 4096)])
def test_lanes_and_chunks_change_no_bit_but_of_sums(gpu: str, lanes: int, chunk: int) -> None:
    *ours, sums = bits(gpu, "float64", lanes, chunk)
    *theirs, expected = bits(gpu, "float64")
    for a, b in zip(ours, theirs, strict=True):
        np.testing.assert_array_equal(a, b)
    unsummed = [SCALARS.index(name) for name in ("front", "h_max", "v_max", "v_flow")]
    np.testing.assert_array_equal(sums[..., unsummed], expected[..., unsummed])
    np.testing.assert_allclose(sums, expected, rtol=1e-13)
