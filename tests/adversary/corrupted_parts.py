"""200 part files with flipped, zeroed or missing bytes, resumed: refused in a line, or the bits of the whole study.

And a quarter as many finished files of an interrupted study.
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent.parent))  # for tests/helpers

from helpers.attack import (
    QUICK,
    SWEEP,
    Ended,
    asked,
    half,
    interrupted,
    killed,
    prepared,
    report,
    same,
    spoiled,
    warpgran,
)

TRIALS = 200


def main() -> None:
    """Resume corrupted copies of the files of a study that was killed, or interrupted."""
    trials, rng = asked(TRIALS, seed=1)
    ended: list[Ended] = []
    findings: list[str] = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        whole = prepared(folder, QUICK + SWEEP, "--no-picture")
        for suffix, count, after in ((".h5.part", trials, killed), (".h5", trials // 4, interrupted)):
            sound = (half(folder, after) / f"half{suffix}").read_bytes()
            for trial in range(count):
                here = folder / f"trial{trial}"
                here.mkdir()
                how, data = spoiled(sound, rng)
                (here / f"out{suffix}").write_bytes(data)
                end = warpgran("run", "../case.toml", "-o", "out.h5", "--resume", "--no-picture", folder=here)
                wrong = end.finding
                if not wrong and end.code == 0 and not same(here / "out.h5", whole):
                    wrong = "resumed to other numbers"
                if not wrong and end.code == 2 and len(end.said.strip().splitlines()) != 1:
                    wrong = f"several lines: {end.said}"
                ended.append(end)
                findings += [f"{suffix}, trial {trial}, {how}: {wrong}"] if wrong else []
                shutil.rmtree(here)
    report("corrupted part files", ended, findings)


if __name__ == "__main__":
    main()
