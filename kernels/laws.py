"""The laws of the rheology at a point, for both schemes: powers of phi, phi_eq(I), friction.

Divisions bound the cost of a step, so phi_eq is a fraction of top and bottom, and so is the inertial number,
I = num/den (2.10), (2.11), (2.15): what is needed together then shares a division.
"""

from typing import Any, NamedTuple

import warp as wp

from warpgran.kernels.precision import Variant, precision


class Laws(NamedTuple):
    """Functions of one variant; see each below."""

    power: Any
    root: Any
    phi_equilibrium: Any
    phi_at_rest: Any
    friction: Any


def make(variant: Variant) -> Laws:
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
        return wp.pow(x, p.per_a)

    power, root = (same, same) if variant.alpha_two else (power_of_any, root_of_any)

    @wp.func
    def f0(num: Real, den: Real, p: RunParams):
        """Equilibrium volume fraction (2.9), linear in I and cut off at 0."""
        return wp.max(Real(0.0), p.phi_stat * den - p.K_tilde * num), den

    @wp.func
    def f1(num: Real, den: Real, p: RunParams):
        """Equilibrium volume fraction, exponential in I."""
        return p.phi_stat * wp.exp(-p.K_tilde * num / (p.phi_stat * den)), Real(1.0)

    @wp.func
    def f2(num: Real, den: Real, p: RunParams):
        """Equilibrium volume fraction, a power of 1/(1 + ...)."""
        return p.phi_stat * wp.pow(Real(1.0) + p.K_tilde * num / (p.N * p.phi_stat * den), -p.N), Real(1.0)

    @wp.func
    def f2_one(num: Real, den: Real, p: RunParams):
        """Equilibrium volume fraction, f2 with N = 1."""
        return p.phi_stat * p.phi_stat * den, p.phi_stat * den + p.K_tilde * num

    phi_equilibrium = {"f0": f0, "f1": f1, "f2": f2, "f2_one": f2_one}[variant.phi_eq]

    @wp.func
    def phi_at_rest(p: RunParams) -> Real:
        """Equilibrium volume fraction where I = 0."""
        top, bottom = phi_equilibrium(Real(0.0), Real(1.0), p)
        return top / bottom

    @wp.func
    def friction(mu_I: Real, phi: Real, phi_eq: Real, h: Real, p: RunParams) -> Real:
        """Effective friction coefficient (2.14) with tan(psi) (2.8) and wall friction (4.1). h [m]."""
        return wp.max(Real(0.0), mu_I + p.K * (phi - phi_eq)) + p.wall * h

    return Laws(power, root, phi_equilibrium, phi_at_rest, friction)
