"""24 calibrations killed at random moments, and 36 with spoiled files of what they keep; resumed: the same numbers.

What is spoiled is the sampler's checkpoint, batches of runs, the result files of screening and predictions, of a
calibration that has ended and of one that was killed in its posterior: computed again, or refused in a line.
"""

from __future__ import annotations

import random
import shutil
import signal
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import h5py
import numpy as np

sys.path.insert(0, str(Path(__file__).parent.parent))  # for tests/helpers

from helpers.attack import Ended, asked, report, spoiled, tried, warpgran

TRIALS = 60
KILLED = 0.4
"""Share of the trials that kill."""
CASE = """
title = "Quick"
[grid]
left = -0.2
right = 0.6
cells = 40
[time]
end = 0.2
series = { every = 0.05 }
[calibration]
screening = 16
particles = 64
chains = 2
starts = 1
predictive = 3
[calibration.over]
"rheology.mu1" = { low = 0.3, high = 0.6 }
"rheology.K" = { mean = 4.0, sd = 1.0, low = 0.0 }
"""
MEASURED = "angle,t,x,sigma\n0,0.1,0.16,0.01\n0,0.2,0.285,0.01\n20,0.1,0.175,0.01\n20,0.2,0.345,0.01\n"
WORDS = ("calibrate", "../case.toml", "--data", "../data", "-o", "out")


def main() -> None:
    """Kill or spoil, resume, compare."""
    trials, rng = asked(TRIALS, seed=4)
    ended: list[Ended] = []
    findings: list[str] = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        whole, code, takes = _whole(folder)
        half = folder / "half"
        for trial in range(trials):
            here = folder / f"trial{trial}"
            kills = trial < KILLED * trials
            if kills:
                here.mkdir()
                how, ends = _killed(here, rng, takes)
            else:
                shutil.copytree(half if trial % 2 else folder / "whole", here)
                how, ends = _spoiled(here, rng), []
            last = warpgran(*WORDS, folder=here)
            ends.append(last)
            wrong = next((end.finding for end in ends if end.code != -signal.SIGKILL and end.finding), "")
            if not wrong and last.code == code and not _same(here / "out" / "calibration.nc", whole):
                wrong = "resumed to other numbers"
            if not wrong and last.code != code:
                refused = not kills and last.code == 2 and len(last.said.strip().splitlines()) == 1
                wrong = "" if refused else f"exit status {last.code} instead of {code}: {last.said}"
            ended += ends
            findings += [f"trial {trial}, {how}: {wrong}"] if wrong else []
            shutil.rmtree(here)
    report("calibrations", ended, findings)


def _whole(folder: Path) -> tuple[dict[str, Any], int, float]:
    """A calibration in folder/whole, and its first half in folder/half; its numbers, exit status and seconds."""
    from typer.testing import CliRunner

    from warpgran.cli.app import app

    (folder / "case.toml").write_text(CASE)
    (folder / "data").mkdir()
    (folder / "data" / "front.csv").write_text(MEASURED)
    files = str(folder / "case.toml"), "--data", str(folder / "data")
    done = CliRunner().invoke(app, ["calibrate", *files, "-o", str(folder / "first")])  # imports, compiles
    assert done.exit_code in (0, 1), done.output
    (folder / "whole").mkdir()
    began = time.monotonic()
    assert (end := warpgran(*WORDS, folder=folder / "whole")).code == done.exit_code, end.said
    takes = time.monotonic() - began
    (folder / "half").mkdir()
    assert tried(_half, folder / "half").code == 0
    return _numbers(folder / "whole" / "out" / "calibration.nc"), done.exit_code, takes


def _half() -> None:
    """A calibration that ends after the first temperature of its posterior."""
    from warpgran.calibration.calibrate import run_stages
    from warpgran.case.calibration_section import read_calibration
    from warpgran.run.options import Options

    def show(words: str, done: float, of: float) -> None:
        if words == "posterior":
            sys.exit(0)

    run_stages(read_calibration(Path("../case.toml"), ()), Path("../data"), Path("out"), Options(), "posterior", show)


def _killed(here: Path, rng: random.Random, takes: float) -> tuple[str, list[Ended]]:
    """Kill a calibration one to three times."""
    ends = []
    for _ in range(rng.choice((1, 1, 2, 3))):
        number = rng.choice((signal.SIGKILL, signal.SIGKILL, signal.SIGINT))
        ends.append(warpgran(*WORDS, folder=here, kill=(rng.uniform(0.0, 1.1 * takes), int(number))))
    return f"killed, {[end.code for end in ends]}", ends


def _spoiled(here: Path, rng: random.Random) -> str:
    """Spoil one or two of the files that a calibration keeps, each kind as often as the others."""
    kept = sorted(path for path in (here / "out" / "runs").rglob("*") if path.is_file())
    kinds: dict[str, list[Path]] = {}
    for path in kept:
        kinds.setdefault(path.parent.name if path.suffix == ".npz" else path.name, []).append(path)
    said = []
    for kind in rng.sample(sorted(kinds), rng.choice((1, 1, 2))):
        path = rng.choice(kinds[kind])
        how, data = spoiled(path.read_bytes(), rng)
        path.write_bytes(data)
        said.append(f"{path.relative_to(here)} {how}")
    return ", ".join(said)


def _numbers(path: Path) -> dict[str, Any]:
    """Every array of a file by its place."""
    found: dict[str, Any] = {}
    with h5py.File(path) as file:
        file.visititems(lambda name, item: found.update({name: item[...]} if isinstance(item, h5py.Dataset) else {}))
    return found


def _same(path: Path, whole: dict[str, Any]) -> bool:
    found = _numbers(path)
    return found.keys() == whole.keys() and all(
        np.array_equal(found[name], whole[name], equal_nan=whole[name].dtype.kind == "f") for name in whole
    )


if __name__ == "__main__":
    main()
