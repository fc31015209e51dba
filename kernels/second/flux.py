"""Suliciu flux between the reconstructed faces of cells (E5, E6), relative to the pressures of the two sides.

Reconstruction is no kernel of its own: to store and read its results would cost as much as to compute them.
"""

from typing import Any, NamedTuple

import warp as wp

from warpgran.kernels.precision import Ints, Variant, precision
from warpgran.kernels.ranges import before_first, end_of, run_of
from warpgran.kernels.second.reconstruction import SecondReconstruction


class SecondFlux(NamedTuple):
    """The kernel of this file, and its functions."""

    flux: Any
    speeds: Any
    suliciu: Any


def make(variant: Variant, reconstruction: SecondReconstruction, module: Any) -> SecondFlux:
    """The kernel of a variant."""
    kinds = precision(variant.precision)
    Real, A, Params = kinds.Real, kinds.Array, kinds.Params
    zero, half, one, three_halves, tiny = Real(0.0), Real(0.5), Real(1.0), Real(1.5), Real(kinds.tiny)
    jump, reconstructed = reconstruction.jump, reconstruction.reconstructed

    @wp.func
    def speeds(dp: Real, rho_1: Real, impedance_1: Real, rho_2: Real, impedance_2: Real, D: Real):
        """C_1, C_2 [m2/s] of the sides of the lower (1) and the higher pressure (2), apart by dp >= 0 [m3/s2].

        C = rho S, with rho = s q [m] and the relaxation speed S; impedance: rho times the sound speed, q sqrt(g_c rho)
        [m2/s]; D = v_l - v_r. A side without mass has C = 0 and does not speed up the other. Bouchut (2004), section
        2.4; 3/2 is (gamma + 1)/2 for gamma = 2.
        """
        # C_1 impedance_2, so that no division waits for C_1
        product = impedance_1 * impedance_2 + three_halves * rho_1 * wp.max(zero, dp + D * impedance_2)
        rise = wp.max(zero, D - dp * impedance_2 / (product + tiny))
        C_2 = impedance_2 + three_halves * rho_2 * wp.where(product > zero, rise, zero)
        return product / (impedance_2 + tiny), C_2

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
        C = C_l + C_r + tiny
        per_C = one / C
        push = C_l * v_l + C_r * v_r - dp  # C u
        e_l = C_l * per_C * (dp + C_r * D)
        e_r = C_r * per_C * (C_l * D - dp)

        # The upwind side (u), seen along its own direction of flow; downwind (d).
        to_right = push >= zero
        rho_u = wp.where(to_right, rho_l, rho_r)
        v_u = wp.where(to_right, v_l, v_r)
        C_u = wp.where(to_right, C_l, C_r)
        C_d = wp.where(to_right, C_r, C_l)
        rise = wp.where(to_right, dp, -dp)
        whole = C_u * C - rho_u * (C_d * D + rise)  # 0 if that side holds no mass
        F_star = push * (rho_u * C_u) / (whole + tiny)
        F_u = rho_u * v_u
        supersonic = rho_u > zero and wp.where(to_right, F_u, -F_u) >= C_u
        F0 = wp.where(supersonic, F_u, F_star)
        F0 = wp.where(to_right, wp.min(F0, most_l), wp.max(F0, -most_r))
        speed = wp.where(supersonic, v_u, push * per_C)
        e_l = wp.where(supersonic, wp.where(to_right, zero, dp), e_l)
        e_r = wp.where(supersonic, wp.where(to_right, -dp, zero), e_r)
        return F0, F0 * speed + e_l, F0 * speed + e_r

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
            impedance_l = q_l * wp.sqrt(p.g_c * rho_l)
            impedance_r = q_r * wp.sqrt(p.g_c * rho_r)
            dp = half_g * (q_r - q_l) * (q_r + q_l)  # 0 exactly where q* are equal
            C_l, C_r = both_speeds(dp, rho_l, impedance_l, rho_r, impedance_r, v_l - v_r)
            most_l = q_R[left] * s_R[left] * half_rate
            most_r = q_L[i] * s_L[i] * half_rate
            mass, seen_l, seen_r = suliciu(rho_l, v_l, C_l, most_l, rho_r, v_r, C_r, most_r, dp)
            F0[i] = mass
            E_l[i] = seen_l
            E_r[i] = seen_r
            F2[i] = mass * wp.where(mass >= zero, c_R[left], c_L[i])
            left += wp.block_dim()

    return SecondFlux(flux, both_speeds, suliciu)
