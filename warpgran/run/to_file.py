"""A study computed into a file: begun, gone on with, or a share of it."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from warpgran.arrays import Array
from warpgran.case.study import Study
from warpgran.files import StorageError
from warpgran.results.layout import Layout
from warpgran.results.part_file import PartFile, copy_done, part_of
from warpgran.results.reading import pending, reading
from warpgran.run.options import Options
from warpgran.run.outcome import Outcome, attributes
from warpgran.run.threads import compute
from warpgran.schema import PARAMETERS, Status

Compute = Callable[..., Outcome]


def run_to_file(
    study: Study,
    path: Path,
    options: Options,
    *,
    runs: list[int] | None = None,
    resume: bool = False,
    progress: Callable[[float], None] = lambda runs: None,
    compute: Compute = compute,
) -> Outcome:
    """Compute a study, or those runs of it, into a result file.

    While it runs the file is `path` with `.part` behind it, a sound HDF5 file at any moment; when all is computed, or
    Ctrl-C is pressed, it takes its final form at `path`.

    Args:
        study: What to compute.
        path: The result file; one that is there already is replaced at the end.
        options: How to compute.
        runs: Numbers of the runs; all by default.
        resume: Go on with what is at `path` or its part file, and compute only what is missing. Where there is
            nothing, begin.
        progress: Told now and then how many runs are done.
        compute: `run.threads.compute`, or what does the same elsewhere.

    Raises:
        StorageError: The file cannot be written, is of another study, or holds runs that would be lost.
    """
    layout = Layout(study, runs)
    facts = layout.attributes(**attributes(options, Outcome()))
    with _open(layout, path, facts, resume) as part:
        try:
            missing = np.flatnonzero(pending(part.status)).tolist()
            outcome = compute(part, options, missing, progress=progress)
        except BaseException:
            if pending(part.status).all():
                part.path.unlink()
            raise
        part.finish(path, attributes(options, outcome))
    return outcome


def bring_up_to_date(
    study: Study,
    path: Path,
    options: Options,
    *,
    progress: Callable[[float], None] = lambda runs: None,
    compute: Compute = compute,
) -> bool:
    """See that `path` holds a study: go on with what is there of it, and compute anew what is of another one.

    A file that was computed from the same values in the same way, to its end, is left as it is.

    Args:
        study: What is to be there.
        path: The result file.
        options: How to compute.
        progress: Told now and then how many runs are done.
        compute: `run.threads.compute`, or what does the same elsewhere.

    Returns:
        Whether it is all there now; False after Ctrl-C, with what was computed kept.

    Raises:
        StorageError: The file cannot be written.
    """
    layout = Layout(study)
    facts = layout.attributes(**attributes(options, Outcome()))
    for found in (path, part_of(path)):
        if found.exists() and _differences(found, layout, facts) != []:
            found.unlink()
    if path.exists() and not part_of(path).exists():
        with reading(path) as file:
            if not pending(file["status"][:]).any():
                return True
    return not run_to_file(study, path, options, resume=True, progress=progress, compute=compute).interrupted


def _open(layout: Layout, path: Path, facts: dict[str, Any], resume: bool) -> PartFile:
    part = part_of(path)
    if part.exists():
        done, of = _done(part)
        if resume:
            _check_same(part, layout, facts)
            return PartFile(part, layout)
        if done:
            raise StorageError(f"{part} holds {done} of {of} runs of an earlier start: use --resume, or remove it")
    file = PartFile(part, layout, facts)
    if resume and path.exists():
        try:
            _check_same(path, layout, facts)
            copy_done(path, file)
        except BaseException:
            file.close()
            part.unlink()
            raise
    return file


def _done(path: Path) -> tuple[int, int]:
    try:
        with reading(path) as file:
            status = file["status"][:]
    except (OSError, KeyError):
        return 0, 0
    return int((~pending(status)).sum()), status.size


def _check_same(path: Path, layout: Layout, facts: dict[str, Any]) -> None:
    """That a file is of the same study, computed in the same way.

    Raises:
        StorageError: It is not; the message says what differs.
    """
    differs = _differences(path, layout, facts)
    if differs is None:
        raise StorageError(f"cannot go on with {path}: it is not a warpgran result")
    if differs:
        raise StorageError(f"cannot go on with {path}: it differs in {', '.join(differs)}")


def _differences(path: Path, layout: Layout, facts: dict[str, Any]) -> list[str] | None:
    """In what a file is of another study, or computed in another way; None if it is no result at all."""
    try:
        with reading(path) as file:
            there = dict(file.attrs)
            columns = {key: file[PARAMETERS][key].asstr()[:] if file[PARAMETERS][key].dtype.kind == "O"
                       else file[PARAMETERS][key][:] for key in file[PARAMETERS]}  # fmt: skip
            runs = file["run"][:]
    except (OSError, KeyError):
        return None
    how = ("precision", "engine", "warpgran_version", "warp_version")
    differs = [
        f"{name} ({there.get(name)} there, {facts[name]} here)" for name in how if there.get(name) != facts[name]
    ]
    if _kind(there.get("device", "")) != _kind(facts["device"]):
        differs.append(f"device ({there.get('device')} there, {facts['device']} here)")
    here = layout.parameters()
    if there.get("identity") != facts["identity"]:
        differs += _differing_keys(str(there.get("case_toml", "")), facts["case_toml"], {*columns, *here})
    differs += [key for key in sorted({*columns, *here}) if not _equal(columns.get(key), here.get(key))]
    if not np.array_equal(runs, layout.runs):
        differs.append(f"the number of runs ({runs.size} there, {layout.runs.size} here)")
    return list(dict.fromkeys(differs))


def _differing_keys(there: str, here: str, swept: set[str]) -> list[str]:
    def flat(text: str) -> dict[str, Any]:
        data = tomllib.loads(text)
        return {f"{s}.{k}": v for s, keys in data.items() if isinstance(keys, dict) for k, v in keys.items()}

    a, b = flat(there), flat(here)
    keys = [key for key in sorted({*a, *b} - swept) if a.get(key) != b.get(key) and key != "scheme.window"]
    return [f"{key} ({a.get(key)} there, {b.get(key)} here)" for key in keys] or ["a table of numbers"]


def _equal(a: Any, b: Any) -> bool:
    return a is not None and b is not None and np.array_equal(np.asarray(a), np.asarray(b))


def _kind(device: str) -> str:
    return str(device).split(",")[0].split(":")[0]


def exit_status(status: Array) -> int:
    """0 if all runs did what they were asked for, 130 if they were interrupted, 1 if some did not end cleanly."""
    found = {Status(int(s)) for s in np.unique(status)}
    if found & {Status.INTERRUPTED, Status.PENDING}:
        return 130
    return 0 if all(s.clean for s in found) else 1
