"""Results kept in memory, and as an xarray.Dataset."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from warpgran.arrays import Array
from warpgran.results.layout import Layout, status_attributes
from warpgran.schema import Status

if TYPE_CHECKING:
    import xarray as xr


class MemoryResults:
    """Results kept in memory.

    Attributes:
        layout: Of the result.
        arrays: The columns by name; NaN, and status pending, where a run is not computed yet.
    """

    keeper = None  # nothing is left for a later session

    def __init__(self, layout: Layout) -> None:
        self.layout = layout
        n = layout.runs.size
        self.arrays = {name: _blank((n, *column.shape), column.dtype) for name, column in layout.columns.items()}
        self.arrays["status"][:] = Status.PENDING

    def put(self, at: Sequence[int], rows: Mapping[str, Array]) -> None:
        """Store what `Layout.rows` returns of the runs at these places."""
        for name, array in self.arrays.items():
            array[list(at)] = rows[name]

    def spend(self, cell_steps: int, kernel_seconds: float) -> None:
        """Nothing to note: there are no earlier sessions to add to."""

    def to_dataset(self, **attributes: Any) -> xr.Dataset:
        """The results with units and names; the keys in which runs differ are coordinates of `run`."""
        import xarray as xr

        layout = self.layout
        of_runs = {name: (layout.columns[name].schema, values) for name, values in self.arrays.items()}
        everything = of_runs | layout.shared() | layout.dimensions() | layout.parameters()
        variables: dict[str, Any] = {
            name: xr.Variable(schema.dims, value, schema.attributes) for name, (schema, value) in everything.items()
        }
        variables["failure"] = variables["failure"].astype(str)
        variables["status"].attrs |= status_attributes()
        named = ["x", *layout.dimensions(), *layout.parameters()]
        coordinates: dict[str, Any] = {name: variables.pop(name) for name in dict.fromkeys(named)}
        facts = layout.attributes(**attributes)
        coordinates["case_toml"] = "run", np.full(self.layout.runs.size, facts["case_toml"], dtype=object)
        return xr.Dataset(variables, coordinates, facts)


def _blank(shape: tuple[int, ...], dtype: np.dtype[Any]) -> Array:
    return np.full(shape, np.nan) if dtype.kind == "f" else np.zeros(shape, dtype)
