"""Rheology of a state in order 1: from U to h, phi and friction, and the relaxation of phi.

Each function comes twice: plainly, and with all that it divides by in a single division, see kernels/laws.py.
"""

from typing import Any, NamedTuple

import warp as wp

from warpgran.kernels.laws import Laws
from warpgran.kernels.precision import Variant, precision


class FirstRheology(NamedTuple):
    """Functions of one variant, see each below; `properties` and `relaxed` are the forms that the kernels call."""

    properties: Any
    relaxed: Any
    plain: tuple[Any, Any]
    by_one: tuple[Any, Any]


def make(variant: Variant, laws: Laws) -> FirstRheology:
    """The functions of a variant."""
    kinds = precision(variant.precision)
    Real, RunParams = kinds.Real, kinds.RunParams
    root, phi_equilibrium, friction = laws.root, laws.phi_equilibrium, laws.friction

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

    # Plainly: decode, then the laws of h, v, phi.
    @wp.func
    def decoded_two(U0: Real, U2: Real, p: RunParams):
        """1/U0, phi and h [m] of a wet state, for alpha = 2."""
        per_UU = Real(1.0) / (U0 * U2)
        per_U0 = U2 * per_UU
        return per_U0, U2 * per_U0, U0 * U0 * (U0 * per_UU)

    @wp.func
    def decoded_any(U0: Real, U2: Real, p: RunParams):
        """1/U0, phi and h [m] of a wet state."""
        per_U0 = Real(1.0) / U0
        phi = root(U2 * per_U0, p)
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
        """`properties` with a single division."""
        num, den = inertia_of_state(U0, U1, U2, wp.max(U0 * U0, p.h_min * U2), p)
        top, bottom = phi_equilibrium(num, den, p)
        scale = num + p.I0 * den
        both = bottom * scale
        per_all = Real(1.0) / (U0 * U2 * both)
        per_both = U0 * U2 * per_all
        per_UU = both * per_all
        per_U0 = U2 * per_UU
        phi = U2 * per_U0
        h = U0 * U0 * (U0 * per_UU)
        mu_I = p.mu1 + p.dmu * num * (bottom * per_both)
        return per_U0, phi, h, friction(mu_I, phi, top * (scale * per_both), h, p)

    @wp.func
    def relaxed_by_one(U0: Real, U1: Real, U2: Real, dt: Real, p: RunParams):
        """`relaxed` with a single division."""
        deep = wp.max(U0 * U0, p.h_min * U2)
        num, den = inertia_of_state(U0, U1, U2, deep, p)
        top, bottom = phi_equilibrium(num, den, p)
        # rate and depth times U0^2 U2
        left, whole = remaining(dt * Real(2.5) * wp.abs(U1) * p.K * U2 * U2, deep * U0 * U0)
        both = bottom * whole
        per_all = Real(1.0) / (U0 * both)
        per_both = U0 * per_all
        per_U0 = both * per_all
        phi = U2 * per_U0
        phi_eq = top * (whole * per_both)
        return per_U0, phi_eq + (phi - phi_eq) * (left * (bottom * per_both))

    plain, by_one = (properties, relaxed), (properties_by_one, relaxed_by_one)
    used = by_one if variant.alpha_two and variant.precision == "float64" else plain
    return FirstRheology(*used, plain, by_one)
