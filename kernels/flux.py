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
    def lagrangian_speeds(dp: Real, rho_1: Real, s_1: Real, rho_2: Real, s_2: Real, D: Real):
        """Relaxation speeds S_1, S_2 [m/s] of the sides of the lower (1) and the higher pressure (2), apart by dp.

        D = v_l - v_r. Each side's c = rho S; a side without mass has c = 0 and does not speed up the other.
        Bouchut (2004), section 2.4; 3/2 is (gamma + 1)/2 for gamma = 2.
        """
        S_1 = s_1 + Real(1.5) * positive(dp / wp.max(rho_2 * s_2, tiny) + D)
        c_1 = rho_1 * S_1
        rise = positive(D - dp / wp.max(c_1, tiny))
        return S_1, s_2 + Real(1.5) * wp.where(c_1 > Real(0.0), rise, Real(0.0))

    @wp.func
    def intermediate(c: Real, S_u: Real, rise: Real, any: bool):
        """1/c, and rho*/rho of the upwind side. rise: p_u - p_d - c_d D; any: whether that side holds mass."""
        # 1/rho* = 1/rho + rise/(c_u c), multiplied by rho c_u c = rho^2 S_u c
        per_c = Real(1.0) / c
        return per_c, S_u / wp.where(any, S_u + rise * per_c, Real(1.0))

    # The same with one division each. The products underflow in float32 in layers of 1e-12 m, and its divisions are
    # cheap.
    @wp.func
    def lagrangian_speeds_by_one(dp: Real, rho_1: Real, s_1: Real, rho_2: Real, s_2: Real, D: Real):
        """As lagrangian_speeds."""
        b = rho_2 * s_2
        bc = rho_1 * (s_1 * b + Real(1.5) * positive(dp + D * b))  # b c_1
        some_b = wp.max(b, tiny)
        some_bc = wp.max(bc, tiny)
        r = Real(1.0) / (some_b * some_bc)
        S_1 = s_1 + Real(1.5) * positive(dp * (some_bc * r) + D)
        rise = positive(D - dp * (b * (some_b * r)))
        return S_1, s_2 + Real(1.5) * wp.where(bc > Real(0.0), rise, Real(0.0))

    @wp.func
    def intermediate_by_one(c: Real, S_u: Real, rise: Real, any: bool):
        """As intermediate."""
        whole = wp.where(any, S_u * c + rise, Real(1.0))
        r = Real(1.0) / (c * whole)
        return whole * r, S_u * c * (c * r)

    speeds, between = lagrangian_speeds, intermediate
    if kinds.name == "float64":
        speeds, between = lagrangian_speeds_by_one, intermediate_by_one

    @wp.func
    def suliciu(
        rho_l: Real, v_l: Real, p_l: Real, s_l: Real, rho_r: Real, v_r: Real, p_r: Real, s_r: Real,
    ):  # fmt: skip
        """Mass and momentum flux (F0 [m2/s], F1 [m3/s2]) of the homogeneous system (B.12).

        Of each side: rho = phi h [m], v [m/s], p = g_c phi h^2/2 [m3/s2], s = sqrt(g_c h) [m/s].
        """
        D = v_l - v_r
        up = p_r >= p_l  # pressure rises to the right
        S_1, S_2 = speeds(
            wp.abs(p_r - p_l), wp.where(up, rho_l, rho_r), wp.where(up, s_l, s_r),
            wp.where(up, rho_r, rho_l), wp.where(up, s_r, s_l), D,
        )  # fmt: skip
        S_l = wp.where(up, S_1, S_2)
        S_r = wp.where(up, S_2, S_1)
        c_l = rho_l * S_l
        c_r = rho_r * S_r
        c = wp.max(c_l + c_r, tiny)
        push = c_l * v_l + c_r * v_r + p_l - p_r  # c v*

        # The upwind side (u), seen along its own direction of flow; downwind (d).
        to_right = push >= Real(0.0)
        rho_u = wp.where(to_right, rho_l, rho_r)
        v_u = wp.where(to_right, v_l, v_r)
        p_u = wp.where(to_right, p_l, p_r)
        S_u = wp.where(to_right, S_l, S_r)
        c_d = wp.where(to_right, c_r, c_l)
        p_d = wp.where(to_right, p_r, p_l)
        per_c, ratio = between(c, S_u, p_u - p_d - c_d * D, rho_u > Real(0.0))
        v_star = push * per_c
        p_star = (c_r * p_l + c_l * p_r + c_l * c_r * D) * per_c
        supersonic = wp.where(to_right, v_u, -v_u) >= S_u
        rho = wp.where(supersonic, rho_u, rho_u * ratio)
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
        h: A, v: A, phi: A, celerity: A, h_star: A, phi_star: A, Dz: A, params: Params,
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
            rising = Dz[i] > Real(0.0)  # the left side climbs and is reconstructed (s), else the right side
            v_l = v[left]
            v_r = v[i]
            rho_l = phi[left] * h[left]
            rho_r = phi[i] * h[i]
            p_l = half_g * rho_l * h[left]
            p_r = half_g * rho_r * h[i]
            rho_s = phi_star[i] * h_star[i]
            p_s = half_g * rho_s * h_star[i]
            s_s = wp.sqrt(p.g_c * h_star[i])
            mass, momentum = suliciu(
                wp.where(rising, rho_s, rho_l), v_l, wp.where(rising, p_s, p_l), wp.where(rising, s_s, celerity[left]),
                wp.where(rising, rho_r, rho_s), v_r, wp.where(rising, p_r, p_s), wp.where(rising, celerity[i], s_s),
            )  # fmt: skip
            F0[i] = mass
            F1_l[i] = momentum + wp.where(rising, p_l - p_s, Real(0.0)) + source(mass, Dz[i], v_l, v_r, p)
            F1_r[i] = momentum + wp.where(rising, Real(0.0), p_r - p_s) + source(mass, -Dz[i], v_r, v_l, p)
            phi_u = wp.where(mass >= Real(0.0), phi[left], phi[i])
            F2[i] = mass * power(wp.where(rising == (mass >= Real(0.0)), phi_star[i], phi_u), p)
            left += wp.block_dim()

    return flux
