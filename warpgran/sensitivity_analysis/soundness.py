"""Runs that must not enter an index, and what is said of them: how many, which, and where in the space."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from warpgran.analysis.caveats import caveats
from warpgran.analysis.runs import status_words
from warpgran.arrays import Array
from warpgran.errors import ResultError
from warpgran.schema import CLEAN
from warpgran.sensitivity_analysis.design import Design
from warpgran.sensitivity_analysis.outputs import Output

FINAL = ("run_out", "h_max_final", "stop_time")
"""Results that a run has only once it has stopped."""
NAMED = 8
"""Most runs that a line names."""
NARROW = 0.9
"""A parameter tells where runs lie if they span less than this share of its range."""
LEAST = 8
"""Fewest base samples, or trajectories, that may be left."""


def flaws(data: xr.Dataset, outputs: Sequence[Output]) -> dict[str, Array]:
    """The runs that cannot be used, by the reason in words; a run counts for the first of its reasons.

    Args:
        data: A result with a dimension `run`.
        outputs: What is asked for. That a run has not stopped matters to some of them alone.
    """
    names = {output.name for output in outputs}
    words, warned = status_words(data), caveats(data)
    found = {f"ended as {word}": words == word for word in dict.fromkeys(words) if word not in CLEAN}
    found["lost solid through an end of the grid (make it longer)"] = warned["left_grid"]
    if names & {*FINAL}:
        advice = "make time.end later, or ask for a series at a time, such as front@0.5"
        found[f"had not stopped: no {_either(sorted(names & {*FINAL}))} yet ({advice})"] = warned["moving"]
    for output in outputs:
        known = np.isfinite(output.values)
        reason = f"gave no {output.words}" + (" at some time" if output.times is not None else "")
        found[reason] = ~(known if known.ndim == 1 else known.all(axis=1))
    counted = np.zeros(data.sizes["run"], dtype=bool)
    for reason, which in found.items():
        found[reason] = which & ~counted
        counted |= which
    return {reason: which for reason, which in found.items() if which.any()}


def kept(design: Design, data: xr.Dataset, outputs: Sequence[Output], drop_failed: bool) -> tuple[Array, list[str]]:
    """The base samples whose runs can all be used, and what is to be said of the others.

    Args:
        design: Of the runs.
        data: The runs.
        outputs: What is asked for.
        drop_failed: Leave out the base samples of runs that cannot be used, instead of refusing.

    Returns:
        Which samples are kept, shape (samples,), and lines.

    Raises:
        ResultError: Runs cannot be used, and are not to be left out; or too few would be left.
    """
    found = flaws(data, outputs)
    flawed = design.by_sample(sum(found.values(), np.zeros(data.sizes["run"], dtype=bool)))
    good = np.asarray(~flawed.any(axis=1))
    if good.all():
        return good, []
    word = "base samples" if design.section.method == "sobol" else "trajectories"
    lost = int((~good).sum())
    share = f"{lost} of {good.size} {word} ({lost / good.size:.1%})"
    lines = [_line(design, reason, which) for reason, which in found.items()]
    if not drop_failed:
        first = f"{int(flawed.sum())} of {flawed.size} runs cannot be used, which concerns {share}:"
        last = "change what is asked, or leave these samples out with --drop-failed: the indices are then of the rest"
        raise ResultError("\n".join([first, *lines, last]))
    if good.sum() < LEAST:
        raise ResultError("\n".join([*lines, f"without them {good.size - lost} {word} are left; allowed: >= {LEAST}"]))
    return good, [f"left out {share}: the indices are those of the parameters that remain", *lines]


def _line(design: Design, reason: str, which: Array) -> str:
    """`7 runs ended as diverged: 3, 8, ...; slope.angle 23 to 24.9 of 10 to 25`."""
    runs = np.flatnonzero(which).tolist()
    numbers = ", ".join(map(str, runs[:NAMED])) + (f" and {len(runs) - NAMED} more" if len(runs) > NAMED else "")
    count = "1 run" if len(runs) == 1 else f"{len(runs)} runs"
    return f"{count} {reason}: {numbers}; {where(design, which)}"


def where(design: Design, which: Array) -> str:
    """Where in the space some runs lie: the parameters whose values they share, the narrowest first."""
    values = design.values.reshape(which.size, -1)
    low, high = values.min(axis=0), values.max(axis=0)
    least, most = values[which].min(axis=0), values[which].max(axis=0)
    span = (most - least) / np.where(high > low, high - low, 1.0)
    said = [
        f"{design.keys[i]} {least[i]:.3g} to {most[i]:.3g} of {low[i]:.3g} to {high[i]:.3g}"
        for i in np.argsort(span).tolist()
        if span[i] < NARROW
    ]
    return ", ".join(said[:3]) or "all over the space"


def _either(names: Sequence[str]) -> str:
    return " or ".join(names)
