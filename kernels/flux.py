"""Step 7: Suliciu relaxation flux between reconstructed states, and the two-sided momentum flux."""

from typing import Any

import warp as wp

from warpgran.kernels.precision import Ints, Variant, precision
from warpgran.kernels.ranges import before_first, end_of, run_of
from warpgran.kernels.rheology import Rheology


def make(variant: Variant, rheology: Rheology, module: Any) -> Any:
    """The kernel of a variant."""
    kinds = precision(variant.precision)
    Real, A, RunParams, Params = kinds.Real, kinds.Array, kinds.RunParams, kinds.Params
    tiny = Real(kinds.tiny)
    power = rheology.power

    @wp.func
    def positive(x: Real) -> Real:
        """The positive part."""
        return wp.max(x, Real(0.0))

    @wp.func
    def lagrangian_speeds(p_1: Real, rho_1: Real, s_1: Real, p_2: Real, rho_2: Real, s_2: Real, D: Real):
        """Relaxation speeds S_1, S_2 [m/s] of the sides of the lower (1) and the higher pressure (2).

        D = v_l - v_r. Each side's c = rho S; a side without mass has c = 0 and does not speed up the other.
        Bouchut (2004), section 2.4; 3/2 is (gamma + 1)/2 for gamma = 2.
        """
        dp = p_2 - p_1
        S_1 = s_1 + Real(1.5) * positive(dp / wp.max(rho_2 * s_2, tiny) + D)
        c_1 = rho_1 * S_1
        rise = positive(D - dp / wp.max(c_1, tiny))
        S_2 = s_2 + Real(1.5) * wp.where(c_1 > Real(0.0), rise, Real(0.0))
        return S_1, S_2

    @wp.func
    def suliciu(h_l: Real, v_l: Real, phi_l: Real, h_r: Real, v_r: Real, phi_r: Real, g_c: Real):
        """Mass and momentum flux (F0 [m2/s], F1 [m3/s2]) of the homogeneous system (B.12)."""
        rho_l = phi_l * h_l
        rho_r = phi_r * h_r
        p_l = Real(0.5) * g_c * rho_l * h_l
        p_r = Real(0.5) * g_c * rho_r * h_r
        s_l = wp.sqrt(g_c * h_l)
        s_r = wp.sqrt(g_c * h_r)
        D = v_l - v_r
        up = p_r >= p_l  # pressure rises to the right
        S_1, S_2 = lagrangian_speeds(
            wp.where(up, p_l, p_r), wp.where(up, rho_l, rho_r), wp.where(up, s_l, s_r),
            wp.where(up, p_r, p_l), wp.where(up, rho_r, rho_l), wp.where(up, s_r, s_l), D,
        )  # fmt: skip
        S_l = wp.where(up, S_1, S_2)
        S_r = wp.where(up, S_2, S_1)
        c_l = rho_l * S_l
        c_r = rho_r * S_r
        per_c = Real(1.0) / wp.max(c_l + c_r, tiny)
        v_star = (c_l * v_l + c_r * v_r + p_l - p_r) * per_c
        p_star = (c_r * p_l + c_l * p_r + c_l * c_r * D) * per_c

        # The upwind side (u), seen along its own direction of flow; downwind (d).
        to_right = v_star >= Real(0.0)
        rho_u = wp.where(to_right, rho_l, rho_r)
        v_u = wp.where(to_right, v_l, v_r)
        p_u = wp.where(to_right, p_l, p_r)
        S_u = wp.where(to_right, S_l, S_r)
        c_d = wp.where(to_right, c_r, c_l)
        p_d = wp.where(to_right, p_r, p_l)
        # 1/rho* = 1/rho + (p_u - p_d - c_d D)/(c_u c), multiplied by rho c_u c = rho^2 S_u c
        stretched = S_u + (p_u - p_d - c_d * D) * per_c
        rho_star = rho_u * S_u / wp.where(rho_u > Real(0.0), stretched, Real(1.0))
        supersonic = wp.where(to_right, v_u, -v_u) >= S_u
        rho = wp.where(supersonic, rho_u, rho_star)
        speed = wp.where(supersonic, v_u, v_star)
        F0 = rho * speed
        return F0, F0 * speed + wp.where(supersonic, p_u, p_star)

    @wp.func
    def head_source(F0: Real, jump: Real, v: Real, v_over: Real, p: RunParams) -> Real:
        """Last term of (B.31), (B.32) of a side that climbs by `jump` [m]; 0 if it does not climb or rest."""
        gain = p.head * Real(0.5) * positive(v * v - v_over * v_over)
        carried = wp.min(positive(jump), gain)  # (Dz)_+ - Dz*_+
        return wp.where(v == Real(0.0), Real(0.0), F0 * p.g_c * carried / wp.where(v == Real(0.0), Real(1.0), v))

    @wp.func
    def no_source(F0: Real, jump: Real, v: Real, v_over: Real, p: RunParams) -> Real:
        """Last term of (B.31), (B.32) with lambda = 0."""
        return Real(0.0)

    source = no_source if variant.lambda_zero else head_source

    @wp.kernel(module=module)
    def flux(
        h: A, v: A, phi: A, h_l_star: A, h_r_star: A, phi_l_star: A, phi_r_star: A, Dz: A, params: Params,
        lo: Ints, hi: Ints, active: Ints, chunks: int,
        F0: A, F1_l: A, F1_r: A, F2: A,
    ):  # fmt: skip
        """Flux through each interface, its momentum as the cells on the left and on the right see it."""
        t = wp.tid()
        r = run_of(t, chunks)
        p = params[r]
        left = before_first(t, chunks, p.row, lo[r], hi[r])
        end = end_of(t, chunks, p.row, lo[r], hi[r], active[r]) - 1
        half_g = Real(0.5) * p.g_c
        while left < end:
            i = left + 1
            v_l = v[left]
            v_r = v[i]
            h_ls = h_l_star[i]
            h_rs = h_r_star[i]
            phi_ls = phi_l_star[i]
            phi_rs = phi_r_star[i]
            mass, momentum = suliciu(h_ls, v_l, phi_ls, h_rs, v_r, phi_rs, p.g_c)
            lost_l = half_g * (phi[left] * h[left] * h[left] - phi_ls * h_ls * h_ls)
            lost_r = half_g * (phi[i] * h[i] * h[i] - phi_rs * h_rs * h_rs)
            F0[i] = mass
            F1_l[i] = momentum + lost_l + source(mass, Dz[i], v_l, v_r, p)
            F1_r[i] = momentum + lost_r + source(mass, -Dz[i], v_r, v_l, p)
            F2[i] = mass * power(wp.where(mass >= Real(0.0), phi_ls, phi_rs), p)
            left += wp.block_dim()

    return flux
