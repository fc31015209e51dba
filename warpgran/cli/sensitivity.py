"""The command `warpgran sensitivity`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from warpgran.cli.arguments import (
    Cluster,
    Devices,
    Engine,
    Force,
    Memory,
    OutputFile,
    Precision,
    Resume,
    Set,
    Shard,
    Threads,
    bytes_of,
)
from warpgran.cli.computing import compute_file, exit_status
from warpgran.cli.report import print_speed
from warpgran.cli.terminal import print_whole, read, say, tell
from warpgran.errors import OptionError

if TYPE_CHECKING:
    import xarray as xr
    from rich.table import Table

    from warpgran.run.outcome import Outcome

RESULTS = (".h5", ".hdf5", ".nc")
"""Suffixes of result files; any other file is a run file."""


def sensitivity(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help="Run file with a section \\[sensitivity], or its result file, .h5.")
    ],
    output: OutputFile = None,
    of: Annotated[
        list[str] | None,
        typer.Option("--of", metavar="RESULT,...", help="Ask about these: run_out, front, h_max@0.5, ...; repeatable."),
    ] = None,
    drop_failed: Annotated[
        bool, typer.Option("--drop-failed", help="Leave out the samples of runs that cannot be used.")
    ] = False,
    device: Devices = "cpu",
    precision: Precision = "float64",
    engine: Engine = "warp",
    set_: Set = None,
    threads: Threads = None,
    memory: Memory = None,
    resume: Resume = False,
    force: Force = False,
    shard: Shard = None,
    cluster: Cluster = None,
    format_: Annotated[Literal["png", "pdf", "svg"], typer.Option("--format", help="Of the pictures.")] = "png",
    picture: Annotated[bool, typer.Option("--picture/--no-picture", help="Draw the indices.")] = True,
) -> None:
    """Say which parameters matter: compute the design of a run file, or read its result; indices, tables, pictures."""
    from warpgran.results.reading import open_dataset
    from warpgran.sensitivity_analysis.indices import checked_of, indices
    from warpgran.sensitivity_analysis.table import write_dataset, write_table

    asked = None if of is None else checked_of(of)
    path = file
    if file.suffix.lower() in RESULTS:
        computing = {
            "--set": set_, "--resume": resume, "--force": force, "--shard": shard, "--cluster": cluster,
            "--output": output, "--threads": threads, "--memory": memory, "--device": device != "cpu",
            "--precision": precision != "float64", "--engine": engine != "warp",
        }  # fmt: skip
        for name in (name for name, value in computing.items() if value):
            raise OptionError(f"{name}: has no part with a result file, which is read and not computed")
    else:
        from warpgran.run.options import Options
        from warpgran.sensitivity_analysis.pictures import NAMES

        how = Options(device=device, precision=precision, engine=engine, threads=threads, memory=bytes_of(memory))
        study = read(file, set_)
        if not study.design:
            raise OptionError(f"{file}: has no section [sensitivity]; allowed: a run file that has, or its result file")
        ends = [f"_{name}.{format_}" for name in NAMES] if picture and not shard else []
        path, outcome = compute_file(
            file, study, output, how, resume=resume, force=force, shard=shard, cluster=cluster, pictures=ends
        )
        _report(path, outcome, shard)
    with open_dataset(path) as data:
        found = indices(data, asked, drop_failed=drop_failed)
    for line in found.attrs["notes"].splitlines():
        tell(line)
    if found.attrs.get("title"):
        say(found.attrs["title"])
    print_whole(_table(found))
    stem = path.with_suffix("")
    tables = stem.with_name(f"{stem.name}_indices")
    written = [write_dataset(found, tables.with_suffix(".nc")), write_table(found, tables.with_suffix(".csv"))]
    if picture:
        from warpgran.sensitivity_analysis.pictures import draw

        written += draw(found, stem, f".{format_}")
    *names, last = map(str, written)
    say(f"wrote {', '.join(names)} and {last}")


def _report(path: Path, outcome: Outcome, shard: str | None) -> None:
    """Say what was computed; a shard and an interrupted study end the command here."""
    from warpgran.analysis.runs import status_words
    from warpgran.results.reading import open_dataset

    with open_dataset(path) as data:
        status = 130 if outcome.interrupted else exit_status(status_words(data))
    print_speed(outcome)
    if status == 130:
        tell("interrupted; go on with --resume")
    say(f"wrote {path}" + ("; merge all shards, then ask for the indices of what that writes" if shard else ""))
    if shard or status == 130:
        raise typer.Exit(status)


def _table(found: xr.Dataset) -> Table:
    """Indices with their intervals, a block of rows for each output."""
    from rich.table import Table
    from rich.text import Text

    from warpgran.sensitivity_analysis.table import shown_rows

    sobol = found.attrs["method"] == "sobol"
    grid = Table(box=None, padding=(0, 2, 0, 0), pad_edge=False, header_style="bold")
    headings = ("first order", "total", "interactions") if sobol else ("mu*", "mu", "sigma")
    for name, justify in (("output", "left"), ("parameter", "left"), ("distribution", "left")):
        grid.add_column(name, justify=justify, no_wrap=True)  # type: ignore[arg-type]
    for name in headings:
        grid.add_column(name, justify="right", no_wrap=True)
    laws = dict(zip(found["parameter"].values.tolist(), found["distribution"].values.tolist(), strict=True))
    rows = shown_rows(found)
    for _, block in rows.groupby(["output", "time"], sort=False, dropna=False):
        for n, row in enumerate(block.to_dict("records")):
            cells = _name(row, n), row["parameter"], laws[row["parameter"]], *_cells(row, sobol)
            grid.add_row(*map(Text, cells))  # brackets are no markup
    kind = "base samples" if sobol else "trajectories"
    grid.caption = Text(f"{found.attrs['samples']} {kind}, {found.attrs['runs']} runs; in brackets 95 % intervals")
    grid.caption_justify = "left"
    return grid


def _name(row: dict[Any, Any], n: int) -> str:
    """The output beside its first parameter, its mean and spread beside the second."""
    if n == 0:
        return str(row["output"]) if row["time"] != row["time"] else f"{row['output']}, {row['time']:.4g} s"
    unit = {"1": "", "m s-1": " m/s"}.get(row["units"], f" {row['units']}")
    return f"  {row['mean']:.4g} ± {row['sd']:.2g}{unit}" if n == 1 else ""


def _cells(row: dict[Any, Any], sobol: bool) -> list[str]:
    """The indices of a row."""
    if row["total_order" if sobol else "mu_star"] != row["total_order" if sobol else "mu_star"]:
        return ["-", "-", "-"]
    if not sobol:
        interval = f"{row['mu_star']:.3g} [{row['mu_star_low']:.3g}, {row['mu_star_high']:.3g}]"
        return [interval, f"{row['mu']:.3g}", f"{row['sigma']:.3g}"]
    cells = [
        f"{row[name]:.3f} [{row[f'{name}_low']:.3f}, {row[f'{name}_high']:.3f}]"
        for name in ("first_order", "total_order")
    ]
    return [*cells, f"{row['total_order'] - row['first_order']:.3f}"]
