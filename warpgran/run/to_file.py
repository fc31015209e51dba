"""A study computed into a result file: from the start, resumed, or one shard of it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from warpgran.case.study import Study
from warpgran.errors import OptionError
from warpgran.files import StorageError, check_writable
from warpgran.results.layout import Layout
from warpgran.results.output import result_path
from warpgran.results.part_file import PartFile, check_unlocked, copy_done, part_of
from warpgran.results.reading import pending
from warpgran.run import threads
from warpgran.run.options import Options
from warpgran.run.outcome import Compute, Outcome, Progress, attributes
from warpgran.run.resume import check_replaceable, check_same, differences, done_of


def run_to_file(
    study: Study,
    path: Path,
    options: Options,
    *,
    runs: list[int] | None = None,
    resume: bool = False,
    force: bool = False,
    progress: Progress = lambda runs: None,
    compute: Compute = threads.compute,
) -> Outcome:
    """Compute a study, or some runs of it, into a result file.

    While it runs the file is `path` with `.part` behind it, a sound HDF5 file at any moment; when all is computed, or
    Ctrl-C is pressed, it takes its final form at `path`. A symbolic link at `path` stays; what it leads to is written.

    Args:
        study: What to compute.
        path: The result file. A complete one of the same study, computed in the same way, is computed again and
            replaced at the end, unless Ctrl-C is pressed before.
        options: How to compute.
        runs: Numbers of the runs; all by default.
        resume: Keep the runs that are done at `path` or in its part file, and compute the others. Without either file
            all are computed.
        force: Replace whatever result or file is at `path`, but not one that the study reads.
        progress: Called with the number of runs done.
        compute: `threads.compute`, or another of its kind.

    Raises:
        OptionError: Both to resume and to force.
        StorageError: The file cannot be written, is of another study, or holds runs that would be lost.
    """
    if force and resume:
        raise OptionError("force: begins anew, and resume goes on; allowed: one of them")
    path = result_path(path, study.inputs)
    layout = Layout(study, runs)
    facts = layout.attributes(**attributes(options, Outcome()))
    with _open(layout, path, facts, resume, force) as part:
        was_complete = not resume and not force and path.exists() and path.stat().st_size > 0
        try:
            missing = layout.runs[pending(part.status)].tolist()
            outcome = compute(part, options, missing, progress)
        except BaseException:
            if part.is_empty:
                part.path.unlink()
            raise
        outcome.spoiled = part.spoiled
        if was_complete and pending(part.status).any():
            part.path.unlink()
        else:
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
    path = result_path(path, study.inputs)
    layout = Layout(study)
    facts = layout.attributes(**attributes(options, Outcome()))
    for found in (path, part_of(path)):
        differs = differences(found, layout, facts) if found.exists() else []
        if differs is None:
            raise StorageError(f"cannot write {path}: {found} is damaged, or no result; remove it first")
        if differs:
            found.unlink()
    if not part_of(path).exists():
        done, runs = done_of(path)
        if 0 < runs == done:
            return True
    return not run_to_file(study, path, options, resume=True, progress=progress, compute=compute).interrupted


def _open(layout: Layout, path: Path, facts: dict[str, Any], resume: bool, force: bool) -> PartFile:
    """The part file of `path`: the one that is there, or a new one, into which done runs of `path` are copied.

    Raises:
        StorageError: It cannot be written, is of another study, or holds runs that would be lost.
    """
    part = part_of(path)
    trial = part.with_name(f".{part.name}.new")
    check_writable(path, trial)
    trial.unlink()
    check_unlocked(part)
    if resume and part.exists():
        check_same(part, layout, facts)
        return PartFile(part, layout)
    if not resume and not force:
        check_replaceable(path, part, layout, facts)
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
