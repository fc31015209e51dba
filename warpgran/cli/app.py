"""The application `warpgran`: its commands, and how errors are reported.

Exit status: 0 done, 1 some runs did not finish cleanly, 2 bad input, 130 interrupted.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Annotated, Any

import typer

from warpgran.cli.commands import check, info, merge, summary
from warpgran.cli.converge import converge
from warpgran.cli.drawn import animate, plot
from warpgran.cli.reproduce import reproduce
from warpgran.cli.run import run
from warpgran.cli.verify import verify
from warpgran.errors import WarpgranError

app = typer.Typer(
    name="warpgran",
    help="Granular collapses with dilatancy: a depth-averaged compressible mu(I) model.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    add_completion=False,
)
_debug = False


def main() -> None:
    """Entry point of the `warpgran` command."""
    app()


@app.callback()
def options(
    debug: Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")] = False,
) -> None:
    """Granular collapses with dilatancy: a depth-averaged compressible mu(I) model."""
    global _debug
    _debug = debug


def reported(command: Callable[..., None]) -> Callable[..., None]:
    """A command that reports what a user can cause in a line each, exit status 2.

    That is a WarpgranError, too little memory, and a file that the system refuses. All else is our fault and keeps its
    traceback.
    """

    @wraps(command)
    def reporting(*args: Any, **kwargs: Any) -> None:
        try:
            command(*args, **kwargs)
        except (WarpgranError, MemoryError, OSError) as error:
            by_user = isinstance(error, WarpgranError | MemoryError) or error.filename
            if _debug or not by_user:
                raise
            for line in str(error).splitlines():
                typer.echo(f"warpgran: {line}", err=True)
            raise typer.Exit(2) from None

    return reporting


for command in (run, check, info, plot, animate, summary, merge, converge, verify, reproduce):
    app.command()(reported(command))
