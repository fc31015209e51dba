"""A visit to a machine: what was found, printed and written as it comes, and how much time is left."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from warpgran.files import replacing


class Visit:
    """What has been found, and how much time is left."""

    def __init__(self, device: str, minutes: float, file: Path | None) -> None:
        self.device, self.file = device, file
        self._end = time.perf_counter() + 60.0 * minutes
        self._stopped = False
        self.found: dict[str, Any] = {"complete": False, "left_out": []}

    @property
    def left(self) -> float:
        """Seconds."""
        return self._end - time.perf_counter()

    def stop(self, *signal: Any) -> None:
        """End the visit; a handler of signals.

        What is raised while Python tidies up is lost, so that the next figure raises it again.
        """
        self._stopped = True
        raise KeyboardInterrupt

    def note(self, section: str, figure: Any, words: str) -> None:
        """Keep a figure, an entry of a section, and print it."""
        self.found.setdefault(section, []).append(figure)
        print(words, flush=True)
        self.write()
        if self._stopped:
            raise KeyboardInterrupt

    def leave_out(self, what: str, why: str) -> None:
        """Say that something is not measured."""
        self.found["left_out"].append(f"{what}: {why}")
        print(f"left out: {what}: {why}", flush=True)
        self.write()

    def write(self) -> None:
        """The JSON file as it stands."""
        if self.file:
            with replacing(self.file) as part:
                part.write_text(json.dumps(self.found, indent=1) + "\n", encoding="utf-8")

    @contextmanager
    def trying(self, what: str, seconds: float = 0.0) -> Iterator[bool]:
        """Whether there are still so many seconds for something; if it fails within, that is noted and all goes on."""
        if self.left < seconds:
            self.leave_out(what, f"would take some {seconds:.0f} s, {max(self.left, 0.0):.0f} s are left")
            yield False
            return
        try:
            yield True
        except (MemoryError, RuntimeError, ValueError) as error:
            self.leave_out(what, f"{type(error).__name__}: {error}".partition("\n")[0])
