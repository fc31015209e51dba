"""`wg.simulate`: cases in, a labelled dataset out."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from contextlib import AbstractContextManager, nullcontext
from functools import partial
from typing import TYPE_CHECKING

from warpgran.analysis.caveats import messages
from warpgran.case.case import Case
from warpgran.case.study import Study
from warpgran.case.unlikely import unlikely
from warpgran.errors import CaveatWarning
from warpgran.results.in_memory import MemoryResults
from warpgran.results.layout import Layout
from warpgran.run import threads as on_threads
from warpgran.run.options import EngineName, Options, Precision
from warpgran.run.outcome import Compute, attributes
from warpgran.run.progress import bar_of, no_bar

if TYPE_CHECKING:
    import xarray as xr
    from distributed import Client


def simulate(
    cases: Case | Sequence[Case],
    *,
    device: str = "cpu",
    precision: Precision = "float64",
    engine: EngineName = "warp",
    threads: int | None = None,
    memory: float | None = None,
    progress: bool = False,
    client: Client | None = None,
) -> xr.Dataset:
    """Compute one case, a sweep of cases, or any batch of them.

    Args:
        cases: Those of a batch share time.end, time.snapshots and time.series; all else may differ.
        device: "cpu", "cuda", "cuda:N", or several GPUs with commas between, which share the runs.
        precision: "float64" or "float32".
        engine: "warp", or "numpy" for the reference implementation.
        threads: Blocks of runs computed at once; all cores by default. A GPU has one.
        memory: Bytes for the runs computed at once; a quarter of the machine's, or of the GPUs', by default.
        progress: Whether to show a bar on standard error, or in the notebook. Nothing else is printed, and Warp, which
            says what it compiles and loads, is quiet meanwhile.
        client: Client of a dask cluster, whose workers compute instead of this machine; threads then has no part.

    Returns:
        Thickness, velocity and volume fraction (run, time, x) and the series (run, series_time), in SI units with their
        names; `status` says how each run ended. What was not computed is NaN.

    Warns:
        CaveatWarning: A value is unlikely (`warpgran check` says the same), the result holds with a reserve (see
            `wg.caveats`), or a run did not end cleanly. `warnings.simplefilter("ignore", wg.CaveatWarning)` silences
            it.

    Raises:
        OptionError: No such precision or engine, or a number that is out of range.
        DeviceError: No such device.
        CaseError: The output times differ.
        ClusterError: A block failed on a worker, or the scheduler is gone.
        KeyboardInterrupt: Ctrl-C.
    """
    study = Study.of([cases] if isinstance(cases, Case) else cases)
    _warn(unlikely(study))
    data = simulate_quietly(
        study, device=device, precision=precision, engine=engine, threads=threads, memory=memory, progress=progress,
        client=client,
    )  # fmt: skip
    _warn(messages(data))
    return data


def simulate_quietly(
    cases: Case | Sequence[Case],
    *,
    device: str = "cpu",
    precision: Precision = "float64",
    engine: EngineName = "warp",
    threads: int | None = None,
    memory: float | None = None,
    progress: bool = False,
    client: Client | None = None,
) -> xr.Dataset:
    """What `simulate` computes, without its warnings: for callers that judge the result themselves."""
    study = Study.of([cases] if isinstance(cases, Case) else cases)
    options = Options(device, precision, engine, threads, memory)
    compute: Compute = on_threads.compute
    quiet: AbstractContextManager[None] = nullcontext()
    if client is not None:
        from warpgran.run import cluster

        compute = partial(cluster.compute, client=client)
    elif engine == "warp":
        from warpgran.solve.device import quietly

        quiet = quietly()
    sink = MemoryResults(Layout(study))
    with quiet, (bar_of if progress else no_bar)(study, len(study)) as show:
        outcome = compute(sink, options, range(len(study)), show)
    if outcome.interrupted:
        raise KeyboardInterrupt
    return sink.to_dataset(**attributes(options, outcome))


def _warn(lines: Sequence[str]) -> None:
    for line in lines:
        warnings.warn(line, CaveatWarning, stacklevel=3)
