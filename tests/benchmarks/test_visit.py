"""The benchmark of a GPU, tried on the CPU at its smallest sizes: all of it, out of time, interrupted."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from helpers.places import BENCHMARKS

from warpgran.case.case import Case
from warpgran.solve.variant import variant_of

PROGRAM = BENCHMARKS / "gpu.py"
COMMAND = [sys.executable, str(PROGRAM), "--device", "cpu", "--quick"]

pytestmark = pytest.mark.slow


def found(file: Path) -> dict[str, Any]:
    data: dict[str, Any] = json.loads(file.read_text())
    return data


def test_a_visit_finds_what_it_is_for(tmp_path: Path) -> None:
    done = subprocess.run([*COMMAND, "--json", "all.json"], capture_output=True, text=True, check=False, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    data = found(tmp_path / "all.json")
    assert data["complete"]
    assert data["left_out"] == []
    assert [check["right"] for check in data["correctness"]] == [True] * 6
    assert {(f["cells"], f["runs"], f["precision"]) for f in data["throughput"]} == {
        (64, runs, precision) for runs in (1, 2) for precision in ("float64", "float32")
    }
    for section, figure in (("throughput", "cell_steps_a_second"), ("cpu", "cell_steps_a_second"),
                            ("collapses", "a_minute"), ("stages", "ns_a_cell"), ("launches", "seconds_a_step"),
                            ("memory", "copy_bytes_a_second")):  # fmt: skip
        assert all(entry[figure] > 0.0 for entry in data[section]), section
    assert "checks passed         6 of 6" in done.stdout[done.stdout.index("In short") :]


def test_the_counts_are_of_the_kernels() -> None:
    """Updating three numbers takes seven arrays and three; a division is one that the compiler did not take away."""
    sys.path.insert(0, str(PROGRAM.parent))
    try:
        from parts.counts import counts, total
        from parts.registers import most

        variant = variant_of(Case().with_(**{"scheme.order": 1}), "float64")
        of, taken = counts(variant), most(variant)
    finally:
        sys.path.remove(str(PROGRAM.parent))
    assert (of["update"].read, of["update"].written, of["update"].divisions) == (7, 3, 0)
    assert total(of).bytes("float64") == 2 * total(of).bytes("float32") == 8 * (total(of).read + total(of).written)
    assert of["flux"].roots > 0
    assert 32 < taken.registers < 255 and taken.frame == 0  # nothing is spilled


def test_a_visit_cut_short_keeps_what_it_has(tmp_path: Path) -> None:
    file = tmp_path / "part.json"
    with subprocess.Popen([*COMMAND, "--json", str(file)], stdout=subprocess.PIPE, text=True) as process:
        while not (file.exists() and "correctness" in file.read_text()):
            assert process.poll() is None
            time.sleep(0.02)
        process.send_signal(signal.SIGTERM)
        output, _ = process.communicate(timeout=60)
    data = found(file)
    assert not data["complete"]
    assert data["left_out"][-1] == "the rest: interrupted"
    assert "In short" in output


@pytest.mark.parametrize(
    ("options", "words"),
    [(["--device", "cuda:99"], "'cuda:99' is not on this machine"), (["--json", "absent/a.json"], "absent/a.json")],
)
def test_what_cannot_be_is_told_at_once(tmp_path: Path, options: list[str], words: str) -> None:
    done = subprocess.run([*COMMAND, *options], capture_output=True, text=True, check=False, cwd=tmp_path)
    assert done.returncode == 2
    assert words in done.stderr
    assert "Traceback" not in done.stderr
