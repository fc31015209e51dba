"""60 kills at random moments, of single runs and batches, then --resume: the bits of what was never stopped."""

from __future__ import annotations

import random
import shutil
import signal
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent.parent))  # for tests/helpers

from helpers.attack import QUICK, SWEEP, Ended, prepared, report, same, warpgran

TRIALS = 60
STUDIES = {
    "a run": QUICK,
    "a batch": QUICK + SWEEP,
    "a batch of order 1": QUICK + "[scheme]\norder = 1\n" + SWEEP,
    "a run on finer cells first": QUICK + "[scheme]\nstart = 2\n",
}


def main() -> None:
    """Kill, resume, compare."""
    rng = random.Random(2)
    ended: list[Ended] = []
    findings: list[str] = []
    trials = int(sys.argv[1]) if len(sys.argv) > 1 else TRIALS
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
                ends, wrong = _trial(here, rng, takes)
                if not wrong and not same(here / "out.h5", whole):
                    wrong = "resumed to other numbers"
                if not wrong and sorted(path.name for path in here.iterdir()) != ["out.h5"]:
                    wrong = f"leaves {sorted(path.name for path in here.iterdir())}"
                ended += ends
                findings += [f"trial {trial}, {name}, {[end.code for end in ends]}: {wrong}"] if wrong else []
                shutil.rmtree(here)
    report("kills", ended, findings)


def _trial(here: Path, rng: random.Random, takes: float) -> tuple[list[Ended], str]:
    """Kill a study one to three times, and let it end."""
    ends: list[Ended] = []
    for _ in range(rng.choice((1, 1, 2, 3))):
        number = rng.choice((signal.SIGKILL, signal.SIGKILL, signal.SIGINT))
        command = ("run", "../case.toml", "-o", "out.h5", "--no-picture", "--threads", "2", "--resume")
        end = warpgran(*command, folder=here, kill=(rng.uniform(0.0, 1.1 * takes), int(number)))
        ends.append(end)
        if end.code != -signal.SIGKILL and end.finding:
            return ends, end.finding
    end = warpgran("run", "../case.toml", "-o", "out.h5", "--no-picture", "--resume", folder=here)
    ends.append(end)
    return ends, end.finding or ("" if end.code == 0 else end.said)


if __name__ == "__main__":
    main()
