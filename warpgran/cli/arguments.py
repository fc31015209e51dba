"""Arguments and options that several commands share, and how their values are read."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from warpgran.errors import OptionError

FileArgument = Annotated[Path, typer.Argument(metavar="FILE", help="Run file, TOML.")]


ResultArgument = Annotated[Path, typer.Argument(metavar="OUT.h5", help="Result file.")]


SetOption = Annotated[
    list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Change a key of the run file; repeatable.")
]


PrecisionOption = Annotated[Literal["float64", "float32"], typer.Option(help="Of the kernels.")]


OutputOption = Annotated[Path | None, typer.Option("-o", "--output", help="File to write; default: beside it.")]


def share_of(shard: str | None, runs: int) -> tuple[list[int], str]:
    """The runs of a share, and what it adds to the file's name."""
    if shard is None:
        return list(range(runs)), ""
    first, _, of = shard.partition("/")
    if not (first.isdigit() and of.isdigit() and 1 <= int(first) <= int(of) <= runs):
        raise OptionError(
            f"shard: {shard!r} is not a share; allowed: I/N with 1 <= I <= N <= {runs}, the number of runs"
        )
    return list(range(int(first) - 1, runs, int(of))), f".{int(first)}-of-{int(of)}"


def bytes_of(text: str | None) -> float | None:
    """A size such as 500MB, 4GB or 1.5GiB in bytes."""
    if text is None:
        return None
    number = text.rstrip("BbIi").rstrip()
    unit = {"K": 3, "M": 6, "G": 9, "T": 12}.get(number[-1:].upper(), 0)
    try:
        return float(number[:-1] if unit else number) * 10.0**unit
    except ValueError:
        raise OptionError(f"memory: {text!r} is not a size; allowed: a number of bytes, or as 500MB, 4GB") from None
