"""Headings of figures: the title of the case and its main facts."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Sequence

import numpy as np

from warpgran.analysis.caveats import caveats
from warpgran.analysis.run_columns import RunColumns
from warpgran.figures.names import named, shown
from warpgran.figures.selection import OneRun
from warpgran.printable import printable
from warpgran.schema import CLEAN

MAIN_KEYS = ("slope.angle", "column.phi", "rheology.K")
RESERVES = {"left_grid": "left the grid: its run-out is a lower bound", "moving": "still moving at the end"}
"""Words of the caveats of one run."""
MARKUP = re.compile(r"\\[a-z]+|[${}_^]")  # what takes no room in a line


def run_heading(one: OneRun, width: int = 95) -> str:
    """Title of the case, its main parameters, what else varies between the runs, and how the run ended."""
    varied = {name: values.item() for name, values in one.columns.swept.items() if name not in MAIN_KEYS}
    facts = main_facts(one.columns)
    facts += [f"{name} = {shown(value).strip('$')}" for name, value in varied.items()]
    if one.runs > 1:
        facts.append(f"run {one.place} (0 to {one.runs - 1})")
    return heading(one.columns, [*facts, *reserves(one)], width)


def reserves(one: OneRun) -> list[str]:
    """What the results of a run must not be read without: that it ended early, lost solid or had not stopped."""
    if one.status == "pending":
        return ["still to be computed"]
    if one.status == "interrupted":
        return [f"interrupted at $t$ = {one.columns.values['end_time'].item():.3g} s"]
    found = caveats(one.columns)
    said = [words for name, words in RESERVES.items() if found[name].item()]
    return said if one.status in CLEAN else [f"ended early: {one.status}", *said]


def main_facts(data: RunColumns) -> list[str]:
    """The main parameters that the result has, each where it is the same in all runs."""
    values = {key: data.parameter(key, np.nan) for key in MAIN_KEYS}
    return [named(key).value(float(v.item())) for key, v in values.items() if v.size == 1 and np.isfinite(v.item())]


def heading(data: RunColumns, facts: Sequence[str], width: int = 95) -> str:
    """Title of the case, then facts, in lines of about `width` characters."""
    title = " / ".join(dict.fromkeys(data.parameter("title", "").ravel().tolist()))
    title = printable(title).replace("$", r"\$")  # plain text, and no formula
    lines = [""]
    for fact in facts:
        longer = f"{lines[-1]}, {fact}".removeprefix(", ")
        if lines[-1] and len(MARKUP.sub("", longer)) > width:
            lines[-1] += ","
            lines.append(fact)
        else:
            lines[-1] = longer
    return "\n".join([*textwrap.wrap(title, width), *lines])
