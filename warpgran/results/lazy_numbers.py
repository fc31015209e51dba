"""Variables of a Dataset whose numbers are read where they are used, and are then what `Numbers` says."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from xarray.backends import BackendArray
from xarray.core import indexing

from warpgran.arrays import Array
from warpgran.results.numbers import Numbers


def judged(variable: xr.Variable, numbers: Numbers) -> xr.Variable:
    """A variable whose numbers are judged where they are read, once, and kept as xarray keeps those of a file."""
    lazy: Any = indexing.LazilyIndexedArray(_Judged(variable, numbers))
    kept = indexing.MemoryCachedArray(indexing.CopyOnWriteArray(lazy))  # type: ignore[no-untyped-call]
    return xr.Variable(variable.dims, kept, variable.attrs, variable.encoding)


class _Judged(BackendArray):
    """The numbers of a variable, as xarray asks for them."""

    def __init__(self, variable: xr.Variable, numbers: Numbers) -> None:
        self._variable, self._numbers = variable, numbers
        self.shape, self.dtype = variable.shape, variable.dtype

    def __getitem__(self, key: indexing.ExplicitIndexer) -> Any:
        return indexing.explicit_indexing_adapter(key, self.shape, indexing.IndexingSupport.OUTER, self._read)

    def _read(self, key: tuple[Any, ...]) -> Array:
        return self._numbers.read(lambda: np.asarray(self._variable[key].values), key[0])
