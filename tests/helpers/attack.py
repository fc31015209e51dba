"""What the scripts of tests/adversary share: commands tried in processes of their own, and what counts as a finding.

They take minutes, pytest does not collect them, and each is run by its path. A finding is a traceback, a warning of
Python or NumPy, a signal, an exit status that warpgran has not, a trial that takes longer than LIMIT, or what a script
adds, such as results that differ in a bit. Each prints a line with counts, and exits with 1 if there is a finding.
"""

from __future__ import annotations

import argparse
import os
import random
import signal
import sys
import time
import traceback
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from warpgran.run.outcome import Outcome, Progress, Sink

LIMIT = 20.0
"""Seconds that no trial may take, of a processor, so that a machine that does other things finds nothing else."""
PATIENCE = 10.0
"""Times LIMIT that a trial may take by the clock."""
CODES = (0, 1, 2, 130)
"""Exit statuses of warpgran."""
QUICK = """
title = "Quick"
[slope]
angle = 20.0
[grid]
right = 0.6
cells = 160
[time]
end = 0.05
snapshots = { every = 0.01 }
series = { every = 0.005 }
"""
SWEEP = """
[sweep.over]
"slope.angle" = [0, 8, 16, 24]
"column.phi" = [0.56, 0.58, 0.62]
"""


class Ended(NamedTuple):
    """How a trial ended: its exit status (negative: a signal; None: it took longer than LIMIT), and what it said."""

    code: int | None
    said: str

    @property
    def finding(self) -> str:
        """What is wrong with it, "" if nothing is."""
        if self.code is None:
            return f"took longer than {LIMIT:g} s"
        if self.code < 0:
            return f"ended by signal {-self.code}"
        if "Traceback" in self.said and "Exception ignored" not in self.said:  # Ctrl-C within a destructor
            return f"traceback: {self.said.strip().splitlines()[-1]}"
        if warned := next((line for line in self.said.splitlines() if "Warning: " in line), ""):
            return f"warned: {warned}"
        return "" if self.code in CODES else f"exit status {self.code}"


def asked(trials: int, seed: int) -> tuple[int, random.Random]:
    """The number of trials and the random numbers that the command line asks for, `--trials 200 --seed 1`."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--trials", type=int, default=trials)
    parser.add_argument("--seed", type=int, default=seed)
    options = parser.parse_args()
    return options.trials, random.Random(options.seed)


def warpgran(*arguments: str, folder: Path, kill: tuple[float, int] | None = None) -> Ended:
    """Try a command in a fork of this process, which has everything imported.

    Args:
        arguments: Of the command line.
        folder: To run in.
        kill: Seconds after which the fork gets a signal, and the signal.
    """
    return tried(lambda: _run(arguments), folder, kill)


def tried(work: Callable[[], None], folder: Path, kill: tuple[float, int] | None = None) -> Ended:
    """Try anything in a fork of this process; see `warpgran`."""
    sys.stdout.flush()
    log = Path(f"{folder}.log")
    child = os.fork()
    if child == 0:
        _in_child(work, folder, log)
    began, code, sent = time.monotonic(), None, False
    while (waited := os.wait4(child, os.WNOHANG))[0] == 0:
        took = time.monotonic() - began
        if kill and not sent and took >= kill[0]:
            os.kill(child, kill[1])
            sent = True
        if took > PATIENCE * LIMIT:
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)
            break
        time.sleep(0.002)
    else:
        used = waited[2].ru_utime + waited[2].ru_stime
        code = os.waitstatus_to_exitcode(waited[1]) if used <= LIMIT else None
    said = log.read_text(errors="replace")
    log.unlink()
    return Ended(code, said)


def _in_child(work: Callable[[], None], folder: Path, log: Path) -> None:
    output = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    os.dup2(output, 1)
    os.dup2(output, 2)
    code = 0
    try:
        os.chdir(folder)
        work()
    except SystemExit as error:
        code = error.code if isinstance(error.code, int) else int(error.code is not None)
    except KeyboardInterrupt:  # before or after the command
        code = 130
    except BaseException:
        traceback.print_exc()
        code = 70
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)


def _run(arguments: Sequence[str]) -> None:
    from warpgran.cli.app import app
    from warpgran.solve import engines

    engines.KEEP_EVERY = 0.01  # so that a run of a moment has checkpoints
    app(list(arguments))


def prepared(folder: Path, text: str, *options: str) -> dict[str, Any]:
    """Write a run file `case.toml`, compute it here, so that all is imported and compiled, and return what it gave."""
    from typer.testing import CliRunner

    import warpgran as wg
    from warpgran.cli.app import app

    (folder / "case.toml").write_text(text)
    out = folder / "whole.h5"
    result = CliRunner().invoke(app, ["run", str(folder / "case.toml"), "-o", str(out), *options])
    assert result.exit_code == 0, result.output
    with wg.open_dataset(out) as data:
        return {str(name): values.values for name, values in data.load().variables.items()}


def killed(outcome: Outcome) -> Outcome:
    """What becomes of a study at its half: the process ends, and leaves the part file."""
    sys.exit(0)


def interrupted(outcome: Outcome) -> Outcome:
    """What becomes of a study at its half: Ctrl-C, and the file has what was computed."""
    outcome.interrupted = True
    return outcome


def half(folder: Path, after: Callable[[Outcome], Outcome]) -> Path:
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


def spoiled(data: bytes, rng: random.Random) -> tuple[str, bytes]:
    """What a disk may do to the bytes of a file: in words, and the bytes."""
    bad, kind, size = bytearray(data), rng.random(), len(data)
    near = rng.choice((size, size, 30_000))  # the structure stands at the beginning
    at = rng.randrange(min(near, size))
    if kind < 0.1:
        return f"cut at {at}", data[:at]
    if kind < 0.25:
        bad[at : at + 512] = bytes(len(bad[at : at + 512]))
        return f"512 zeros at {at}", bytes(bad)
    places = [rng.randrange(min(near, size)) for _ in range(rng.choice((1, 1, 2, 8)))]
    for place in places:
        bad[place] ^= 1 << rng.randrange(8)
    return f"bits flipped at {places}", bytes(bad)


def same(path: Path, whole: dict[str, Any]) -> bool:
    """Whether a result has the bits of another."""
    import warpgran as wg

    with wg.open_dataset(path) as data:
        found = {str(name): values.values for name, values in data.load().variables.items()}
    return found.keys() == whole.keys() and all(_equal(found[name], whole[name]) for name in whole)


def _equal(a: Any, b: Any) -> bool:
    return a.dtype.kind == b.dtype.kind and np.array_equal(a, b, equal_nan=a.dtype.kind == "f")


def report(what: str, ended: Sequence[Ended], findings: Sequence[str]) -> None:
    """Print the findings and a line with counts; exit with 1 if there are findings."""
    for finding in findings:
        print(f"  {finding}")
    codes = ", ".join(f"{count} x {code}" for code, count in sorted(Counter(str(e.code) for e in ended).items()))
    print(f"{what}: {len(ended)} trials, exit status {codes}; {len(findings)} findings")
    sys.exit(1 if findings else 0)
