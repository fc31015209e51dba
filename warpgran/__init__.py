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
    from warpgran.case import Case
    from warpgran.derived import derive
    from warpgran.errors import CaseError
    from warpgran.momentum import forces
    from warpgran.simulation import simulate
    from warpgran.storage import open_dataset

__all__ = ["Case", "CaseError", "derive", "forces", "open_dataset", "simulate"]

_HOME = {
    "Case": "case",
    "CaseError": "errors",
    "derive": "derived",
    "forces": "momentum",
    "open_dataset": "storage",
    "simulate": "simulation",
}


def __getattr__(name: str) -> Any:
    """Import what is asked for when it is asked for, so that `warpgran --help` does not wait for xarray."""
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
