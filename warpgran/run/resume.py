"""Whether the runs of a file can be kept, or the file replaced: of which study it is, and how it was computed."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from warpgran.files import StorageError
from warpgran.results.kept_run import kept_until
from warpgran.results.layout import Layout
from warpgran.results.reading import pending, reading
from warpgran.run.options import DECISIVE
from warpgran.schema import is_key

VERSIONS = ("schema_version", "warpgran_version", "warp_version")
"""Attributes of a result on which its form and its bits depend, beside the decisive options."""


def check_same(path: Path, layout: Layout, facts: Mapping[str, Any]) -> None:
    """Check that a file is of the same study, computed in the same way.

    Args:
        path: The file.
        layout: Of the result that is to be computed.
        facts: Its attributes.

    Raises:
        StorageError: It is not; the message says what differs.
    """
    differs = differences(path, layout, facts)
    if differs is None:
        raise StorageError(f"cannot go on with {path}: it is damaged, or no warpgran result; --force starts anew")
    if differs:
        raise StorageError(f"cannot go on with {path}: it differs in {', '.join(differs)}")


def check_replaceable(path: Path, part: Path, layout: Layout, facts: Mapping[str, Any]) -> None:
    """Check that nothing is lost when a study begins anew: a complete file of the same study is computed again.

    Args:
        path: Where the result is to be.
        part: Where it is while it is computed.
        layout: Of the result that is to be computed.
        facts: Its attributes.

    Raises:
        StorageError: Something else is there, or a part of the result.
    """
    for found in (part, path):
        if not found.exists() or found.stat().st_size == 0:
            continue
        differs = differences(found, layout, facts)
        if differs is None:
            raise StorageError(f"cannot write {path}: {found} is damaged, or no result; --force replaces it")
        done, runs = done_of(found)
        with reading(found) as file:
            until = kept_until(file)
        if differs and (done or until is not None or found == path):
            what = f"{found} is of another study, which differs in {', '.join(differs)}"
            raise StorageError(f"cannot write {path}: {what}; --force replaces it")
        if 0 < done < runs:
            raise StorageError(
                f"{found} holds {done} of {runs} runs of an earlier start: --resume computes the others, --force all"
            )
        if found == part and done:
            raise StorageError(f"{found} holds all {runs} runs of an earlier start: --resume finishes it")
        if until is not None:
            raise StorageError(
                f"{found} holds the run of an earlier start until t = {until:.4g} s: --resume goes on from there, "
                "--force begins anew"
            )


def done_of(path: Path) -> tuple[int, int]:
    """Runs of a result that are done, and all runs of it; 0 and 0 where there is none.

    Raises:
        StorageError: It is no result.
    """
    if not path.exists():
        return 0, 0
    with reading(path) as file:
        status = file["status"][:]
    return int((~pending(status)).sum()), status.size


def differences(path: Path, layout: Layout, facts: Mapping[str, Any]) -> list[str] | None:
    """What differs between a file and the result to be computed, in words; None if the file is no result."""
    try:
        with reading(path) as file:
            there = dict(file.attrs)
            columns = {key: file[key].asstr()[:] if file[key].dtype.kind == "O" else file[key][:]
                       for key in file if is_key(key)}  # fmt: skip
            runs = file["run"][:]
    except (OSError, KeyError, StorageError):
        return None
    differs = [name for name in (*DECISIVE, *VERSIONS) if there.get(name) != facts[name]]
    differs += ["device"] if _kind(there.get("device")) != _kind(facts["device"]) else []
    words = [f"{name} ({there.get(name)} there, {facts[name]} here)" for name in differs]
    here = {key: column for key, (_, column) in layout.parameters().items()}
    swept = {*columns, *here}
    if there.get("identity") != facts["identity"]:
        words += _differing_keys(str(there.get("case_toml", "")), facts["case_toml"], swept)
    words += [key for key in sorted(swept) if not _equal(columns.get(key), here.get(key))]
    if not np.array_equal(runs, layout.runs):
        words.append(f"the number of runs ({runs.size} there, {layout.runs.size} here)")
    return list(dict.fromkeys(words))


def _differing_keys(there: str, here: str, swept: set[str]) -> list[str]:
    """The keys in which two run files differ, with both values; those that are swept are compared run by run."""

    def flat(text: str) -> dict[str, Any]:
        data = tomllib.loads(text)
        return {f"{s}.{k}": v for s, keys in data.items() if isinstance(keys, dict) for k, v in keys.items()}

    a, b = flat(there), flat(here)
    keys = [key for key in sorted({*a, *b} - swept) if a.get(key) != b.get(key) and key != "scheme.window"]
    return [f"{key} ({a.get(key)} there, {b.get(key)} here)" for key in keys] or ["a table of numbers"]


def _equal(a: Any, b: Any) -> bool:
    """Whether two columns of swept values are there and alike."""
    return a is not None and b is not None and np.array_equal(np.asarray(a), np.asarray(b))


def _kind(device: Any) -> str:
    """Kind of the devices, "cpu" or "cuda": cuda:0 and cuda:1 give the same bits."""
    return str(device).split(",")[0].split(":")[0]
