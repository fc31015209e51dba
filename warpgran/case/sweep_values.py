"""The values that a `[sweep]` section asks for: combinations of lists, samples of ranges, or a CSV file of runs."""

from __future__ import annotations

import csv
import math
from array import array
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from warpgran.arrays import Array
from warpgran.case.problems import CaseError, Problem
from warpgran.case.sweep_section import KINDS, MOST_RUNS, SAMPLED, Range, Sweep, key_problem
from warpgran.case.tables import TableError, lines_of

_MOST_MESSAGES = 5


def values_by_run(sweep: Sweep, folder: Path) -> Mapping[str, Sequence[Any]]:
    """Values of every swept key, by run. What is no number in a CSV file stays text, and is refused with its run.

    Args:
        sweep: A valid section.
        folder: What a relative path in it starts from.

    Raises:
        CaseError: The CSV file cannot be used.
    """
    if sweep.from_ is not None:
        return _read_samples(folder / sweep.from_)
    if sweep.mode in SAMPLED:
        return _sampled(sweep)
    lists = {key: values for key, values in (sweep.over or {}).items() if isinstance(values, list)}
    return lists if sweep.mode == "zip" else _product(lists)


def _product(lists: Mapping[str, list[Any]]) -> dict[str, Sequence[Any]]:
    """Every combination, the last key fastest."""
    columns: dict[str, Sequence[Any]] = {}
    before, after = 1, math.prod(len(values) for values in lists.values())
    for key, values in lists.items():
        after //= len(values)
        columns[key] = [value for _ in range(before) for value in values for _ in range(after)]
        before *= len(values)
    return columns


def _sampled(sweep: Sweep) -> dict[str, Sequence[Any]]:
    """Latin hypercube or scrambled Sobol points in the ranges."""
    from scipy.stats import qmc

    ranges = {key: values for key, values in (sweep.over or {}).items() if isinstance(values, Range)}
    engine = {"latin": qmc.LatinHypercube, "sobol": qmc.Sobol}[sweep.mode]
    points = engine(len(ranges), seed=np.random.default_rng(sweep.seed)).random(sweep.samples)
    return {
        key: [round(value) for value in _scaled(u, values)] if KINDS[key] is int else array("d", _scaled(u, values))
        for (key, values), u in zip(ranges.items(), points.T, strict=True)
    }


def _scaled(u: Array, values: Range) -> list[float]:
    """Points u in [0, 1) as values of the range."""
    low, high = values.low, values.high
    scaled = np.exp((1 - u) * math.log(low) + u * math.log(high)) if values.log else (1 - u) * low + u * high
    return np.clip(scaled, low, high).tolist()


def _read_samples(path: Path) -> dict[str, Sequence[Any]]:
    """Values by run from a CSV file: a header of dotted keys, then a row a run. Empty lines and `#` are ignored.

    Raises:
        CaseError: The file cannot be used.
    """
    try:
        lines = lines_of(path)
    except TableError as error:
        raise _unusable(error.messages) from None
    if len(lines) < 2:
        raise _unusable([f"{path}: has no runs; allowed: a header of dotted keys and a row a run"])
    if len(lines) - 1 > MOST_RUNS:
        raise _unusable([f"{path}: has {len(lines) - 1} runs; allowed: {MOST_RUNS}"])
    try:
        (number, header), *rows = [(n, [cell.strip() for cell in next(csv.reader([line]))]) for n, line in lines]
    except csv.Error as error:
        raise _unusable([f"{path}: is not a CSV file: {error}"]) from None
    messages = [f"{path}:{number}: {problem}" for key in header if (problem := key_problem(key))]
    messages += [f"{path}:{number}: {key}: is given twice" for key in dict.fromkeys(header) if header.count(key) > 1]
    messages += [
        f"{path}:{n}: has {len(row)} values; allowed: {len(header)}" for n, row in rows if len(row) != len(header)
    ]
    if messages:
        raise _unusable(messages)
    return {key: [_CELLS[KINDS[key]](row[i]) for _, row in rows] for i, key in enumerate(header)}


def _unusable(messages: list[str]) -> CaseError:
    more = len(messages) - _MOST_MESSAGES
    shown = messages[:_MOST_MESSAGES] + ([f"and {more} more of this table"] if more > 0 else [])
    return CaseError([Problem("sweep.from", message) for message in shown])


def _real(cell: str) -> float | str:
    """A number, or the text if it is none."""
    try:
        return cell if "_" in cell else float(cell)  # float() takes 1_000
    except ValueError:
        return cell


def _whole(cell: str) -> float | str:
    """A whole number, also one that a program has written as 4e2."""
    value = _real(cell)
    return int(value) if isinstance(value, float) and value.is_integer() else value


def _truth(cell: str) -> bool | str:
    return {"true": True, "false": False}.get(cell.lower(), cell)


_CELLS: dict[type, Callable[[str], Any]] = {float: _real, int: _whole, str: str, bool: _truth}
