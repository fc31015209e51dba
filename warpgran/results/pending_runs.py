"""Runs of a part file that are not computed yet, read as NaN: their places hold no numbers."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from xarray.backends import BackendArray
from xarray.core import indexing

from warpgran.arrays import Array


def without(variable: xr.Variable, waiting: Array) -> xr.Variable:
    """A variable with NaN in some runs, whose numbers are read where they are used as before.

    Args:
        variable: Of floating-point numbers, with a first dimension of runs.
        waiting: The runs, shape (runs,).
    """
    masked = indexing.LazilyIndexedArray(_Masked(variable, waiting))
    return xr.Variable(variable.dims, masked, variable.attrs, variable.encoding)


class _Masked(BackendArray):
    """The numbers of a variable, as xarray asks for them."""

    def __init__(self, variable: xr.Variable, waiting: Array) -> None:
        self._variable, self._waiting = variable, waiting
        self.shape, self.dtype = variable.shape, variable.dtype

    def __getitem__(self, key: indexing.ExplicitIndexer) -> Any:
        return indexing.explicit_indexing_adapter(key, self.shape, indexing.IndexingSupport.OUTER, self._read)

    def _read(self, key: tuple[Any, ...]) -> Array:
        values = np.array(self._variable[key].values)
        values[self._waiting[key[0]]] = np.nan
        return values
