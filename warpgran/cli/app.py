"""The application `warpgran`: its commands, and how errors are reported.

Exit status: 0 done, 1 some runs did not finish cleanly or results differ, 2 bad input, 130 interrupted.
"""

from __future__ import annotations

import atexit
import gc
import os
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from warpgran.cli.calibrate import calibrate
from warpgran.cli.check import check
from warpgran.cli.commands import info, merge, summary
from warpgran.cli.compare import compare
from warpgran.cli.converge import converge
from warpgran.cli.pictures import animate, plot
from warpgran.cli.reproduce import reproduce
from warpgran.cli.run import run
from warpgran.cli.run_files import new, schema
from warpgran.cli.sensitivity import sensitivity
from warpgran.cli.terminal import say, tell
from warpgran.cli.verify import verify
from warpgran.cli.view import view
from warpgran.errors import WarpgranError


class Reporting(TyperGroup):
    """Commands whose user errors are reported line by line, exit status 2.

    A user error is a WarpgranError, too little memory, or a file that the system refuses. Anything else is a defect of
    warpgran and keeps its traceback.
    """

    def invoke(self, ctx: typer.Context) -> Any:  # type: ignore[override]
        """Run the command that was asked for."""
        try:
            return super().invoke(ctx)
        except (WarpgranError, MemoryError, OSError) as error:
            by_user = isinstance(error, WarpgranError | MemoryError) or error.filename
            if ctx.params["debug"] or not by_user:
                raise
            said = str(error)
            if isinstance(error, OSError) and not isinstance(error, WarpgranError):
                said = f"cannot use {error.filename}: {error.strerror}"
            for line in (said or "out of memory").split("\n"):
                tell(line)
            raise typer.Exit(2) from None


app = typer.Typer(
    name="warpgran",
    cls=Reporting,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)


def _print_version(asked: bool) -> None:
    if asked:
        from importlib.metadata import version

        say(f"warpgran {version('warpgran')}")
        raise typer.Exit


@app.callback()
def options(
    debug: Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")] = False,
    version: Annotated[
        bool, typer.Option("--version", help="Print the version and exit.", is_eager=True, callback=_print_version)
    ] = False,
) -> None:
    """Granular collapses with dilatancy: a depth-averaged compressible mu(I) model."""


for command in (
    new, run, check, info, plot, animate, view, summary, compare, merge, converge, sensitivity, calibrate, verify,
    reproduce, schema,
):  # fmt: skip
    app.command()(command)


def main() -> None:
    """Entry point of the `warpgran` command."""
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")  # which it looks for in every installed package
    gc.set_threshold(100_000)  # what imports make is no garbage, and looking for some takes a tenth of a run
    atexit.register(gc.freeze)  # or Python's last act is to look for garbage in all modules, which takes 0.2 s
    app()
