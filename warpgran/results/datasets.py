"""Datasets of a result file, in the part file and the finished one alike: HDF5 with dimension scales.

So h5py, xarray, netCDF4, R and MATLAB read them. All stand in the root of the file. No type is an enum of HDF5, such as
h5py makes of truth values: R leaves out what has one.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import h5py
import numpy as np

from warpgran.arrays import Array
from warpgran.results.layout import Layout
from warpgran.schema import Variable

_HEADER, _TEXT = 4096, 64
"""Most bytes of the header of a dataset with its attributes, and of a word, about."""
OF_SCALES = ("CLASS", "NAME", "DIMENSION_LIST", "REFERENCE_LIST")
"""Attributes by which HDF5 attaches dimension scales."""


def write_shared(file: h5py.File, layout: Layout) -> None:
    """Dimensions, the bed if there is one grid, and the keys in which the runs differ."""
    write_dimensions(file, layout.dimensions())
    for name, (schema, values) in layout.shared().items():
        describe(file.create_dataset(name, data=values), schema)
    for key, (schema, column) in layout.parameters().items():
        truth = column.dtype == bool
        data = file.create_dataset(key, data=column.astype(np.int8) if truth else column)
        describe(data, schema)
        if truth:
            data.attrs["dtype"] = "bool"  # by which xarray knows it


def bytes_of_shared(layout: Layout) -> int:
    """Most bytes that `write_shared` takes, and the headers of all variables."""
    each = [*layout.dimensions().values(), *layout.shared().values(), *layout.parameters().values()]
    numbers = sum(max(values.nbytes, _TEXT * values.size * (values.dtype.kind == "O")) for _, values in each)
    return numbers + _HEADER * (len(each) + len(layout.columns))


def write_dimensions(file: h5py.File, dimensions: Mapping[str, tuple[Variable, Array]]) -> None:
    """Write a dimension scale with its values for each dimension."""
    for name, (schema, values) in dimensions.items():
        data = file.create_dataset(name, data=values)
        data.make_scale(name)
        data.attrs.update(schema.attributes)


def describe(data: h5py.Dataset, schema: Variable, coordinates: Iterable[str] = ()) -> None:
    """Attach units, names and dimension scales to a dataset that is no scale, and name its other coordinates."""
    data.attrs.update(schema.attributes)
    for axis, dim in zip(data.dims, schema.dims, strict=True):
        axis.attach_scale(data.file[dim])
    if named := " ".join(coordinates):
        data.attrs["coordinates"] = named


def describe_as(data: h5py.Dataset, other: h5py.Dataset) -> None:
    """Describe a dataset like the one of that name in another file, and make it a scale or attach its scales."""
    name = other.name.removeprefix("/")
    if other.is_scale:
        data.make_scale(name)
    else:
        for axis, scales in zip(data.dims, other.dims, strict=True):
            axis.attach_scale(data.file[scales[0].name])
    data.attrs.update({name: value for name, value in other.attrs.items() if name not in OF_SCALES})
