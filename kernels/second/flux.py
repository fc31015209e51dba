"""Suliciu flux between the reconstructed faces of cells (E5, E6), relative to the pressures of the two sides.

Reconstruction is no kernel of its own: to store and read its results would cost as much as to compute them.
"""

from typing import Any, NamedTuple

import warp as wp

from warpgran.kernels.precision import Ints, Variant, precision
from warpgran.kernels.ranges import before_first, end_of, run_of
from warpgran.kernels.second.reconstruction import SecondReconstruction

LEAST = {"float64": 1e-150, "float32": 1.1e-19}
"""Impedance of a side without mass (m2/s), so that nothing is divided by 0: its square is still a normal number."""


class SecondFlux(NamedTuple):
    """The kernel of this file, and its functions."""

    flux: Any
    impedance: Any
    speeds: Any
    suliciu: Any


def make(variant: Variant, reconstruction: SecondReconstruction, module: Any) -> SecondFlux:
    """The kernel of a variant."""
    kinds = precision(variant.precision)
    Real, A, RunParams, Params = kinds.Real, kinds.Array, kinds.RunParams, kinds.Params
    zero, half, one, three_halves = Real(0.0), Real(0.5), Real(1.0), Real(1.5)
    least = Real(LEAST[variant.precision])
    jump, reconstructed = reconstruction.jump, reconstruction.reconstructed

    @wp.func
    def impedance(q: Real, rho: Real, p: RunParams) -> Real:
        """rho = s q [m] times the sound speed sqrt(g_c q/s) [m2/s], never 0."""
        return q * wp.sqrt(p.g_c * rho) + least

    @wp.func
    def speeds(dp: Real, rho_1: Real, impedance_1: Real, rho_2: Real, impedance_2: Real, D: Real):
        """C_1, C_2 [m2/s] of the sides of the lower (1) and the higher pressure (2), apart by dp >= 0 [m3/s2].

        C = rho S, with the relaxation speed S; D = v_l - v_r. A side without mass has all but no C and does not speed
        up the other. Bouchut (2004), section 2.4; 3/2 is (gamma + 1)/2 for gamma = 2.
        """
        # C_1 impedance_2, so that no division waits for C_1
        product = impedance_1 * impedance_2 + three_halves * rho_1 * wp.max(zero, dp + D * impedance_2)
        rise = wp.max(zero, D - dp * impedance_2 / product)
        return product / impedance_2, impedance_2 + three_halves * rho_2 * rise

    @wp.func
    def both_speeds(dp: Real, rho_l: Real, impedance_l: Real, rho_r: Real, impedance_r: Real, D: Real):
        """C_l, C_r [m2/s]. dp: pressure on the right less that on the left; all else as in `speeds`."""
        up = dp >= zero
        C_1, C_2 = speeds(
            wp.abs(dp), wp.where(up, rho_l, rho_r), wp.where(up, impedance_l, impedance_r), wp.where(up, rho_r, rho_l),
            wp.where(up, impedance_r, impedance_l), D,
        )  # fmt: skip
        return wp.where(up, C_1, C_2), wp.where(up, C_2, C_1)

    @wp.func
    def suliciu(
        rho_l: Real, v_l: Real, C_l: Real, most_l: Real, rho_r: Real, v_r: Real, C_r: Real, most_r: Real, dp: Real
    ):  # fmt: skip
        """Mass flux F0 [m2/s], and momentum flux less the pressure of the left and the right side, E_l, E_r [m3/s2].

        Each side has rho = phi h [m], v [m/s], C = rho S [m2/s], and the most that may flow out of it [m2/s].
        """
        D = v_l - v_r
        C = C_l + C_r
        per_C = one / C
        push = C_l * v_l + C_r * v_r - dp  # C u

        # The upwind side (u), seen along its own direction of flow; downwind (d).
        to_right = push >= zero
        rho_u = wp.where(to_right, rho_l, rho_r)
        v_u = wp.where(to_right, v_l, v_r)
        C_u = wp.where(to_right, C_l, C_r)
        C_d = wp.where(to_right, C_r, C_l)
        rise = C_d * D + wp.where(to_right, dp, -dp)  # of pressure from that side, times C/C_u
        whole = C_u * C - rho_u * rise
        F_star = push * (rho_u * C_u) / whole
        F_u = rho_u * v_u
        supersonic = wp.where(to_right, F_u, -F_u) >= C_u
        F0 = wp.where(supersonic, F_u, F_star)
        F0 = wp.max(wp.min(F0, most_l), -most_r)
        speed = wp.where(supersonic, v_u, push * per_C)
        E_u = F0 * speed + wp.where(supersonic, zero, C_u * per_C * rise)
        return F0, wp.where(to_right, E_u, E_u + dp), wp.where(to_right, E_u - dp, E_u)

    @wp.kernel(module=module)
    def flux(
        # inputs
        X: A, P: A, share: A, hold: A, SX: A, SP: A,
        q_L: A, q_R: A, s_L: A, s_R: A, v_L: A, v_R: A, c_L: A, c_R: A, dt: A,
        # per run
        params: Params, lo: Ints, hi: Ints, active: Ints, chunks: int,
        # outputs
        F0: A, E_l: A, E_r: A, F2: A,
    ):  # fmt: skip
        """Flux through the interface on the left of each cell: F0, F2 [m2/s], E_l, E_r [m3/s2]."""
        thread = wp.tid()
        run = run_of(thread, chunks)
        p = params[run]
        left = before_first(thread, chunks, p.row, lo[run], hi[run])
        end = end_of(thread, chunks, p.row, lo[run], hi[run], active[run]) - 1
        half_g = half * p.g_c
        half_rate = half * p.dx / dt[run]
        while left < end:
            i = left + 1
            J = jump(X[i], P[i], share[i], hold[i], SX[left], SP[left], SX[i], SP[i])
            q_l, q_r = reconstructed(q_R[left], q_L[i], J)
            v_l = v_R[left]
            v_r = v_L[i]
            rho_l = s_R[left] * q_l
            rho_r = s_L[i] * q_r
            dp = half_g * (q_r - q_l) * (q_r + q_l)  # 0 exactly where q* are equal
            C_l, C_r = both_speeds(dp, rho_l, impedance(q_l, rho_l, p), rho_r, impedance(q_r, rho_r, p), v_l - v_r)
            most_l = q_R[left] * s_R[left] * half_rate
            most_r = q_L[i] * s_L[i] * half_rate
            mass, seen_l, seen_r = suliciu(rho_l, v_l, C_l, most_l, rho_r, v_r, C_r, most_r, dp)
            F0[i] = mass
            E_l[i] = seen_l
            E_r[i] = seen_r
            F2[i] = mass * wp.where(mass >= zero, c_R[left], c_L[i])
            left += wp.block_dim()

    return SecondFlux(flux, impedance, both_speeds, suliciu)
