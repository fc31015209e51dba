"""Commands tried in a process of their own, with a limit of time: what ended them is reported, never raised."""

from __future__ import annotations

import json
import select
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import NamedTuple

WORKER = Path(__file__)


class Attempt(NamedTuple):
    """How a command ended.

    Attributes:
        code: Exit status; -N for a signal N.
        text: What it wrote on both streams.
        seconds: How long it took.
        fault: What is wrong with that: "traceback", "crash", "hang", or "" if nothing is.
    """

    code: int
    text: str
    seconds: float
    fault: str


class Tries:
    """A process that tries one command after the other, in the folder given, and is started anew when it dies."""

    def __init__(self, folder: Path, limit: float = 20.0) -> None:
        self.folder, self.limit = folder, limit
        self._process: subprocess.Popen[str] | None = None

    def __enter__(self) -> Tries:
        return self

    def __exit__(self, *_: object) -> None:
        self._end()

    def of(self, *arguments: str) -> Attempt:
        """Try `warpgran` with these arguments."""
        if self._process is None:
            self._process = subprocess.Popen(
                [sys.executable, str(WORKER)], cwd=self.folder, text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE
            )
            assert self._process.stdout and self._process.stdout.readline() == "ready\n"
        process, began = self._process, time.monotonic()
        assert process.stdin and process.stdout
        process.stdin.write(json.dumps(arguments) + "\n")
        process.stdin.flush()
        ready, _, _ = select.select([process.stdout], [], [], self.limit)
        line = process.stdout.readline() if ready else ""
        seconds = time.monotonic() - began
        if line:
            code, text, fault = json.loads(line)
            return Attempt(code, text, seconds, fault)
        code = self._end()
        return Attempt(code, "", seconds, "crash" if ready else "hang")

    def _end(self) -> int:
        """End the process; -N if it had died of signal N."""
        process, self._process = self._process, None
        if process is None:
            return 0
        code = process.poll()
        process.kill()
        process.communicate()
        return code if code is not None else -signal.SIGKILL


def _work() -> None:
    """Try what standard input asks for, a JSON list of arguments a line, and answer in JSON."""
    import warnings

    from typer.testing import CliRunner

    from warpgran.cli.app import app

    answers = sys.stdout
    print("ready", file=answers, flush=True)
    for line in sys.stdin:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("default")
            result = CliRunner().invoke(app, json.loads(line))
        clean = result.exception is None or isinstance(result.exception, SystemExit)
        said = "" if clean else f"{type(result.exception).__name__}: {result.exception}"
        said += "".join(f"\n{type(w.message).__name__}: {w.message}" for w in caught)
        fault = "" if clean else "traceback"
        print(json.dumps([result.exit_code, result.output + said, fault]), file=answers, flush=True)


if __name__ == "__main__":
    _work()
