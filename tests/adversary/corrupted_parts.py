"""200 part files with flipped, zeroed or missing bytes, resumed: refused in a line, or the bits of the whole study.

And a quarter as many finished files of an interrupted study.
"""

from __future__ import annotations

import random
import shutil
import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent.parent))  # for tests/helpers

from helpers.attack import QUICK, SWEEP, Ended, asked, prepared, report, same, tried, warpgran

from warpgran.run.outcome import Outcome, Progress, Sink

TRIALS = 200


def main() -> None:
    """Resume corrupted copies of the files of a study that was killed, or interrupted."""
    trials, rng = asked(TRIALS, seed=1)
    ended: list[Ended] = []
    findings: list[str] = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        whole = prepared(folder, QUICK + SWEEP, "--no-picture")
        for suffix, count, after in ((".h5.part", trials, _killed), (".h5", trials // 4, _interrupted)):
            sound = (_half(folder, after) / f"half{suffix}").read_bytes()
            for trial in range(count):
                here = folder / f"trial{trial}"
                here.mkdir()
                how, data = _corrupted(sound, rng)
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


def _killed(outcome: Outcome) -> Outcome:
    sys.exit(0)


def _interrupted(outcome: Outcome) -> Outcome:
    outcome.interrupted = True
    return outcome


def _half(folder: Path, after: Callable[[Outcome], Outcome]) -> Path:
    """A folder with a file of 8 of 12 runs."""

    def work() -> None:
        from warpgran.case.read_study import read_study
        from warpgran.run import threads
        from warpgran.run.options import Options
        from warpgran.run.to_file import run_to_file

        def compute(sink: Sink, options: Options, runs: Sequence[int], progress: Progress) -> Outcome:
            return after(threads.compute(sink, options, runs[:8], progress))

        run_to_file(read_study("case.toml"), Path("half.h5"), Options(), force=True, compute=compute)

    assert tried(work, folder).code == 0
    return folder


def _corrupted(data: bytes, rng: random.Random) -> tuple[str, bytes]:
    """What was done, and the bytes."""
    spoiled, kind, size = bytearray(data), rng.random(), len(data)
    near = rng.choice((size, size, 30_000))  # the structure stands at the beginning
    at = rng.randrange(min(near, size))
    if kind < 0.1:
        return f"cut at {at}", data[:at]
    if kind < 0.25:
        spoiled[at : at + 512] = bytes(len(spoiled[at : at + 512]))
        return f"512 zeros at {at}", bytes(spoiled)
    places = [rng.randrange(min(near, size)) for _ in range(rng.choice((1, 1, 2, 8)))]
    for place in places:
        spoiled[place] ^= 1 << rng.randrange(8)
    return f"bits flipped at {places}", bytes(spoiled)


if __name__ == "__main__":
    main()
