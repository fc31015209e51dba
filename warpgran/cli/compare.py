"""The command `warpgran compare`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from warpgran.cli.terminal import print_whole, say, tell
from warpgran.printable import printable

if TYPE_CHECKING:
    from rich.table import Table

    from warpgran.analysis.comparison import Compared
    from warpgran.analysis.units import Lengths

THICK = ("h", "h_max", "h_max_final")
ALONG = ("front", "run_out", "x")
PERCENT = ("volume_change", "dilation_max", "outflow", "outflow_final")
LONGEST = 34
"""Characters of a value of the run file."""


def compare(
    a: Annotated[Path, typer.Argument(metavar="A.h5", help="Result file.")],
    b: Annotated[Path, typer.Argument(metavar="B.h5", help="The other.")],
) -> None:
    """Compare two results: parameters, run-out, and where and when h, v and phi differ most.

    Exit status as of cmp and diff: 0 identical results, bit for bit; 1 they differ; 2 they cannot be compared.
    """
    from warpgran.analysis.caveats import messages
    from warpgran.analysis.comparison import compare
    from warpgran.analysis.units import Lengths
    from warpgran.results.reading import open_dataset

    with open_dataset(a) as of_a, open_dataset(b) as of_b:
        compared = compare(of_a, of_b)
        lengths = Lengths.of(of_a, of_b)
        caveats = [f"{file}: {line}" for file, data in ((a, of_a), (b, of_b)) for line in messages(data)]
    for line in caveats:
        tell(line)
    say(f"a: {a}")
    say(f"b: {b}")
    for note in compared.notes:
        say(note)
    _print(parameters_table(compared))
    if compared.identical:
        say("the results are identical, bit for bit")
        return
    if compared.runs["identical"].all():
        say("what could be compared is identical, bit for bit")
        raise typer.Exit(1)
    _print(results_table(compared, lengths))
    _say_what_differs(compared)
    raise typer.Exit(1)


def parameters_table(compared: Compared) -> Table:
    """The keys of the run files that differ, and what else was not the same in the computations."""
    import pandas as pd

    rows = pd.concat([compared.parameters, compared.facts])
    table = _table("parameter" if len(rows) else "the parameters are the same", *(("a", "b") if len(rows) else ()))
    for name, row in rows.iterrows():
        table.add_row(printable(str(name)), _short(row["a"]), _short(row["b"]))
    return table


def results_table(compared: Compared, lengths: Lengths) -> Table:
    """A row a quantity: of one pair of runs its largest difference; of several the median and the largest of them."""
    rows, several = compared.over_runs(), len(compared.runs) > 1
    over = ("median", "largest", "in runs") if several else ("b - a",)
    table = _table("largest difference", "unit", "a", "b", *over, "t (s)", f"x ({_unit('x', lengths)[0]})")
    for name, row in rows.iterrows():
        unit, factor = _unit(str(name), lengths)
        if not several:
            differences = [_number(factor * row["difference"], ".3g")]
        else:
            runs = ", ".join(map(str, row["runs"])) or "-"
            differences = [*(_number(factor * row[each], ".3g") for each in ("median", "largest")), runs]
        places = (row["time"], _unit("x", lengths)[1] * row["x"])
        values = (_number(factor * row[each], ".5g") for each in ("a", "b"))
        table.add_row(str(name), unit, *values, *differences, *(_number(place, ".4g") for place in places))
    return table


def _say_what_differs(compared: Compared) -> None:
    """Lines on the runs beneath the table."""
    runs = compared.runs
    say("")
    say("v and phi are compared where the compacted thickness exceeds h_front in both")
    if len(runs) > 1:
        say("a, b, t and x are of the first of the runs named, with their numbers in a")
        same = int(runs["identical"].sum())
        if same:
            say(f"{same} of {len(runs)} pairs of runs are identical, bit for bit")
    ended = runs[runs["status_a"] != runs["status_b"]]
    if len(ended):
        first = ended.iloc[0]
        said = f"run {first['run_a']} {first['status_a']} in a, {first['status_b']} in b"
        more = f", and {len(ended) - 1} more" if len(ended) > 1 else ""
        say(f"not all ended alike: {said}{more}")


def _print(table: Table) -> None:
    say("")
    print_whole(table)


def _table(first: str, *others: str) -> Table:
    from rich.table import Table

    table = Table(box=None, padding=(0, 2, 0, 0), pad_edge=False, header_style="bold")
    table.add_column(first, no_wrap=True)
    for heading in others:
        table.add_column(heading, justify="left" if heading == "unit" else "right", no_wrap=True)
    return table


def _unit(name: str, lengths: Lengths) -> tuple[str, float]:
    """The unit in which a quantity is printed, and the factor to it from that of the result."""
    from warpgran.analysis.units import unit_of
    from warpgran.schema import FIELDS, PER_RUN, SERIES

    if name in THICK or name in ALONG:
        unit = unit_of(lengths.thick if name in THICK else lengths.along)
        return unit.name, unit.factor
    if name in PERCENT:
        return "%", 100.0
    units = (FIELDS | SERIES | PER_RUN)[name].units
    return {"1": "", "m s-1": "m/s", "m4 s-2": "m4/s2"}.get(units, units), 1.0


def _number(value: float, form: str) -> str:
    return "-" if value != value else format(value, form)


def _short(value: Any) -> str:
    """A value of the run file, cut where it is long; a dash where it has none."""
    text = "-" if value is None or value == "" else f"{value:.6g}" if isinstance(value, float) else str(value)
    return printable(text if len(text) <= LONGEST else text[: LONGEST - 3] + "...")
