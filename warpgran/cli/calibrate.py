"""The command `warpgran calibrate`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from warpgran.cli.arguments import Devices, Precision, RunFile, Set
from warpgran.cli.terminal import print_whole, progress_bar, say, tell

if TYPE_CHECKING:
    import pandas as pd
    from rich.table import Table


def calibrate(
    file: RunFile,
    data: Annotated[
        Path, typer.Option("--data", metavar="FOLDER", help="Measurements: profiles.csv, front.csv, volume.csv.")
    ],
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="FOLDER", help="Default: the run file's name and _calibration."),
    ] = None,
    stage: Annotated[
        Literal["screening", "fit", "posterior", "predictive"], typer.Option(help="The last stage to compute.")
    ] = "predictive",
    device: Devices = "cpu",
    precision: Precision = "float64",
    threads: Annotated[int | None, typer.Option(help="Blocks of runs computed at once; default: all cores.")] = None,
    set_: Set = None,
) -> None:
    """Fit parameters to measurements: best fit, posterior and predictions, with their uncertainty."""
    from warpgran.calibration.calibrate import run_stages
    from warpgran.case.calibration_section import read_calibration
    from warpgran.run.options import Options
    from warpgran.solve.device import find_devices, start_quietly

    study = read_calibration(file, set_ or ())
    folder = output or Path(f"{file.stem}_calibration")
    options = Options(device=device, precision=precision, threads=threads)
    start_quietly()
    find_devices(device)
    try:
        with progress_bar("{task.completed:.4g} of {task.total:.4g}") as show:
            found = run_stages(study, data, folder, options, stage, lambda words, done, of: show(done, of, words))
    except KeyboardInterrupt:
        tell("interrupted; what was computed is kept, start again to resume")
        raise typer.Exit(130) from None
    if study.base.title:
        say(study.base.title)
    print_whole(_table(found.table()))
    for line in found.told():
        say(line)
    for path in found.write():
        say(f"wrote {path}")
    raise typer.Exit(0 if found.converged else 1)


_HEADINGS = {
    "prior_5": "prior\n5 %", "prior_95": "\n95 %", "fit": "best\nfit", "fit_sd": "\n±", "mean": "posterior\nmean",
    "sd": "\n±", "q5": "\n5 %", "q50": "\n50 %", "q95": "\n95 %", "r_hat": "\nR-hat", "effective": "effective\ndraws",
}  # fmt: skip


def _table(frame: pd.DataFrame) -> Table:
    """A row a parameter, in the units of the run file."""
    from rich.table import Table

    table = Table(box=None, padding=(0, 2, 0, 0), pad_edge=False, header_style="bold")
    table.add_column("\nparameter", no_wrap=True)
    for name in frame:
        table.add_column(_HEADINGS[str(name)], justify="right", no_wrap=True)
    for parameter, row in frame.iterrows():
        shown = [f"{v:.0f}" if name == "effective" else f"{v:.4g}" for name, v in row.items()]
        table.add_row(str(parameter), *shown)
    return table
