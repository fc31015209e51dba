"""A study computed into a result file, as `warpgran run` and `warpgran sensitivity` do."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from warpgran.cli.arguments import shard_of
from warpgran.cli.report import warn_of
from warpgran.cli.terminal import study_bar, tell
from warpgran.errors import OptionError

if TYPE_CHECKING:
    from warpgran.arrays import Array
    from warpgran.case.study import Study
    from warpgran.run.options import Options
    from warpgran.run.outcome import Compute, Outcome


def compute_file(
    file: Path,
    study: Study,
    output: Path | None,
    how: Options,
    *,
    resume: bool,
    force: bool,
    shard: str | None,
    cluster: str | None,
    pictures: Sequence[str] = (),
) -> tuple[Path, Outcome]:
    """Compute a study, or a shard of it, into a result file, with a progress bar.

    Args:
        file: The run file.
        study: What it asks for.
        output: The result file; by default the run file's name, in this folder.
        how: How to compute.
        resume: Keep the runs that are done.
        force: Replace what is there.
        shard: "I/N", or None for all runs.
        cluster: Address of a dask scheduler, or None for this machine.
        pictures: Ends of the names of pictures that will be written beside the result, such as ".png".

    Returns:
        The result file, and what the computation reports.
    """
    from warpgran.files import check_ours, check_place
    from warpgran.results.output import result_path
    from warpgran.run.to_file import run_to_file

    warn_of(study)
    runs, infix = shard_of(shard, len(study))
    path = output or Path(f"{file.stem}{infix}.h5")
    if pictures:
        result_path(path, study.inputs)
    for end in pictures:
        check_place(path.with_name(path.stem + end))
        check_ours(path.with_name(path.stem + end))
    if how.engine == "warp":
        from warpgran.solve.device import find_devices, start_quietly

        start_quietly()
        if cluster is None:
            find_devices(how.device)
    with _computing(cluster, how) as compute, study_bar(study, len(runs)) as progress:
        outcome = run_to_file(
            study, path, how, runs=runs, resume=resume, force=force, progress=progress, compute=compute
        )
    return path, outcome


@contextmanager
def _computing(cluster: str | None, how: Options) -> Iterator[Compute]:
    """What computes: the threads of this machine, or the cluster of a scheduler."""
    if cluster is None:
        from warpgran.run import threads

        yield threads.compute
        return
    if how.threads is not None:
        raise OptionError("threads: has no part with --cluster; allowed: --nthreads of dask worker")
    from warpgran.run.cluster import compute, connect, threads_of

    with connect(cluster) as client:
        if not threads_of(client):
            tell(f"{cluster} has no worker yet; waiting for one")
        yield partial(compute, client=client)


def exit_status(words: Array) -> int:
    """0 if all runs ended as they should, 130 if any was interrupted, 1 if any ended otherwise."""
    from warpgran.analysis.run_columns import WAITING
    from warpgran.schema import CLEAN

    found = set(words.tolist())
    if found.intersection(WAITING):
        return 130
    return 0 if found.issubset(CLEAN) else 1
