"""Fields that follow from h, v and phi: step 2 of the scheme, for any result, over all its runs at once.

The laws are those of physics.laws; here every run gets its own parameters. SI units, psi in degrees.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import xarray as xr

from warpgran.analysis.run_columns import value_in
from warpgran.errors import OptionError, ResultError
from warpgran.physics import laws


def parameter(data: xr.Dataset, key: str, default: Any = None) -> xr.DataArray:
    """What a parameter was in each run.

    A run's value is the coordinate of that name, which swept keys have; where there is none, or it is missing (after
    joining results of different sweeps), what the run's own text says, coordinate case_toml; where there is no such
    coordinate, what the attribute case_toml says.

    Args:
        data: a result, with all its runs or (after `data.isel(run=0)`) one.
        key: dotted key of the run file, e.g. "slope.angle"; in the units of the run file.
        default: the value where the result does not have the key; None for an error.

    Returns:
        The values over `run` where they vary, else one value without dimensions.

    Raises:
        ResultError: a run has no such parameter, and no default is given.
    """
    swept = data[key] if key in data.variables else None
    if swept is not None and swept.notnull().all():
        return swept
    values = _from_texts(data, key)
    values = values if default is None else values.fillna(default)
    values = values if swept is None else swept.fillna(values)
    if default is None and values.isnull().any():
        raise ResultError(
            f"the result does not say what {key} was: neither its case_toml nor a coordinate of that name"
        )
    return values.copy(data=np.array(values.values.tolist()))


def number(one: xr.Dataset, key: str) -> float:
    """A parameter that is a number, of one run."""
    return float(parameter(one, key).item())


def _from_texts(data: xr.Dataset, key: str) -> xr.DataArray:
    """What the texts of the runs say of a key, None where nothing; over `run` only if they differ."""
    texts = data.coords.get("case_toml", xr.DataArray(data.attrs.get("case_toml", "")))
    found = {text: value_in(text, key) for text in dict.fromkeys(texts.values.ravel().tolist())}
    first, *others = found.values()
    if all(value == first for value in others):
        return xr.DataArray(np.array(first, dtype=object))
    return xr.DataArray([found[text] for text in texts.values.tolist()], dims=texts.dims).astype(object)


def derive(data: xr.Dataset, *names: str) -> xr.Dataset:
    """Fields that follow from h, v and phi.

    Args:
        data: a result with h [m], v [m/s] and phi [-] over (run, time, x), and case_toml; what selections
            leave of one (a run, an instant, some cells) will do, and several joined along run.
        names: any of gamma [1/s], I [-], phi_eq [-], psi [degrees] and mu [-]; all of them if none is given.

    Returns:
        The fields asked for, with the dimensions of h; NaN where h, v or phi is.

    Raises:
        ResultError: an unknown name, or a parameter that the result does not have.
    """
    unknown = [name for name in names if name not in FIELDS]
    if unknown:
        raise OptionError(f"cannot derive {', '.join(unknown)}: the known fields are {', '.join(FIELDS)}")
    fields = {}
    for name in names or FIELDS:
        compute, units, long_name = FIELDS[name]
        fields[name] = compute(data).transpose(*data["h"].dims)
        fields[name].attrs = {"units": units, "long_name": long_name}
    return xr.Dataset(fields)


def normal_gravity(data: xr.Dataset) -> xr.DataArray:
    """Gravity normal to the plane g_c = g cos(theta) [m s-2], of each run."""
    g: xr.DataArray = parameter(data, "slope.gravity") * np.cos(np.deg2rad(parameter(data, "slope.angle")))
    return g


def _effective_thickness(data: xr.Dataset) -> xr.DataArray:
    """h_e = max(h, h_min) [m]: the shear rate has no meaning below one grain."""
    return data["h"].clip(min=parameter(data, "scheme.h_min"))


def _shear_rate(data: xr.Dataset) -> xr.DataArray:
    """Shear rate gamma [1/s] (2.15)."""
    gamma: xr.DataArray = laws.shear_rate(data["v"], _effective_thickness(data))
    return gamma


def _inertial_number(data: xr.Dataset) -> xr.DataArray:
    """Inertial number I [-] (2.10), (2.11); NaN where phi is not positive."""
    phi, d = data["phi"].where(data["phi"] > 0), parameter(data, "rheology.grain_diameter")
    I: xr.DataArray = laws.inertial_number(_shear_rate(data), phi, _effective_thickness(data), d, normal_gravity(data))
    return I


def _equilibrium_volume_fraction(data: xr.Dataset) -> xr.DataArray:
    """Equilibrium volume fraction phi_eq [-] (2.9), by the law of each run."""
    law = parameter(data, "rheology.phi_eq")
    keys = ("rheology.K_tilde", "rheology.phi_stat", "rheology.phi_eq_N")
    K_tilde, phi_stat, N = (parameter(data, key) for key in keys)
    I = _inertial_number(data)
    phi_eq = xr.full_like(I, np.nan)
    for name in np.unique(law).tolist():
        if name not in laws.PHI_EQ:
            raise ResultError(f"rheology.phi_eq: the law {name!r} is not known; known: {', '.join(laws.PHI_EQ)}")
        phi_eq = laws.PHI_EQ[name](I, K_tilde, phi_stat, N).where(law == name, phi_eq)
    return phi_eq


def _tan_psi(data: xr.Dataset) -> xr.DataArray:
    """Tangent of the dilatancy angle [-] (2.8)."""
    return parameter(data, "rheology.K") * (data["phi"] - _equilibrium_volume_fraction(data))


def _dilatancy_angle(data: xr.Dataset) -> xr.DataArray:
    """Dilatancy angle psi [degrees] (2.8)."""
    psi: xr.DataArray = xr.apply_ufunc(np.arctan, _tan_psi(data))
    return psi * (180.0 / np.pi)


def _effective_friction(data: xr.Dataset) -> xr.DataArray:
    """Effective friction mu [-] (2.13), (2.14) with the side walls (4.1)."""
    mu1, mu2, I0 = (parameter(data, f"rheology.{name}") for name in ("mu1", "mu2", "I0"))
    wall = parameter(data, "rheology.mu_wall") * data["h"] / parameter(data, "rheology.channel_width")
    mu: xr.DataArray = laws.effective_friction(laws.mu_of_I(_inertial_number(data), mu1, mu2, I0), _tan_psi(data), wall)
    return mu


FIELDS: dict[str, tuple[Callable[[xr.Dataset], xr.DataArray], str, str]] = {
    "gamma": (_shear_rate, "s-1", "shear rate (2.15)"),
    "I": (_inertial_number, "1", "inertial number (2.10), (2.11)"),
    "phi_eq": (_equilibrium_volume_fraction, "1", "equilibrium volume fraction (2.9)"),
    "psi": (_dilatancy_angle, "degree", "dilatancy angle (2.8)"),
    "mu": (_effective_friction, "1", "effective friction (2.13), (2.14), (4.1)"),
}
