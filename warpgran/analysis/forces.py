"""The forces of the momentum equation (2.6), as in Fig. 15 of the paper, for any result, over all its runs at once.

f_acc   =  d_t(phi h v)              acceleration
f_inert =  d_x(phi h v^2)            inertia
f_press = -d_x(g_c phi h^2/2)        pressure gradient
f_grav  = -g_c phi h d_x bhat        gravity
f_fric  = -mu g_c phi h sgn(v)       friction                f_acc + f_inert = f_press + f_grav + f_fric

All per unit area and grain density, m2 s-2. Derivatives are central differences between neighbouring cells and
neighbouring snapshots.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from warpgran.analysis.fields import derive, normal_gravity, parameter
from warpgran.analysis.selection import along
from warpgran.errors import ResultError

LONG_NAMES = {
    "f_acc": "acceleration force d_t(phi h v)",
    "f_inert": "inertial force d_x(phi h v^2)",
    "f_press": "pressure gradient force -d_x(g_c phi h^2/2)",
    "f_grav": "gravity force -g_c phi h d_x bhat",
    "f_fric": "friction force -mu g_c phi h sgn(v)",
}


def forces(data: xr.Dataset) -> xr.Dataset:
    """The terms of the momentum equation (2.6) at each snapshot, f_acc + f_inert = f_press + f_grav + f_fric.

    f_acc = d_t(phi h v), f_inert = d_x(phi h v^2), f_press = -d_x(g_c phi h^2/2), f_grav = -g_c phi h d_x bhat,
    f_fric = -mu g_c phi h sgn(v), with bhat = b - x tan(theta), by central differences between cells and snapshots.

    The acceleration at a snapshot is the difference of its neighbours in time (at the first and the last, of itself
    and its neighbour), so that it means something only where they lie close: `time.snapshots = [1.198, 1.2, 1.202]`
    gives it at 1.2 s.

    Where the mass is slower than `time.rest_speed`, sgn(v) in (2.6) is any number in [-1, 1]: the friction there is
    what holds the mass against gravity and pressure, up to mu g_c phi h.

    Args:
        data: A result with x, bed, h [m], v [m/s] and phi [-] over (run, time, x), at least two snapshots and
            case_toml; one run of it will do, and several joined along run.

    Returns:
        f_acc, f_inert, f_press, f_grav and f_fric [m2 s-2], per unit area and grain density, with the dimensions of h;
        NaN in the first and the last cell, where there is no neighbour.

    Raises:
        ResultError: Fewer than two snapshots, or a parameter that the result does not have.
    """
    if data.sizes.get("time", 0) < 2:
        raise ResultError("the acceleration needs two snapshots or more, close to each other: time.snapshots")
    h, v, solid = data["h"], data["v"], data["phi"] * data["h"]
    g_c = normal_gravity(data)
    slope = np.tan(np.deg2rad(parameter(data, "slope.angle"))) - _along(data["bed"], data["x"])  # -d_x bhat
    fields = {
        "f_acc": (solid * v).differentiate("time"),
        "f_inert": _along(solid * v**2, data["x"]),
        "f_press": -_along(0.5 * g_c * solid * h, data["x"]),
        "f_grav": g_c * solid * slope,
    }
    strength = derive(data, "mu")["mu"] * g_c * solid
    held = (-(fields["f_press"] + fields["f_grav"])).clip(-strength, strength)
    moving = abs(v) > parameter(data, "time.rest_speed")
    fields["f_fric"] = (-strength * np.sign(v)).where(moving, held)
    for name, field in fields.items():
        fields[name] = field.transpose(*h.dims).where(fields["f_inert"].notnull())
        fields[name].attrs = {"units": "m2 s-2", "long_name": LONG_NAMES[name]}
    return xr.Dataset(fields)


def _along(q: xr.DataArray, x: xr.DataArray) -> xr.DataArray:
    """d_x by central differences; NaN in the first and the last cell."""
    before, after = {along(q): 1}, {along(q): -1}
    return (q.shift(after) - q.shift(before)) / (x.shift(after) - x.shift(before))
