"""60 kills at random moments, of runs, batches and designs, then --resume: the bits of what was never stopped."""

from __future__ import annotations

import random
import shutil
import signal
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent.parent))  # for tests/helpers

from helpers.attack import QUICK, SWEEP, Ended, asked, prepared, report, same, warpgran

TRIALS = 60
DESIGN = """
[sensitivity]
samples = 4
of = ["front@0.05", "h_max"]
[sensitivity.over]
"rheology.K" = { low = 0.0, high = 8.0 }
"slope.angle" = { low = 0.0, high = 20.0 }
"""
STUDIES = {
    "a run": QUICK,
    "a batch": QUICK + SWEEP,
    "a batch of order 1": QUICK + "[scheme]\norder = 1\n" + SWEEP,
    "a run on finer cells first": QUICK + "[scheme]\nstart = 2\n",
    "a design": QUICK + DESIGN,
}


def main() -> None:
    """Kill, resume, compare."""
    trials, rng = asked(TRIALS, seed=2)
    ended: list[Ended] = []
    findings: list[str] = []
    for n, (name, text) in enumerate(STUDIES.items()):
        with tempfile.TemporaryDirectory() as where:
            folder = Path(where)
            whole = prepared(folder, text.replace("cells = 160", "cells = 400"), "--no-picture")
            began = time.monotonic()
            warpgran("run", "case.toml", "-o", "timed.h5", "--no-picture", folder=folder)
            takes = time.monotonic() - began
            for trial in range(n, trials, len(STUDIES)):
                here = folder / f"trial{trial}"
                here.mkdir()
                ends, wrong = _trial(here, rng, takes, "sensitivity" if text.endswith(DESIGN) else "run")
                if not wrong and not same(here / "out.h5", whole):
                    wrong = "resumed to other numbers"
                left = sorted(path.name for path in here.iterdir() if not path.name.startswith("out_indices"))
                if not wrong and left != ["out.h5"]:
                    wrong = f"leaves {left}"
                ended += ends
                findings += [f"trial {trial}, {name}, {[end.code for end in ends]}: {wrong}"] if wrong else []
                shutil.rmtree(here)
    report("kills", ended, findings)


def _trial(here: Path, rng: random.Random, takes: float, command: str) -> tuple[list[Ended], str]:
    """Kill a study one to three times, and let it end."""
    words = (command, "../case.toml", "-o", "out.h5", "--no-picture", "--resume")
    ends: list[Ended] = []
    for _ in range(rng.choice((1, 1, 2, 3))):
        number = rng.choice((signal.SIGKILL, signal.SIGKILL, signal.SIGINT))
        end = warpgran(*words, "--threads", "2", folder=here, kill=(rng.uniform(0.0, 1.1 * takes), int(number)))
        ends.append(end)
        if end.code != -signal.SIGKILL and end.finding:
            return ends, end.finding
    end = warpgran(*words, folder=here)
    ends.append(end)
    return ends, end.finding or ("" if end.code == 0 else end.said)


if __name__ == "__main__":
    main()
