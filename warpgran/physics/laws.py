"""The rheology at a point as NumPy functions: shear rate, inertial number, phi_eq(I), mu(I), friction.

The functions of plain values take numbers, arrays, or what behaves as these do, such as xarray's. The last two take the
parameters of a case.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from warpgran.arrays import Array

if TYPE_CHECKING:
    from warpgran.case.case import Case

Values = Any
"""A number, an array, or an object with the arithmetic of one."""


def shear_rate(v: Values, h_e: Values) -> Values:
    """Shear rate gamma [1/s] (2.15). v [m/s]; h_e: max(h, h_min) [m]."""
    return 2.5 * np.abs(v) / h_e


def inertial_number(gamma: Values, phi: Values, h_e: Values, d: Values, g_c: Values) -> Values:
    """Inertial number I [-] (2.10) under the pressure at the base (2.11).

    gamma: shear rate [1/s]; h_e: max(h, h_min) [m]; d: grain diameter [m]; g_c: gravity normal to the plane [m/s2].
    """
    return gamma * d / np.sqrt(phi * g_c * h_e)


def f0(I: Values, K_tilde: Values, phi_stat: Values, N: Values) -> Values:
    """Equilibrium volume fraction [-] (2.9), linear in I and cut off at 0."""
    return positive(phi_stat - K_tilde * I)


def f1(I: Values, K_tilde: Values, phi_stat: Values, N: Values) -> Values:
    """Equilibrium volume fraction [-], exponential in I."""
    return phi_stat * np.exp(-K_tilde * I / phi_stat)


def f2(I: Values, K_tilde: Values, phi_stat: Values, N: Values) -> Values:
    """Equilibrium volume fraction [-], rational in I; f1 in the limit of large N."""
    return phi_stat / (1.0 + K_tilde * I / (N * phi_stat)) ** N


PHI_EQ: dict[str, Callable[[Values, Values, Values, Values], Values]] = {"f0": f0, "f1": f1, "f2": f2}
"""The laws of phi_eq by the words of the run file: functions of I, K_tilde, phi_stat, N."""


def mu_of_I(I: Values, mu1: Values, mu2: Values, I0: Values) -> Values:
    """Friction coefficient mu(I) [-] (2.13)."""
    return mu1 + (mu2 - mu1) * I / (I + I0)


def effective_friction(mu_I: Values, tan_psi: Values, wall: Values) -> Values:
    """Effective friction coefficient mu [-] (2.14). wall: mu_w h/width (4.1)."""
    return positive(mu_I + tan_psi) + wall


def positive(x: Values) -> Values:
    """The positive part (x)_+."""
    return np.maximum(x, 0.0)


def quotient(a: Array, b: Array) -> Array:
    """a/b, and 0 where b = 0."""
    return np.divide(a, b, out=np.zeros(np.broadcast_shapes(np.shape(a), np.shape(b))), where=b != 0)


def phi_equilibrium(I: Array, case: Case) -> Array:
    """Equilibrium volume fraction [-] by the law of a case. I: inertial number [-]."""
    r = case.rheology
    return PHI_EQ[r.phi_eq](I, r.K_tilde, r.phi_stat, r.phi_eq_N)


def shear(h: Array, v: Array, phi: Array, case: Case) -> tuple[Array, Array]:
    """Shear rate gamma [1/s] and inertial number I [-]."""
    h_e = np.maximum(h, case.h_min)
    gamma = shear_rate(v, h_e)
    return gamma, inertial_number(gamma, phi, h_e, case.rheology.grain_diameter, case.g_c)
