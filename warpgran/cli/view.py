"""The command `warpgran view`, and the page of `warpgran run --view`."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import Annotated

import typer

from warpgran.cli.arguments import Picture, bytes_of, numbers_of
from warpgran.cli.pictures import beside
from warpgran.cli.report import print_caveats
from warpgran.cli.terminal import say
from warpgran.errors import OptionError


def view(
    files: Annotated[list[Path], typer.Argument(metavar="OUT.h5...", help="Result files.")],
    output: Picture = None,
    open_: Annotated[bool, typer.Option("--open", help="Open the page in the browser.")] = False,
    runs: Annotated[
        str | None, typer.Option(metavar="NUMBERS", help="Runs of each file, as 0,5,10-19; default: what fits.")
    ] = None,
    max_size: Annotated[str, typer.Option(metavar="SIZE", help="Largest page, as 5MB.")] = "20MB",
) -> None:
    """Write a page to look at results in a browser, offline: time, profiles, series, and the runs of a batch."""
    from warpgran.results.reading import open_dataset
    from warpgran.viewer.page import view

    size, chosen = bytes_of(max_size, "max-size") or 0.0, numbers_of(runs, "runs")
    if repeated := [str(file) for place, file in enumerate(files) if file in files[:place]]:
        raise OptionError(f"{repeated[0]} is named twice")
    with ExitStack() as stack:
        results = {file: stack.enter_context(open_dataset(file)) for file in files}
        same = len({file.name for file in files}) < len(files)
        named = {str(file) if same else file.name: data for file, data in results.items()}
        made = view(named, output or files[0].with_suffix(".html"), runs=chosen, max_size=size)
        for name, data in named.items():
            print_caveats(data, of=name if len(named) > 1 else "")
    say(f"wrote {made}, {made.stat().st_size / 1e6:.2g} MB")
    if open_:
        import webbrowser

        webbrowser.open(made.resolve().as_uri())


def page_beside(path: Path) -> list[str]:
    """The page of a result that is safe in its file: written beside it, or why not on standard error.

    Returns:
        The path of the page, or nothing.
    """
    from warpgran.results.reading import open_dataset
    from warpgran.viewer.page import view

    made = path.with_suffix(".html")
    with open_dataset(path) as data:
        return beside("page", made, lambda: view({path.name: data}, made))
