"""Granular collapses with dilatancy: a depth-averaged compressible mu(I) model on NVIDIA Warp.

import warpgran as wg

case = wg.Case.from_toml("runs/dense_22deg.toml").with_(**{"slope.angle": 16.0})
data = wg.simulate(case)              # an xarray.Dataset
data = wg.open_dataset("out.h5")      # the same, from a file
data = wg.derive(data, "psi", "mu")   # dilatancy angle and friction
data = wg.forces(data)                # what moves and holds the mass
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from warpgran.analysis.fields import derive
    from warpgran.analysis.forces import forces
    from warpgran.analysis.summary import summary
    from warpgran.case.case import Case
    from warpgran.case.problems import CaseError
    from warpgran.case.read_study import read_study
    from warpgran.case.study import Study
    from warpgran.case.tables import TableError
    from warpgran.errors import OptionError, ResultError, WarpgranError
    from warpgran.figures.plot import plot
    from warpgran.files import StorageError
    from warpgran.results.reading import open_dataset
    from warpgran.run.cluster import ClusterError
    from warpgran.run.simulate import simulate
    from warpgran.solve.device import DeviceError
    from warpgran.studies.converge import converge

_HOME = {
    "Case": "case.case",
    "CaseError": "case.problems",
    "ClusterError": "run.cluster",
    "DeviceError": "solve.device",
    "OptionError": "errors",
    "ResultError": "errors",
    "StorageError": "files",
    "Study": "case.study",
    "TableError": "case.tables",
    "WarpgranError": "errors",
    "converge": "studies.converge",
    "derive": "analysis.fields",
    "forces": "analysis.forces",
    "open_dataset": "results.reading",
    "plot": "figures.plot",
    "read_study": "case.read_study",
    "simulate": "run.simulate",
    "summary": "analysis.summary",
}

__all__ = [
    "Case",
    "CaseError",
    "ClusterError",
    "DeviceError",
    "OptionError",
    "ResultError",
    "StorageError",
    "Study",
    "TableError",
    "WarpgranError",
    "converge",
    "derive",
    "forces",
    "open_dataset",
    "plot",
    "read_study",
    "simulate",
    "summary",
]


def __getattr__(name: str) -> Any:
    """Import what is asked for when it is asked for, so that `warpgran --help` does not wait for xarray."""
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOME})
