"""What `warpgran run` prints of a study and its results."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from warpgran.cli.terminal import say, stdout, tell

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from warpgran.analysis.run_columns import RunColumns
    from warpgran.case.study import Study
    from warpgran.run.outcome import Outcome

WIDTH = 100
"""Characters of the summary where standard output is no terminal."""


def report(study: Study, data: RunColumns, outcome: Outcome) -> None:
    """Print the caveats, the summary, the speed, and how to go on with an interrupted study."""
    import numpy as np

    from warpgran.analysis.run_columns import WAITING
    from warpgran.analysis.summary import summary_columns

    table = summary_columns(data)  # first, since nothing is said of numbers that cannot be read
    if outcome.spoiled:
        were = "1 run was" if outcome.spoiled == 1 else f"{outcome.spoiled} runs were"
        tell(f"{were} damaged in the file of the earlier start, and computed again")
    if outcome.resumed_at is not None:
        tell(f"the run went on from t = {outcome.resumed_at:.4g} s, where the earlier start had kept it")
    print_caveats(data)
    if study.base.title:
        say(study.base.title)
    print_summary(table)
    print_speed(outcome)
    if outcome.interrupted:
        if not np.isin(data.status, WAITING).any():
            what = "the file is complete, of this start or an earlier one"
        elif data.run.size > 1:
            what = "go on with --resume"
        elif outcome.kept_at is not None:
            what = f"the run is kept as of t = {outcome.kept_at:.4g} s: go on with --resume"
        else:
            what = "what it had is in the file, not enough to go on with: a next start begins anew"
        tell(f"interrupted; {what}")


def print_speed(outcome: Outcome) -> None:
    """Print the work of the time loops and its speed, if any was done."""
    if outcome.kernel_seconds > 0.0:
        steps, seconds = outcome.cell_steps / 1e6, outcome.kernel_seconds
        say(f"{steps:.1f} million cell-steps in {seconds:.3f} s: {steps / seconds:.1f} million a second")


def warn_of(study: Study) -> None:
    """Say on standard error what is unlikely of a study."""
    from warpgran.case.unlikely import unlikely

    for line in unlikely(study):
        tell(f"warning: {line}")


def print_caveats(data: xr.Dataset | RunColumns, of: str = "") -> None:
    """Say on standard error which runs, `of` which file, did not end cleanly or have results to be read with care."""
    from warpgran.analysis.caveats import messages

    for line in messages(data):
        tell(f"{of}: {line}" if of else line)


def print_summary(frame: pd.DataFrame | Mapping[str, Any]) -> None:
    """Print a summary, at the width of the terminal."""
    from warpgran.cli.table import rich_table

    console = stdout(WIDTH)
    console.print(rich_table(frame, width=console.width))
