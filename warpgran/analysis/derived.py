"""Fields that follow from h, v and phi, on arrays: step 2 of the scheme. SI units, psi in degrees.

The laws are those of physics.laws.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np

from warpgran.errors import ResultError
from warpgran.physics import laws


class Profiles(Protocol):
    """What fields follow from: h [m], v [m/s], phi [-], and parameters, which broadcast against them."""

    @property
    def h(self) -> Any:
        """Thickness [m]."""

    @property
    def v(self) -> Any:
        """Velocity [m/s]."""

    @property
    def phi(self) -> Any:
        """Volume fraction [-]."""

    def parameter(self, key: str, /) -> Any:
        """What a dotted key of the run file was."""


def thick(of: Profiles) -> Any:
    """Where there is more than h_front: what counts as the mass, and what velocity and phi are shown of."""
    return compacted(of) > of.parameter("scheme.h_front")


def compacted(of: Profiles) -> Any:
    """Compacted thickness phi h/phi_stat [m]: what the solid of a cell would be thick at phi_stat."""
    return of.phi * of.h / of.parameter("rheology.phi_stat")


def dilatancy_angle(of: Profiles) -> Any:
    """Dilatancy angle psi [degrees] (2.8)."""
    return np.rad2deg(np.arctan(_tan_psi(of)))


def _effective_thickness(of: Profiles) -> Any:
    """h_e = max(h, h_min) [m]: in a layer of a few grains, thinner than h_min, the shear rate has no meaning."""
    return np.maximum(of.h, of.parameter("scheme.h_min"))


def _shear_rate(of: Profiles) -> Any:
    """Shear rate gamma [1/s] (2.15)."""
    return laws.shear_rate(of.v, _effective_thickness(of))


def _inertial_number(of: Profiles) -> Any:
    """Inertial number I [-] (2.10), (2.11); NaN where phi is not positive."""
    phi, d = np.where(of.phi > 0, of.phi, np.nan), of.parameter("rheology.grain_diameter")
    g_c = of.parameter("slope.gravity") * np.cos(np.deg2rad(of.parameter("slope.angle")))
    return laws.inertial_number(_shear_rate(of), phi, _effective_thickness(of), d, g_c)


def _equilibrium_volume_fraction(of: Profiles) -> Any:
    """Equilibrium volume fraction phi_eq [-] (2.9), by the law of each run."""
    law = of.parameter("rheology.phi_eq")
    keys = ("rheology.K_tilde", "rheology.phi_stat", "rheology.phi_eq_N")
    K_tilde, phi_stat, N = (of.parameter(key) for key in keys)
    I = _inertial_number(of)
    phi_eq = np.full_like(I, np.nan)
    for name in np.unique(law).tolist():
        if name not in laws.PHI_EQ:
            raise ResultError(f"rheology.phi_eq: the law {name!r} is not known; known: {', '.join(laws.PHI_EQ)}")
        phi_eq = np.where(law == name, laws.PHI_EQ[name](I, K_tilde, phi_stat, N), phi_eq)
    return phi_eq


def _tan_psi(of: Profiles) -> Any:
    """Tangent of the dilatancy angle [-] (2.8)."""
    return of.parameter("rheology.K") * (of.phi - _equilibrium_volume_fraction(of))


def _effective_friction(of: Profiles) -> Any:
    """Effective friction mu [-] (2.13), (2.14) with the side walls (4.1)."""
    mu1, mu2, I0 = (of.parameter(f"rheology.{name}") for name in ("mu1", "mu2", "I0"))
    wall = of.parameter("rheology.mu_wall") * of.h / of.parameter("rheology.channel_width")
    return laws.effective_friction(laws.mu_of_I(_inertial_number(of), mu1, mu2, I0), _tan_psi(of), wall)


FIELDS: dict[str, tuple[Callable[[Profiles], Any], str, str]] = {
    "gamma": (_shear_rate, "s-1", "shear rate (2.15)"),
    "I": (_inertial_number, "1", "inertial number (2.10), (2.11)"),
    "phi_eq": (_equilibrium_volume_fraction, "1", "equilibrium volume fraction (2.9)"),
    "psi": (dilatancy_angle, "degree", "dilatancy angle (2.8)"),
    "mu": (_effective_friction, "1", "effective friction (2.13), (2.14), (4.1)"),
}
"""The fields by name: what computes them, units, long name."""
