"""Granular collapses with dilatancy: a depth-averaged compressible mu(I) model on NVIDIA Warp.

From a case to its terms of force::

    import warpgran as wg

    case = wg.Case.from_toml("runs/dense_22deg.toml").with_(slope={"angle": 16.0})
    data = wg.simulate(case)                          # an xarray.Dataset
    data = wg.open_dataset("dense_22deg.h5")          # the same, of a file of `warpgran run`
    data = data.assign(wg.derive(data, "psi", "mu"))  # with dilatancy angle and friction
    terms = wg.forces(data)                           # the terms of the momentum equation
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from warpgran.analysis.caveats import caveats as caveats
    from warpgran.analysis.comparison import compare as compare
    from warpgran.analysis.fields import derive as derive
    from warpgran.analysis.forces import forces as forces
    from warpgran.analysis.runs import with_keys as with_keys
    from warpgran.analysis.summary import summary as summary
    from warpgran.calibration.calibrate import calibrate as calibrate
    from warpgran.case.case import Case as Case
    from warpgran.case.problems import CaseError as CaseError
    from warpgran.case.read_study import read_study as read_study
    from warpgran.case.study import Study as Study
    from warpgran.case.tables import TableError as TableError
    from warpgran.errors import CaveatWarning as CaveatWarning
    from warpgran.errors import OptionError as OptionError
    from warpgran.errors import ResultError as ResultError
    from warpgran.errors import WarpgranError as WarpgranError
    from warpgran.figures.animation import animate as animate
    from warpgran.figures.plot import plot as plot
    from warpgran.files import StorageError as StorageError
    from warpgran.results.reading import open_dataset as open_dataset
    from warpgran.run.cluster import ClusterError as ClusterError
    from warpgran.run.simulate import simulate as simulate
    from warpgran.sensitivity_analysis.indices import indices as indices
    from warpgran.sensitivity_analysis.study import sensitivity as sensitivity
    from warpgran.solve.device import DeviceError as DeviceError
    from warpgran.studies.converge import converge as converge
    from warpgran.viewer.page import view as view

_HOME = {
    "Case": "case.case",
    "CaseError": "case.problems",
    "CaveatWarning": "errors",
    "ClusterError": "run.cluster",
    "DeviceError": "solve.device",
    "OptionError": "errors",
    "ResultError": "errors",
    "StorageError": "files",
    "Study": "case.study",
    "TableError": "case.tables",
    "WarpgranError": "errors",
    "animate": "figures.animation",
    "caveats": "analysis.caveats",
    "calibrate": "calibration.calibrate",
    "compare": "analysis.comparison",
    "converge": "studies.converge",
    "derive": "analysis.fields",
    "forces": "analysis.forces",
    "indices": "sensitivity_analysis.indices",
    "open_dataset": "results.reading",
    "plot": "figures.plot",
    "read_study": "case.read_study",
    "sensitivity": "sensitivity_analysis.study",
    "simulate": "run.simulate",
    "summary": "analysis.summary",
    "view": "viewer.page",
    "with_keys": "analysis.runs",
}

__all__ = [*_HOME]


def __getattr__(name: str) -> Any:
    """Import what is asked for when it is asked for, so that `warpgran --help` does not wait for xarray."""
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    return sorted(__all__)
