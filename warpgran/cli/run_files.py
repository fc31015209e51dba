"""The commands `warpgran new` and `warpgran schema`: help with writing run files."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from warpgran.cli.terminal import say
from warpgran.errors import OptionError


def new(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="Run file to write, TOML.")],
    full: Annotated[bool, typer.Option("--full", help="Every key, not only those that one changes first.")] = False,
) -> None:
    """Write a commented run file to start from; one that is there is left alone."""
    from warpgran.case.starter import starter
    from warpgran.files import replacing

    if file.exists():
        raise OptionError(f"{file} is there already, and is left as it is; name another file")
    with replacing(file) as part:
        part.write_text(starter(file.name, full=full), encoding="utf-8")
    say(f"wrote {file}; next: warpgran run {file}")


def schema() -> None:
    """Print the JSON schema of run files, for editors that check and complete TOML."""
    from warpgran.case.json_schema import SHIPPED

    for line in SHIPPED.read_text(encoding="utf-8").splitlines():
        say(line)
