"""Datasets of a result file, in the part file and the finished one alike: HDF5 with dimension scales.

So h5py, xarray, netCDF4 and MATLAB read them.
"""

from __future__ import annotations

import h5py

from warpgran.results.layout import Layout
from warpgran.schema import PARAMETERS, SERIES, Status, Variable

STATUS_TYPE = h5py.enum_dtype({s.word: int(s) for s in Status}, basetype="i1")


def write_shared(file: h5py.File, layout: Layout) -> None:
    """Dimensions, times, x and bed if there is one grid, and the keys in which the runs differ."""
    for name, values in layout.sizes().items():
        file.create_dataset(name, data=values).make_scale(name)
    shared = layout.shared()
    for name in sorted(shared, key=lambda name: name != "time"):
        schema, times = shared[name]
        data = file.create_dataset(name, data=times)
        if name == "time":
            data.make_scale(name)
        describe(file, name, data, schema)
    group = file.create_group(PARAMETERS)
    for key, column in layout.parameters().items():
        group.create_dataset(key, data=column).dims[0].attach_scale(file["run"])


def describe(file: h5py.File, name: str, data: h5py.Dataset, schema: Variable) -> None:
    """Attach units, long name and dimension scales to a dataset."""
    data.attrs.update(units=schema.units, long_name=schema.long_name)
    for axis, dim in zip(data.dims, schema.dims, strict=True):
        if dim != name:
            axis.attach_scale(file[dim])
    if "cell" in schema.dims and name != "x":
        data.attrs["coordinates"] = "x"


def location(name: str) -> str:
    """Where a variable is in the file."""
    return f"series/{name}" if name in SERIES else name
