"""Rheology of a state in order 2: decoding, friction with dilatancy and walls, the relaxation of phi.

For both precisions and every alpha. Divisions and roots bound these kernels: each function of a cell has one division
and one root, and what does not change from cell to cell is multiplied first.
"""

from typing import Any, NamedTuple

import warp as wp

from warpgran.kernels.laws import Laws
from warpgran.kernels.precision import DRY, Variant, precision

PHI_MIN = 1e-4
"""The relaxation takes phi no lower."""


class SecondRheology(NamedTuple):
    """Functions of one variant, see each below; of wet cells all but `wet` and `friction`."""

    wet: Any
    friction: Any
    motion: Any
    relaxed: Any
    middle: Any
    end: Any


def make(variant: Variant, laws: Laws) -> SecondRheology:
    """The functions of a variant."""
    kinds = precision(variant.precision)
    Real, RunParams = kinds.Real, kinds.RunParams
    power, root, phi_equilibrium, friction_of = laws.power, laws.root, laws.phi_equilibrium, laws.friction
    zero, one = Real(0.0), Real(1.0)
    dry, phi_min = Real(DRY), Real(PHI_MIN)
    # num and den of a film are 1e-18; products of both with others stay normal numbers of float32 so; a power of 2.
    large = Real(2.0**30) if variant.precision == "float32" else one

    @wp.func
    def wet(U0: Real, U2: Real) -> bool:
        """Whether a cell is wet (D)."""
        return U0 > dry and U2 > zero

    @wp.func
    def motion(U0: Real, U1: Real, U2: Real, p: RunParams):
        """v [m/s] and phi of a state (D)."""
        per_U0 = one / U0
        return U1 * per_U0, root(U2 * per_U0, p)

    @wp.func
    def inertia(v: Real, phi: Real, load: Real, p: RunParams):
        """num and den of the inertial number (E1), times a factor. v [m/s]; load: phi h_e [m]."""
        return large * Real(2.5) * p.d / wp.sqrt(p.g_c) * wp.abs(v) * phi, large * load * wp.sqrt(load)

    @wp.func
    def friction(m: Real, v: Real, phi: Real, p: RunParams):
        """h [m] and the effective friction coefficient (E1) of m = phi h [m], v [m/s], phi; by one division."""
        num, den = inertia(v, phi, wp.max(m, phi * p.h_min), p)
        top, bottom = phi_equilibrium(num, den, p)
        scale = num + p.I0 * den
        per_all = one / (bottom * scale * phi)
        per_both = per_all * phi
        h = m * (bottom * scale * per_all)
        mu_I = p.mu1 + p.dmu * num * (bottom * per_both)
        return h, friction_of(mu_I, phi, top * (scale * per_both), h, p)

    @wp.func
    def toward(phi: Real, v: Real, at: Real, load: Real, gone: Real, left: Real, p: RunParams) -> Real:
        """Mean of phi and phi_eq with the weights `left` and `gone`, by one division.

        phi_eq is that of v [m/s], the volume fraction `at` and load [m].
        """
        num, den = inertia(v, at, load, p)
        top, bottom = phi_equilibrium(num, den, p)
        return (top * gone + bottom * (phi * left)) / (bottom * (left + gone))

    @wp.func
    def middle(m: Real, v: Real, phi: Real, rate: Real, p: RunParams) -> Real:
        """Volume fraction half-way (R), after 1/(1 + y/2).

        m: phi h [m]; phi: before; rate: tau K w m/2 [m], y/2 = rate phi^2/load.
        """
        load = wp.max(m, phi * p.h_min)
        return toward(phi, v, phi, load, rate * phi * phi, load, p)

    @wp.func
    def end(m: Real, v: Real, phi: Real, phi_mid: Real, rate: Real, p: RunParams) -> Real:
        """Volume fraction at the end (R), after 1/(1 + y + y^2/2). phi_mid: half-way; all else as in `middle`."""
        load = wp.max(m, phi_mid * p.h_min)
        half_y = rate * phi_mid * phi_mid  # times the load
        gone = (half_y + half_y) * (load + half_y)
        return wp.max(phi_min, toward(phi, v, phi_mid, load, gone, load * load, p))

    @wp.func
    def relaxed(U0: Real, U1: Real, U2: Real, tau: Real, p: RunParams):
        """v [m/s], phi and U2 [m] after dilatancy has acted for tau [s] (R); phi and U2 stay where v or K is 0."""
        v, phi = motion(U0, U1, U2, p)
        rate = Real(1.25) * tau * p.K * wp.abs(v)
        new = end(U0, v, phi, middle(U0, v, phi, rate, p), rate, p)
        acts = U1 != zero and p.K > zero
        return v, wp.where(acts, new, phi), wp.where(acts, U0 * power(new, p), U2)

    return SecondRheology(wet, friction, motion, relaxed, middle, end)
