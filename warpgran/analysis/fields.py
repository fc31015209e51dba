"""Fields of a Dataset that follow from h, v and phi, over all its runs at once, each with its own parameters."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import xarray as xr

from warpgran.analysis.derived import FIELDS, Profiles
from warpgran.analysis.run_columns import parameter_values
from warpgran.errors import OptionError


def parameter(data: xr.Dataset, key: str, default: Any = None) -> xr.DataArray:
    """What a parameter was in each run.

    A run's value is the coordinate of that name, which swept keys have; where there is none, or it is missing (after
    joining results of different sweeps), what the run's own text says, coordinate case_toml; where there is no such
    coordinate, what the attribute case_toml says.

    Args:
        data: A result, with all its runs or (after `data.isel(run=0)`) one.
        key: Dotted key of the run file, e.g. "slope.angle"; in the units of the run file.
        default: The value where the result does not have the key; None for an error.

    Returns:
        The values over `run` where they vary, else one value without dimensions.

    Raises:
        ResultError: A run has no such parameter, and no default is given.
    """
    swept = data[key] if key in data.variables else None
    texts = data.coords.get("case_toml", xr.DataArray(data.attrs.get("case_toml", "")))
    values = parameter_values(texts.values, None if swept is None else swept.values, key, default)
    if swept is not None:
        return swept.copy(data=values)
    return xr.DataArray(values, dims=texts.dims if values.shape == texts.shape else None)


def number(one: xr.Dataset, key: str) -> float:
    """A parameter that is a number, of one run."""
    return float(parameter(one, key).item())


def derive(data: xr.Dataset, *names: str) -> xr.Dataset:
    """Fields that follow from h, v and phi.

    Args:
        data: A result with h [m], v [m/s] and phi [-] over (run, time, x), and case_toml; what selections
            leave of one (a run, an instant, some cells) will do, and several joined along run.
        names: Any of gamma, shear rate [1/s] (2.15); I, inertial number [-] (2.10, 2.11); phi_eq, volume fraction of
            the critical state [-] (2.9, in the form of `rheology.phi_eq`); psi, dilatancy angle [degrees] (2.8); mu,
            friction with that of side walls [-] (2.13, 2.14, 4.1). All of them if none is given.

    Returns:
        The fields asked for, with the dimensions of h; NaN where h, v or phi is.

    Raises:
        OptionError: An unknown name.
        ResultError: A parameter that the result does not have.
    """
    unknown = [name for name in names if name not in FIELDS]
    if unknown:
        raise OptionError(f"cannot derive {', '.join(unknown)}: the known fields are {', '.join(FIELDS)}")
    fields = {}
    for name in names or FIELDS:
        compute, units, long_name = FIELDS[name]
        fields[name] = field(data, compute)
        fields[name].attrs = {"units": units, "long_name": long_name}
    return xr.Dataset(fields)


def field(data: xr.Dataset, compute: Callable[[Profiles], Any]) -> xr.DataArray:
    """What is computed from h, v and phi, with the dimensions of h."""
    return xr.DataArray(compute(_OfDataset(data)), data["h"].coords, data["h"].dims)


def normal_gravity(data: xr.Dataset) -> xr.DataArray:
    """Gravity normal to the plane g_c = g cos(theta) [m s-2], of each run."""
    g: xr.DataArray = parameter(data, "slope.gravity") * np.cos(np.deg2rad(parameter(data, "slope.angle")))
    return g


class _OfDataset:
    """The profiles of a Dataset: arrays with the dimensions of h, also where they are computed in pieces by dask."""

    def __init__(self, data: xr.Dataset) -> None:
        self._data, self._dims = data, data["h"].dims

    @property
    def h(self) -> Any:
        return self._data["h"].data

    @property
    def v(self) -> Any:
        return self._data["v"].transpose(*self._dims).data

    @property
    def phi(self) -> Any:
        return self._data["phi"].transpose(*self._dims).data

    def parameter(self, key: str) -> Any:
        values = parameter(self._data, key)
        return values.values.reshape([values.sizes.get(dim, 1) for dim in self._dims])
