"""Arguments and options that several commands share, and the parsers of option values."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated, Literal

import typer

from warpgran.errors import OptionError


def _keys(incomplete: str) -> list[tuple[str, str]]:
    """Keys of a run file that begin so, and what they mean: for the completion of `--set`."""
    from warpgran.case.sections import KEYS

    return [(key, known.meaning) for key, known in KEYS.items() if key.startswith(incomplete)]


RunFile = Annotated[Path, typer.Argument(metavar="FILE", help="Run file, TOML.")]
ResultFile = Annotated[Path, typer.Argument(metavar="OUT.h5", help="Result file.")]
Set = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Change a key of the run file; repeatable.", autocompletion=_keys),
]
Device = Annotated[str, typer.Option(help="cpu, cuda or cuda:N.")]
Devices = Annotated[str, typer.Option("--device", help="cpu, cuda, cuda:N, or several: cuda:0,cuda:1.")]
Precision = Annotated[Literal["float64", "float32"], typer.Option(help="Floating-point precision of the kernels.")]
OutputFile = Annotated[
    Path | None,
    typer.Option("-o", "--output", metavar="OUT.h5", help="Default: the run file's name, in this folder."),
]
Engine = Annotated[Literal["warp", "numpy"], typer.Option(help="Kernels, or the NumPy reference.")]
Threads = Annotated[int | None, typer.Option(help="Blocks of runs computed at once; default: all cores.")]
Memory = Annotated[
    str | None,
    typer.Option(metavar="SIZE", help="Memory of the runs computed at once, as 4GB; default: a quarter."),
]
Resume = Annotated[bool, typer.Option("--resume", help="Go on with an earlier start: compute what it left out.")]
Force = Annotated[bool, typer.Option("--force", help="Replace what is there: another result, or an earlier start.")]
Shard = Annotated[
    str | None, typer.Option(metavar="I/N", help="Compute the I-th of N shards; `warpgran merge` joins them.")
]
Cluster = Annotated[
    str | None, typer.Option(metavar="ADDRESS", help="Compute on the workers of a dask scheduler, tcp://HOST:8786.")
]
Picture = Annotated[
    Path | None, typer.Option("-o", "--output", metavar="FILE", help="File to write; default: beside the result.")
]
Folder = Annotated[Path, typer.Option("-o", "--output", metavar="FOLDER", help="Folder to write to.")]


def shard_of(text: str | None, runs: int) -> tuple[list[int], str]:
    """Parse `--shard I/N`.

    Args:
        text: "I/N", or None for all runs.
        runs: Number of runs of the study.

    Returns:
        The runs of the shard, every N-th from I - 1 on, and the infix of its file name, ".I-of-N".

    Raises:
        OptionError: It is not I/N with 1 <= I <= N <= runs.
    """
    if text is None:
        return list(range(runs)), ""
    first, _, of = text.partition("/")
    if not (first.isdecimal() and of.isdecimal() and 1 <= int(first) <= int(of) <= runs):
        raise OptionError(
            f"shard: {text!r} is not a shard; allowed: I/N with 1 <= I <= N <= {runs}, the number of runs"
        )
    return list(range(int(first) - 1, runs, int(of))), f".{int(first)}-of-{int(of)}"


def numbers_of(text: str | None, option: str) -> list[int] | None:
    """Parse numbers and ranges of runs, as "0,5,10-19".

    Raises:
        OptionError: They are none.
    """
    if text is None:
        return None
    found: list[int] = []
    for part in text.split(","):
        ends = re.fullmatch(r"\s*([0-9]{1,9})(?:-([0-9]{1,9}))?\s*", part, re.ASCII)
        first, last = (int(ends[1]), int(ends[2] or ends[1])) if ends else (1, 0)
        if not first <= last < first + 1_000_000:
            raise OptionError(f"{option}: {text!r} are no numbers of runs; allowed: as 0,5,10-19")
        found += range(first, last + 1)
    return found


def bytes_of(text: str | None, option: str = "memory") -> float | None:
    """Parse a size in bytes: "500MB" and "4GB" in powers of 1000, "1.5GiB" and "4Gi" in powers of 1024.

    Raises:
        OptionError: It is not a size.
    """
    if text is None:
        return None
    size = re.fullmatch(r"\s*([0-9.]+(?:e[+-]?[0-9]+)?)\s*(?:([kmgt])(i?))?b?\s*", text, re.IGNORECASE | re.ASCII)
    try:
        if size is None:
            raise ValueError
        number, prefix, binary = size.groups()
        power = " KMGT".index((prefix or " ").upper())
        return float(number) * float(1024 if binary else 1000) ** power
    except ValueError:
        raise OptionError(f"{option}: {text!r} is not a size; allowed: a number of bytes, or as 500MB, 4GiB") from None
