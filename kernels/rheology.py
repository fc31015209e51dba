"""The rheology at a point: shear rate, inertial number, mu(I), phi_eq(I), effective friction.

Every law here is a function of the inertial number I = num/den (2.10), (2.11), (2.15) with num = 5/2 |v| d and
den = h_e sqrt(phi g_c h_e). I is passed as that pair: a law costs one division instead of two.
"""

from typing import Any, NamedTuple

import warp as wp
from warpgran.kernels.precision import Variant, precision


class Rheology(NamedTuple):
    """Functions of one variant; see each below."""

    power: Any
    root: Any
    inertia: Any
    phi_equilibrium: Any
    friction: Any


def make(variant: Variant) -> Rheology:
    """The functions of a variant."""
    kinds = precision(variant.precision)
    Real, RunParams = kinds.Real, kinds.RunParams

    if variant.alpha_two:

        @wp.func
        def power(x: Real, p: RunParams) -> Real:
            """x^(alpha - 1)."""
            return x

        @wp.func
        def root(x: Real, p: RunParams) -> Real:
            """x^(1/(alpha - 1))."""
            return x
    else:

        @wp.func
        def power(x: Real, p: RunParams) -> Real:
            """x^(alpha - 1)."""
            return wp.pow(x, p.a)

        @wp.func
        def root(x: Real, p: RunParams) -> Real:
            """x^(1/(alpha - 1))."""
            return wp.pow(x, p.root)

    @wp.func
    def inertia(h_e: Real, v: Real, phi: Real, p: RunParams):
        """num [m2/s] and den [m2/s] of the inertial number I = num/den. h_e: max(h, h_min) [m]."""
        return Real(2.5) * wp.abs(v) * p.d, h_e * wp.sqrt(phi * p.g_c * h_e)

    if variant.phi_eq == "f0":

        @wp.func
        def phi_equilibrium(num: Real, den: Real, p: RunParams) -> Real:
            """Equilibrium volume fraction, f0."""
            return wp.max(Real(0.0), p.phi_stat - p.K_tilde * num / den)
    elif variant.phi_eq == "f1":

        @wp.func
        def phi_equilibrium(num: Real, den: Real, p: RunParams) -> Real:
            """Equilibrium volume fraction, f1."""
            return p.phi_stat * wp.exp(-p.K_tilde * num / (p.phi_stat * den))
    elif variant.phi_eq == "f2":

        @wp.func
        def phi_equilibrium(num: Real, den: Real, p: RunParams) -> Real:
            """Equilibrium volume fraction, f2."""
            return p.phi_stat / wp.pow(Real(1.0) + p.K_tilde * num / (p.N * p.phi_stat * den), p.N)
    else:

        @wp.func
        def phi_equilibrium(num: Real, den: Real, p: RunParams) -> Real:
            """Equilibrium volume fraction, f2 with N = 1."""
            return p.phi_stat * p.phi_stat * den / (p.phi_stat * den + p.K_tilde * num)

    @wp.func
    def friction(h: Real, v: Real, phi: Real, p: RunParams) -> Real:
        """Effective friction coefficient (2.13), (2.14), with wall friction (4.1). h [m], v [m/s]."""
        num, den = inertia(wp.max(h, p.h_min), v, phi, p)
        tan_psi = p.K * (phi - phi_equilibrium(num, den, p))
        mu_I = p.mu1 + p.dmu * num / (num + p.I0 * den)
        return wp.max(Real(0.0), mu_I + tan_psi) + p.wall * h

    return Rheology(power, root, inertia, phi_equilibrium, friction)
