"""The picture of a run, drawn by a process of its own while this one computes and prints.

What draws takes as long to be imported and to draw as a short run takes, and Python does one thing at a time. On two
cores the run of `benchmarks/startup.py` takes a quarter less with its picture so.
"""

from __future__ import annotations

import gc
import os
import subprocess
import sys
from contextlib import suppress
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

from warpgran.errors import WarpgranError

if TYPE_CHECKING:
    from warpgran.analysis.run_columns import RunColumns

SUFFIX = ".png"


class Drawing:
    """A process that draws the picture of a run, and this one in its place. A context manager, which ends the process.

    This one draws where a process gains nothing or cannot be had, and whenever it has not drawn, whatever the reason.
    """

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        command = [sys.executable, "-P", "-c", f"from {__name__} import main; main()"]
        with suppress(OSError):  # a session of its own, since Ctrl-C ends the computation and not the picture of it
            if _gains():
                self._process = subprocess.Popen(command, stdin=subprocess.PIPE, start_new_session=True)

    def begin(self, path: Path) -> None:
        """Let the process begin to draw the result of this file."""
        if self._process and self._process.stdin:
            with suppress(BrokenPipeError), self._process.stdin as told:
                told.write(os.fsencode(path))

    def end(self, path: Path, data: RunColumns) -> list[str]:
        """Wait for the picture beside a result, or draw it here, or say on standard error why there is none.

        Returns:
            The path of the picture, or nothing.
        """
        from warpgran.cli.pictures import beside

        made = path.with_suffix(SUFFIX)
        if self._process and self._process.wait() == 0:
            return [str(made)]
        from warpgran.figures.plot import plot

        return beside("picture", made, lambda: plot(data, path=made))

    def __enter__(self) -> Drawing:
        return self

    def __exit__(self, *error: object) -> None:
        if self._process:
            with self._process:
                self._process.kill()


def _gains() -> bool:
    """Whether a process gains time: there are more cores than one, and what draws is not imported here already."""
    return os.cpu_count() != 1 and "warpgran.figures.plot" not in sys.modules


def main() -> None:
    """The process: import what draws, wait for the path of a result, and draw it. Exit status 0 if it is drawn."""
    gc.disable()  # what modules make is no garbage, and there is no time for any other to become much
    from warpgran.figures.plot import plot
    from warpgran.results.columns import opened_columns

    _warm_up()
    path = Path(os.fsdecode(sys.stdin.buffer.read()))
    drawn = False
    with suppress(WarpgranError, OSError):  # which the run tells, when it finds the same; "" if there is no result
        with opened_columns(path) as columns:
            plot(columns, path=path.with_suffix(SUFFIX))
        drawn = True
    os._exit(not drawn)  # the run waits, and to take all modules apart would take a tenth of its time


def _warm_up() -> None:
    """Draw the labels of a page while there is time: fonts and formulas are a quarter of the time of a page."""
    from matplotlib import rc_context

    from warpgran.analysis.units import Lengths
    from warpgran.figures.one_run import POSITION, PROFILES, SERIES
    from warpgran.figures.style import STYLE, TIME_LABEL, Sheet

    laboratory = Lengths(along=1.0, thick=0.1)  # whose units other labels may have
    page = Sheet()
    with rc_context(STYLE):
        page.add_subplot(yscale="log", ylim=(1e-3, 10.0))
        for label in (*(panel.of(laboratory).label for panel in (*PROFILES, *SERIES, POSITION)), TIME_LABEL):
            page.text(0.0, 0.0, label)
    page.savefig(BytesIO(), format="png")
