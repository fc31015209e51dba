"""The rheology at a point: state to h and phi, inertial number, mu(I), phi_eq(I), effective friction.

Divisions bound the cost of a step, so laws are passed as fractions, numerator and denominator apart, and those that are
needed together share one division: a/b and c/d are a d r and c b r with r = 1/(b d). So is the inertial number
I = num/den (2.10), (2.11), (2.15), with num = 5/2 |v| d and den = h_e sqrt(phi g_c h_e).
"""

from typing import Any, NamedTuple

import warp as wp

from warpgran.kernels.precision import Variant, precision


class Rheology(NamedTuple):
    """Functions of one variant; see each below."""

    power: Any
    root: Any
    unpack: Any
    inertia: Any
    phi_equilibrium: Any
    friction: Any


def make(variant: Variant) -> Rheology:
    """The functions of a variant."""
    kinds = precision(variant.precision)
    Real, RunParams = kinds.Real, kinds.RunParams

    @wp.func
    def same(x: Real, p: RunParams) -> Real:
        """x^(alpha - 1) and x^(1/(alpha - 1)) for alpha = 2."""
        return x

    @wp.func
    def power_of_any(x: Real, p: RunParams) -> Real:
        """x^(alpha - 1)."""
        return wp.pow(x, p.a)

    @wp.func
    def root_of_any(x: Real, p: RunParams) -> Real:
        """x^(1/(alpha - 1))."""
        return wp.pow(x, p.root)

    power, root = (same, same) if variant.alpha_two else (power_of_any, root_of_any)

    @wp.func
    def unpack_two(U0: Real, U2: Real, p: RunParams):
        """1/U0, phi and h [m] of a wet state, for alpha = 2."""
        r = Real(1.0) / (U0 * U2)
        per_U0 = U2 * r
        return per_U0, U2 * per_U0, U0 * U0 * (U0 * r)

    @wp.func
    def unpack_any(U0: Real, U2: Real, p: RunParams):
        """1/U0, phi and h [m] of a wet state."""
        per_U0 = Real(1.0) / U0
        phi = root_of_any(U2 * per_U0, p)
        return per_U0, phi, U0 / phi

    @wp.func
    def inertia(h_e: Real, v: Real, phi: Real, p: RunParams):
        """num [m2/s] and den [m2/s] of the inertial number. h_e: max(h, h_min) [m]."""
        return Real(2.5) * wp.abs(v) * p.d, h_e * wp.sqrt(phi * p.g_c * h_e)

    # phi_eq of I = num/den as a fraction.
    @wp.func
    def f0(num: Real, den: Real, p: RunParams):
        """Equilibrium volume fraction (2.9), cut off at 0."""
        return wp.max(Real(0.0), p.phi_stat * den - p.K_tilde * num), den

    @wp.func
    def f1(num: Real, den: Real, p: RunParams):
        """Equilibrium volume fraction, exponential."""
        return p.phi_stat * wp.exp(-p.K_tilde * num / (p.phi_stat * den)), Real(1.0)

    @wp.func
    def f2(num: Real, den: Real, p: RunParams):
        """Equilibrium volume fraction, a power of 1/(1 + ...)."""
        return p.phi_stat, wp.pow(Real(1.0) + p.K_tilde * num / (p.N * p.phi_stat * den), p.N)

    @wp.func
    def f2_one(num: Real, den: Real, p: RunParams):
        """Equilibrium volume fraction, f2 with N = 1."""
        return p.phi_stat * p.phi_stat * den, p.phi_stat * den + p.K_tilde * num

    phi_equilibrium = {"f0": f0, "f1": f1, "f2": f2, "f2_one": f2_one}[variant.phi_eq]

    @wp.func
    def friction(h: Real, v: Real, phi: Real, p: RunParams) -> Real:
        """Effective friction coefficient (2.13), (2.14), with wall friction (4.1). h [m], v [m/s]."""
        num, den = inertia(wp.max(h, p.h_min), v, phi, p)
        top, bottom = phi_equilibrium(num, den, p)
        scale = num + p.I0 * den
        r = Real(1.0) / (bottom * scale)
        mu_I = p.mu1 + p.dmu * num * (bottom * r)
        tan_psi = p.K * (phi - top * (scale * r))  # (2.8)
        return wp.max(Real(0.0), mu_I + tan_psi) + p.wall * h

    unpack = unpack_two if variant.alpha_two else unpack_any
    return Rheology(power, root, unpack, inertia, phi_equilibrium, friction)
