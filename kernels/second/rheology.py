"""Rheology of a state in order 2: decoding, friction with dilatancy and walls, the relaxation of phi.

All is written plainly, for both precisions and every alpha: how long one operation waits for another bounds these
kernels, and fewer divisions that wait for more products gain nothing (measured; in `friction` alone they do).
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
    zero, half, one = Real(0.0), Real(0.5), Real(1.0)
    dry, phi_min = Real(DRY), Real(PHI_MIN)
    # num and den of a film are 1e-18 m2/s; their product stays a normal number of float32 so; a power of 2.
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
    def inertia(shear: Real, phi: Real, load: Real, p: RunParams):
        """num [m2/s] and den [m2/s] of the inertial number (E1). shear: 2.5 |v| [m/s]; load: phi h_e [m]."""
        return shear * phi * p.d, load * wp.sqrt(p.g_c * load)

    @wp.func
    def friction(m: Real, v: Real, phi: Real, p: RunParams):
        """h [m] and the effective friction coefficient (E1) of m = phi h [m], v [m/s], phi; by one division."""
        num, den = inertia(Real(2.5) * wp.abs(v), phi, wp.max(m, phi * p.h_min), p)
        num, den = large * num, large * den
        top, bottom = phi_equilibrium(num, den, p)
        scale = num + p.I0 * den
        per_all = one / (bottom * scale * phi)
        per_both = per_all * phi
        h = m * (bottom * scale * per_all)
        mu_I = p.mu1 + p.dmu * num * (bottom * per_both)
        return h, friction_of(mu_I, phi, top * (scale * per_both), h, p)

    @wp.func
    def equilibrium(shear: Real, phi: Real, load: Real, p: RunParams) -> Real:
        """phi_eq of the inertial number, e(phi) of R; arguments as in `inertia`."""
        num, den = inertia(shear, phi, load, p)
        top, bottom = phi_equilibrium(num, den, p)
        return top / bottom

    @wp.func
    def middle(m: Real, shear: Real, phi: Real, rate: Real, p: RunParams) -> Real:
        """Volume fraction half-way (R). m: phi h [m]; phi: before; rate: tau K shear [m], y = rate phi^2/load."""
        load = wp.max(m, phi * p.h_min)
        phi_eq = equilibrium(shear, phi, load, p)
        return phi_eq + (phi - phi_eq) * (load / (load + half * rate * phi * phi))

    @wp.func
    def end(m: Real, shear: Real, phi: Real, phi_mid: Real, rate: Real, p: RunParams) -> Real:
        """Volume fraction at the end (R). phi_mid: half-way; all else as in `middle`.

        1/(1 + y + y^2/2) is a fraction of powers of the load: y = whole/load.
        """
        load = wp.max(m, phi_mid * p.h_min)
        phi_eq = equilibrium(shear, phi_mid, load, p)
        whole = rate * phi_mid * phi_mid
        square = load * load
        return wp.max(phi_min, phi_eq + (phi - phi_eq) * (square / (square + whole * (load + half * whole))))

    @wp.func
    def relaxed(U0: Real, U1: Real, U2: Real, tau: Real, p: RunParams):
        """v [m/s], phi and U2 [m] after dilatancy has acted for tau [s] (R); phi and U2 stay where v or K is 0."""
        v, phi = motion(U0, U1, U2, p)
        shear = Real(2.5) * wp.abs(v)
        rate = tau * p.K * shear
        new = end(U0, shear, phi, middle(U0, shear, phi, rate, p), rate, p)
        acts = U1 != zero and p.K > zero
        return v, wp.where(acts, new, phi), wp.where(acts, U0 * power(new, p), U2)

    return SecondRheology(wet, friction, motion, relaxed, middle, end)
