"""`wg.sensitivity`: which parameters of a case matter, computed and judged at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal

import xarray as xr

from warpgran.case.case import Case
from warpgran.case.read_study import sensitivity_design
from warpgran.run.simulate import simulate
from warpgran.sensitivity_analysis.indices import indices


def sensitivity(
    case: Case,
    over: Mapping[str, Any],
    of: Sequence[str] = ("run_out",),
    *,
    method: Literal["sobol", "morris"] = "sobol",
    samples: int | None = None,
    seed: int = 1,
    drop_failed: bool = False,
    **options: Any,
) -> xr.Dataset:
    """Which parameters of a case matter: compute a design of runs, and its sensitivity indices.

    Args:
        case: What all runs share. Profiles are stored only if its `time.snapshots` asks for them.
        over: Distributions by dotted key: `{"low": a, "high": b}`, with `"scale": "log"` log-uniform, or
            `{"mean": m, "sd": s}`, with `low` and `high` truncated.
        of: What is asked about: `run_out`, `h_max_final`, `dilation_max`, `stop_time`, series (`front`), which are
            resolved in time, and series at a time (`front@0.5`).
        method: sobol, for shares of the variance, or morris, for elementary effects.
        samples: Base samples (default 256) of sobol, a power of 2, or trajectories (32) of morris: n (d + 2) or
            r (d + 1) runs of d parameters.
        seed: Of the samples: the same seed gives the same runs and intervals.
        drop_failed: Leave out the base samples of runs that cannot be used, instead of refusing them.
        options: Those of `simulate`: device, precision, engine, threads, client.

    Returns:
        What `indices` returns of the runs. To keep the runs too, use a run file and `warpgran sensitivity`.

    Raises:
        CaseError: Lists everything that is wrong with the design or with any of its runs.
        ResultError: Runs cannot be used.
    """
    asked: dict[str, Any] = {"of": list(of), "method": method, "seed": seed}
    study = sensitivity_design(case, over, **asked, **({} if samples is None else {"samples": samples}))
    return indices(simulate(study, **options), drop_failed=drop_failed)
