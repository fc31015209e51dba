"""`wg.simulate`: cases in, a labelled dataset out."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

from warpgran.case.case import Case
from warpgran.case.study import Study
from warpgran.results.in_memory import MemoryResults
from warpgran.results.layout import Layout
from warpgran.run import threads as on_threads
from warpgran.run.options import EngineName, Options, Precision
from warpgran.run.outcome import Compute, attributes

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
    client: Client | None = None,
) -> xr.Dataset:
    """Compute one case, a sweep of cases, or any batch of them.

    Args:
        cases: Those of a batch share time.end, time.snapshots and time.series; all else may differ.
        device: "cpu", "cuda", "cuda:N", or several GPUs with commas between, which share the runs.
        precision: "float64" or "float32".
        engine: "warp", or "numpy" for the reference implementation.
        threads: Blocks of runs computed at once; all cores by default. A GPU has one.
        client: Client of a dask cluster, whose workers compute instead of this machine; threads then has no part.

    Returns:
        Thickness, velocity and volume fraction (run, time, x) and the series (run, series_time), in SI units with their
        names; `status` says how each run ended. What was not computed is NaN.

    Raises:
        OptionError: No such precision or engine.
        DeviceError: No such device.
        CaseError: The output times differ.
        ClusterError: A block failed on a worker, or the scheduler is gone.
        KeyboardInterrupt: Ctrl-C.
    """
    study = Study.of([cases] if isinstance(cases, Case) else cases)
    options = Options(device, precision, engine, threads)
    compute: Compute = on_threads.compute
    if client is not None:
        from warpgran.run import cluster

        compute = partial(cluster.compute, client=client)
    sink = MemoryResults(Layout(study))
    outcome = compute(sink, options, range(len(study)), lambda runs: None)
    if outcome.interrupted:
        raise KeyboardInterrupt
    return sink.to_dataset(**attributes(options, outcome))
