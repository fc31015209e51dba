"""The rheology at a point: state to h and phi, inertial number, mu(I), phi_eq(I), effective friction, dilatancy.

Divisions bound the cost of a step, so laws are passed as fractions, numerator and denominator apart, and those that are
needed together share divisions. So is the inertial number I = num/den (2.10), (2.11), (2.15).
"""

from typing import Any, NamedTuple

import warp as wp

from warpgran.kernels.precision import Variant, precision


class Rheology(NamedTuple):
    """Functions of one variant; see each below."""

    power: Any
    root: Any
    phi_at_rest: Any
    friction: Any
    properties: Any
    relaxed: Any


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

    # What is left of phi - phi_eq after a step as a fraction; rate/depth is dt gamma K phi.
    @wp.func
    def rational(rate: Real, depth: Real):
        """1/(1 + dt gamma K phi) (3.17)."""
        return depth, depth + rate

    @wp.func
    def exponential(rate: Real, depth: Real):
        """exp(-dt gamma K phi) (3.18)."""
        return wp.exp(-rate / depth), Real(1.0)

    remaining = {"rational": rational, "exponential": exponential}[variant.relaxation]

    @wp.func
    def friction(mu_I: Real, phi: Real, phi_eq: Real, h: Real, p: RunParams) -> Real:
        """Effective friction coefficient (2.14) with tan(psi) (2.8) and wall friction (4.1)."""
        return wp.max(Real(0.0), mu_I + p.K * (phi - phi_eq)) + p.wall * h

    # Plainly: decode, then the laws of h, v, phi.
    @wp.func
    def decoded_two(U0: Real, U2: Real, p: RunParams):
        """1/U0, phi and h [m] of a wet state, for alpha = 2."""
        r = Real(1.0) / (U0 * U2)
        per_U0 = U2 * r
        return per_U0, U2 * per_U0, U0 * U0 * (U0 * r)

    @wp.func
    def decoded_any(U0: Real, U2: Real, p: RunParams):
        """1/U0, phi and h [m] of a wet state."""
        per_U0 = Real(1.0) / U0
        phi = root_of_any(U2 * per_U0, p)
        return per_U0, phi, U0 / phi

    decoded = decoded_two if variant.alpha_two else decoded_any

    @wp.func
    def inertia(h_e: Real, v: Real, phi: Real, p: RunParams):
        """num [m2/s] and den [m2/s] of the inertial number. h_e: max(h, h_min) [m]."""
        return Real(2.5) * wp.abs(v) * p.d, h_e * wp.sqrt(phi * p.g_c * h_e)

    @wp.func
    def properties(U0: Real, U1: Real, U2: Real, p: RunParams):
        """1/U0, phi, h [m] and effective friction coefficient of a wet state."""
        per_U0, phi, h = decoded(U0, U2, p)
        num, den = inertia(wp.max(h, p.h_min), U1 * per_U0, phi, p)
        top, bottom = phi_equilibrium(num, den, p)
        scale = num + p.I0 * den
        per_both = Real(1.0) / (bottom * scale)
        mu_I = p.mu1 + p.dmu * num * (bottom * per_both)
        return per_U0, phi, h, friction(mu_I, phi, top * (scale * per_both), h, p)

    @wp.func
    def relaxed(U0: Real, U1: Real, U2: Real, dt: Real, p: RunParams):
        """1/U0, and the volume fraction of a wet state after dilatancy has acted for dt [s] (3.15)."""
        per_U0, phi, h = decoded(U0, U2, p)
        v = U1 * per_U0
        h_e = wp.max(h, p.h_min)
        num, den = inertia(h_e, v, phi, p)
        top, bottom = phi_equilibrium(num, den, p)
        left, whole = remaining(dt * Real(2.5) * wp.abs(v) * p.K * phi, h_e)
        per_both = Real(1.0) / (bottom * whole)
        phi_eq = top * (whole * per_both)
        return per_U0, phi_eq + (phi - phi_eq) * (left * (bottom * per_both))

    # The same for alpha = 2 in float64, where h = U0^2/U2 and phi = U2/U0 let all fractions be multiplied by powers of
    # U0 and U2 until a single division is left.
    @wp.func
    def inertia_of_state(U0: Real, U1: Real, U2: Real, deep: Real, p: RunParams):
        """num and den of the inertial number, both times U0 U2 [m4/s]. deep: h_e U2 [m2]."""
        return Real(2.5) * wp.abs(U1) * U2 * p.d, deep * wp.sqrt(p.g_c * deep * U0)

    @wp.func
    def properties_by_one(U0: Real, U1: Real, U2: Real, p: RunParams):
        """As properties."""
        num, den = inertia_of_state(U0, U1, U2, wp.max(U0 * U0, p.h_min * U2), p)
        top, bottom = phi_equilibrium(num, den, p)
        scale = num + p.I0 * den
        both = bottom * scale
        r = Real(1.0) / (U0 * U2 * both)
        per_both = U0 * U2 * r
        per_UU = both * r
        per_U0 = U2 * per_UU
        phi = U2 * per_U0
        h = U0 * U0 * (U0 * per_UU)
        mu_I = p.mu1 + p.dmu * num * (bottom * per_both)
        return per_U0, phi, h, friction(mu_I, phi, top * (scale * per_both), h, p)

    @wp.func
    def relaxed_by_one(U0: Real, U1: Real, U2: Real, dt: Real, p: RunParams):
        """As relaxed."""
        deep = wp.max(U0 * U0, p.h_min * U2)
        num, den = inertia_of_state(U0, U1, U2, deep, p)
        top, bottom = phi_equilibrium(num, den, p)
        # rate and depth times U0^2 U2
        left, whole = remaining(dt * Real(2.5) * wp.abs(U1) * p.K * U2 * U2, deep * U0 * U0)
        both = bottom * whole
        r = Real(1.0) / (U0 * both)
        per_both = U0 * r
        per_U0 = both * r
        phi = U2 * per_U0
        phi_eq = top * (whole * per_both)
        return per_U0, phi_eq + (phi - phi_eq) * (left * (bottom * per_both))

    if variant.alpha_two and variant.precision == "float64":
        return Rheology(power, root, phi_at_rest, friction, properties_by_one, relaxed_by_one)
    return Rheology(power, root, phi_at_rest, friction, properties, relaxed)
