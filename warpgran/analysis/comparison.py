"""Two results against each other: in which parameters they differ, and where and when their runs differ most."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from warpgran.analysis.differences import (
    Grids,
    Largest,
    Pairs,
    Parameters,
    common_times,
    of_fields,
    of_series,
    of_values,
)
from warpgran.analysis.runs import status_words, swept
from warpgran.arrays import Array
from warpgran.case.defaults import FOLLOWS
from warpgran.errors import ResultError

FACTS = ("warpgran_version", "warp_version", "numpy_version", "python_version", "engine", "precision", "device")
"""Attributes that say with what a result was computed."""
NAMED = 3
"""Runs with the largest difference that are named."""


@dataclass(frozen=True)
class Compared:
    """Two results against each other.

    Attributes:
        identical: Whether they have the same runs on the same grids at the same times, and in all of them the same
            results bit for bit. Neither parameters nor versions count.
        parameters: A row a key of the run file that differs, with its value in a and in b, or how many it has.
        facts: A row a version, engine, precision or device that differs.
        runs: A row a pair of runs: run_a, run_b, the keys by whose values they were matched, status_a, status_b, and
            whether they are identical.
        differences: A row a quantity of a pair of runs; the columns are those of `Largest`. h is compared in all cells,
            v and phi where the compacted thickness exceeds scheme.h_front in both.
        notes: What is to be known of how they were compared, in lines without a full stop.
    """

    identical: bool
    parameters: pd.DataFrame
    facts: pd.DataFrame
    runs: pd.DataFrame
    differences: pd.DataFrame
    notes: tuple[str, ...]

    def over_runs(self) -> pd.DataFrame:
        """A row a quantity: the median and the largest amount of its difference over the pairs of runs.

        Returns:
            median, largest; runs, the numbers in a of those with the largest, the largest first; and a, b, difference,
            time and x of the largest; NaN and no runs where none can be compared.
        """
        found = {}
        for quantity, rows in self.differences.groupby("quantity", sort=False):
            amounts = rows["difference"].abs().dropna()
            first = amounts[amounts > 0.0].nlargest(NAMED)
            at = rows.loc[first.index[0]] if len(first) else rows.iloc[0]
            found[quantity] = {
                "median": amounts.median(),
                "largest": amounts.max(),
                "runs": tuple(rows["run_a"].loc[first.index].tolist()),
                **at[["a", "b", "difference", "time", "x"]].to_dict(),
            }
        return pd.DataFrame.from_dict(found, orient="index")


def compare(a: xr.Dataset, b: xr.Dataset) -> Compared:
    """Compare two results.

    Runs are matched by the values of the keys that were swept in either, where these tell the runs of both apart and
    some are in both; else by their numbers. Series and snapshots are compared at the times that both have. Where the
    grids differ, h, v and phi of the finer are interpolated linearly in x at the cell centres of the coarser.

    Args:
        a: A result, with all its runs or some (`data.isel(run=[0, 3])`).
        b: Another.

    Returns:
        What differs in parameters, versions, runs and numbers; `identical` says whether anything does.

    Raises:
        ResultError: A selection without the dimension `run`, or no run of one has a counterpart in the other.
    """
    if not all("run" in data.dims for data in (a, b)):
        raise ResultError("a comparison needs the dimension `run`: select one run with data.isel(run=[0])")
    of_a, of_b = _parameters(a), _parameters(b)
    keys, pairs = _matched(a, b, of_a, of_b)
    grids = Grids()
    rows = [*of_values(a, b, pairs), *of_series(a, b, pairs), *of_fields(a, b, pairs, (of_a, of_b), grids)]
    differences = pd.DataFrame(rows, columns=Largest._fields)
    runs = _runs(a, b, pairs, {key: of_a[key] for key in keys})
    same = differences.groupby(["run_a", "run_b"], sort=False)["identical"].all().to_numpy()
    runs["identical"] = same & _ended_alike(a, b, pairs)
    alone = a.sizes["run"] - len(pairs), b.sizes["run"] - len(pairs)
    times = [_times(a, b, name) for name in ("time", "series_time")]
    notes = [
        *_of_matching(keys, len(pairs), alone),
        *(note for note, _ in times if note),
        *_of_grids(grids, len(pairs)),
    ]
    return Compared(
        identical=bool(
            runs["identical"].all() and not any(alone) and all(same for _, same in times) and grids == Grids()
        ),
        parameters=_differing(of_a, of_b, pairs),
        facts=_frame({name: (a.attrs.get(name), b.attrs.get(name)) for name in FACTS}),
        runs=runs,
        differences=differences,
        notes=tuple(notes),
    )


def _parameters(data: xr.Dataset) -> dict[str, list[Any]]:
    """Every key of the run file in each run: what the run's own text says, or its coordinate where it was swept."""
    text = data.coords["case_toml"].values if "case_toml" in data.coords else data.attrs.get("case_toml", "")
    texts = np.broadcast_to(text, data.sizes["run"]).tolist()
    flat = {text: _flat(text) for text in dict.fromkeys(texts)}
    values = {
        key: [flat[text].get(key) for text in texts] for key in dict.fromkeys(k for f in flat.values() for k in f)
    }
    for key in swept(data):
        known = values.get(key, [None] * len(texts))
        values[key] = [old if new != new else new for old, new in zip(known, data[key].values.tolist(), strict=True)]
    return values


def _flat(text: str) -> dict[str, Any]:
    """A run file by dotted key; what is no single value as text."""
    flat: dict[str, Any] = {}
    for name, value in tomllib.loads(text).items():
        keys = {f"{name}.{key}": each for key, each in value.items()} if isinstance(value, dict) else {name: value}
        flat |= {key: str(each) if isinstance(each, dict | list) else each for key, each in keys.items()}
    return flat


def _matched(a: xr.Dataset, b: xr.Dataset, of_a: Parameters, of_b: Parameters) -> tuple[list[str], Pairs]:
    """The keys by which runs are matched, none for their numbers, and the places of each pair in a and b."""
    if a.sizes["run"] == b.sizes["run"] == 1:
        return [], [(0, 0)]
    either = list(dict.fromkeys([*swept(a), *swept(b)]))
    keys = [key for key in either if key not in FOLLOWS] or either
    if keys and all(key in of for key in keys for of in (of_a, of_b)):
        values = [list(zip(*(of[key] for key in keys), strict=True)) for of in (of_a, of_b)]
        if all(len(set(each)) == len(each) for each in values) and (pairs := _joined(*values)):
            return keys, pairs
    pairs = _joined(a["run"].values.tolist(), b["run"].values.tolist())
    if not pairs:
        raise ResultError("no run of one result has a counterpart in the other, by its swept values or its number")
    return [], pairs


def _joined(a: Sequence[Any], b: Sequence[Any]) -> Pairs:
    """Places of what is in both."""
    at = {value: j for j, value in enumerate(b)}
    return [(i, at[value]) for i, value in enumerate(a) if value in at]


def _of_matching(keys: list[str], pairs: int, alone: tuple[int, int]) -> Iterator[str]:
    if pairs > 1 or any(alone):
        yield f"{pairs} pairs of runs, matched by {', '.join(keys) if keys else 'number'}"
    for name, count in zip("ab", alone, strict=True):
        if count:
            yield f"{count} runs of {name} have no counterpart"


def _of_grids(grids: Grids, pairs: int) -> Iterator[str]:
    of = f" of {{}} of {pairs} runs" if pairs > 1 else ""
    if grids.differ:
        yield f"the grids{of.format(grids.differ)} differ: h, v and phi are interpolated linearly onto the coarser"
    if grids.beds:
        yield f"the beds{of.format(grids.beds)} differ"


def _differing(of_a: Parameters, of_b: Parameters, pairs: Pairs) -> pd.DataFrame:
    """The keys whose values differ between the runs of a pair, or that have other values in all."""
    found = {}
    for key in dict.fromkeys([*of_a, *of_b]):
        a, b = (of.get(key, [None] * len(next(iter(of.values()), []))) for of in (of_a, of_b))
        if set(a) != set(b):
            found[key] = _value(a), _value(b)
        elif any(a[i] != b[j] for i, j in pairs):
            found[key] = _value(a), f"{_value(b)}, in other runs"
    return _frame(found)


def _value(values: Sequence[Any]) -> Any:
    """The value that all runs have, or how many they have."""
    different = set(values)
    if len(different) == 1:
        return values[0]
    number = all(isinstance(value, int | float) for value in different)
    return f"{len(different)} values" + (f", {min(different):.6g} to {max(different):.6g}" if number else "")


def _frame(values: dict[str, tuple[Any, Any]]) -> pd.DataFrame:
    """A row a name whose two values differ."""
    different = {name: pair for name, pair in values.items() if pair[0] != pair[1]}
    return pd.DataFrame.from_dict(different, orient="index", columns=["a", "b"], dtype=object)


def _runs(a: xr.Dataset, b: xr.Dataset, pairs: Pairs, matched: Parameters) -> pd.DataFrame:
    i, j = np.array(pairs).T
    return pd.DataFrame(
        {
            "run_a": a["run"].values[i],
            "run_b": b["run"].values[j],
            **{key: [values[at] for at in i] for key, values in matched.items()},
            "status_a": status_words(a)[i],
            "status_b": status_words(b)[j],
        }
    )


def _ended_alike(a: xr.Dataset, b: xr.Dataset, pairs: Pairs) -> Array:
    i, j = np.array(pairs).T
    alike = status_words(a)[i] == status_words(b)[j]
    if "failure" in a and "failure" in b:
        alike &= a["failure"].values[i] == b["failure"].values[j]
    return np.asarray(alike)


def _times(a: xr.Dataset, b: xr.Dataset, name: str) -> tuple[str, bool]:
    """What is to be said of times that are not common, and whether all are."""
    common, sizes = common_times(a[name].values, b[name].values)[0].size, (a.sizes[name], b.sizes[name])
    if common == max(sizes):
        return "", True
    what = "snapshots" if name == "time" else "samples"
    return f"{common} {what} at times that both have, of {sizes[0]} in a and {sizes[1]} in b", False
