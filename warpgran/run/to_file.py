"""A study computed into a result file: from the start, resumed, or one shard of it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from warpgran.case.study import Study
from warpgran.files import StorageError
from warpgran.results.layout import Layout
from warpgran.results.part_file import PartFile, copy_done, part_of
from warpgran.results.reading import pending, reading
from warpgran.run import threads
from warpgran.run.options import Options
from warpgran.run.outcome import Compute, Outcome, Progress, attributes
from warpgran.run.resume import check_same, differences


def run_to_file(
    study: Study,
    path: Path,
    options: Options,
    *,
    runs: list[int] | None = None,
    resume: bool = False,
    progress: Progress = lambda runs: None,
    compute: Compute = threads.compute,
) -> Outcome:
    """Compute a study, or some runs of it, into a result file.

    While it runs the file is `path` with `.part` behind it, a sound HDF5 file at any moment; when all is computed, or
    Ctrl-C is pressed, it takes its final form at `path`.

    Args:
        study: What to compute.
        path: The result file; one that is there already is replaced at the end.
        options: How to compute.
        runs: Numbers of the runs; all by default.
        resume: Keep the runs that are done at `path` or in its part file, and compute the others. Without either file
            all are computed.
        progress: Called with the number of runs done.
        compute: `threads.compute`, or another of its kind.

    Raises:
        StorageError: The file cannot be written, is of another study, or holds runs that would be lost.
    """
    layout = Layout(study, runs)
    facts = layout.attributes(**attributes(options, Outcome()))
    with _open(layout, path, facts, resume) as part:
        try:
            missing = layout.runs[pending(part.status)].tolist()
            outcome = compute(part, options, missing, progress)
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
    progress: Progress = lambda runs: None,
    compute: Compute = threads.compute,
) -> bool:
    """Make `path` the result of a study: resume what is there of it, replace what is there of another one.

    A complete file that was computed from the same values in the same way is left as it is.

    Args:
        study: What `path` is to hold.
        path: The result file.
        options: How to compute.
        progress: Called with the number of runs done.
        compute: `threads.compute`, or another of its kind.

    Returns:
        Whether it is complete; False after Ctrl-C, with what was computed kept.

    Raises:
        StorageError: The file cannot be written.
    """
    layout = Layout(study)
    facts = layout.attributes(**attributes(options, Outcome()))
    for found in (path, part_of(path)):
        if found.exists() and differences(found, layout, facts) != []:
            found.unlink()
    if path.exists() and not part_of(path).exists():
        with reading(path) as file:
            if not pending(file["status"][:]).any():
                return True
    return not run_to_file(study, path, options, resume=True, progress=progress, compute=compute).interrupted


def _open(layout: Layout, path: Path, facts: dict[str, Any], resume: bool) -> PartFile:
    """The part file of `path`: the one that is there, or a new one, into which done runs of `path` are copied.

    Raises:
        StorageError: It cannot be written, is of another study, or holds runs that would be lost.
    """
    part = part_of(path)
    if part.exists():
        done, of = _done(part)
        if resume:
            check_same(part, layout, facts)
            return PartFile(part, layout)
        if done:
            raise StorageError(f"{part} holds {done} of {of} runs of an earlier start: use --resume, or remove it")
    file = PartFile(part, layout, facts)
    if resume and path.exists():
        try:
            check_same(path, layout, facts)
            copy_done(path, file)
        except BaseException:
            file.close()
            part.unlink()
            raise
    return file


def _done(path: Path) -> tuple[int, int]:
    """Runs of a file that are done, and all runs of it; 0 and 0 of a file that is no result."""
    try:
        with reading(path) as file:
            status = file["status"][:]
    except (OSError, KeyError):
        return 0, 0
    return int((~pending(status)).sum()), status.size
