"""The rheology at a point as NumPy functions: shear rate, inertial number, phi_eq(I)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from warpgran.arrays import Array

if TYPE_CHECKING:
    from warpgran.case.case import Case


def phi_equilibrium(I: Array, case: Case) -> Array:
    """Equilibrium volume fraction (2.9), regularized as f0, f1 or f2. I: inertial number [-]."""
    r = case.rheology
    if r.phi_eq == "f0":
        return positive(r.phi_stat - r.K_tilde * I)
    if r.phi_eq == "f1":
        return r.phi_stat * np.exp(-r.K_tilde * I / r.phi_stat)
    return r.phi_stat / (1.0 + r.K_tilde * I / (r.phi_eq_N * r.phi_stat)) ** r.phi_eq_N


def shear(h: Array, v: Array, phi: Array, case: Case) -> tuple[Array, Array]:
    """Shear rate gamma [1/s] (2.15) and inertial number I [-] (2.10), (2.11)."""
    h_e = np.maximum(h, case.h_min)
    gamma = 2.5 * np.abs(v) / h_e
    return gamma, gamma * case.rheology.grain_diameter / np.sqrt(phi * case.g_c * h_e)


def positive(x: Array) -> Array:
    """The positive part (x)_+."""
    return np.maximum(x, 0.0)


def quotient(a: Array, b: Array) -> Array:
    """a/b, and 0 where b = 0."""
    return np.divide(a, b, out=np.zeros(np.broadcast_shapes(np.shape(a), np.shape(b))), where=b != 0)
