"""Suliciu relaxation flux between reconstructed states, and the two-sided momentum flux."""

from typing import Any, NamedTuple

import warp as wp

from warpgran.kernels.laws import Laws
from warpgran.kernels.precision import Ints, Variant, precision
from warpgran.kernels.ranges import before_first, end_of, run_of


class FirstFlux(NamedTuple):
    """The kernel of this file and its functions; those that stand twice as (plain, with one division)."""

    flux: Any
    suliciu: Any
    speeds: tuple[Any, Any]
    between: tuple[Any, Any]
    source: Any


def make(variant: Variant, laws: Laws, module: Any) -> FirstFlux:
    """The kernel of a variant."""
    kinds = precision(variant.precision)
    Real, A, RunParams, Params = kinds.Real, kinds.Array, kinds.RunParams, kinds.Params
    tiny = Real(kinds.tiny)
    power = laws.power

    @wp.func
    def positive(x: Real) -> Real:
        """The positive part."""
        return wp.max(x, Real(0.0))

    @wp.func
    def speeds_plain(dp: Real, rho_1: Real, celerity_1: Real, rho_2: Real, celerity_2: Real, D: Real):
        """Relaxation speeds S_1, S_2 [m/s] of the sides of the lower (1) and the higher pressure (2), apart by dp.

        D = v_l - v_r. Each side's C = rho S; a side without mass has C = 0 and does not speed up the other.
        Bouchut (2004), section 2.4; 3/2 is (gamma + 1)/2 for gamma = 2.
        """
        S_1 = celerity_1 + Real(1.5) * positive(dp / wp.max(rho_2 * celerity_2, tiny) + D)
        C_1 = rho_1 * S_1
        rise = positive(D - dp / wp.max(C_1, tiny))
        return S_1, celerity_2 + Real(1.5) * wp.where(C_1 > Real(0.0), rise, Real(0.0))

    @wp.func
    def between_plain(C: Real, S_u: Real, rise: Real, has_mass: bool):
        """1/C, and rho*/rho of the upwind side. rise: p_u - p_d - C_d D; has_mass: whether that side holds any."""
        # 1/rho* = 1/rho + rise/(C_u C), multiplied by rho C_u C = rho^2 S_u C
        per_C = Real(1.0) / C
        return per_C, S_u / wp.where(has_mass, S_u + rise * per_C, Real(1.0))

    # The same with one division each. The products underflow in float32 in layers of 1e-12 m, and its divisions are
    # cheap.
    @wp.func
    def speeds_by_one(dp: Real, rho_1: Real, celerity_1: Real, rho_2: Real, celerity_2: Real, D: Real):
        """`speeds_plain` with one division."""
        b = rho_2 * celerity_2
        bC = rho_1 * (celerity_1 * b + Real(1.5) * positive(dp + D * b))  # b C_1
        some_b = wp.max(b, tiny)
        some_bC = wp.max(bC, tiny)
        per_both = Real(1.0) / (some_b * some_bC)
        S_1 = celerity_1 + Real(1.5) * positive(dp * (some_bC * per_both) + D)
        rise = positive(D - dp * (b * (some_b * per_both)))
        return S_1, celerity_2 + Real(1.5) * wp.where(bC > Real(0.0), rise, Real(0.0))

    @wp.func
    def between_by_one(C: Real, S_u: Real, rise: Real, has_mass: bool):
        """`between_plain` with one division."""
        whole = wp.where(has_mass, S_u * C + rise, Real(1.0))
        per_both = Real(1.0) / (C * whole)
        return whole * per_both, S_u * C * (C * per_both)

    speeds, between = (speeds_plain, speeds_by_one), (between_plain, between_by_one)
    used = 1 if kinds.name == "float64" else 0
    speeds_of, between_of = speeds[used], between[used]

    @wp.func
    def suliciu(
        rho_l: Real, v_l: Real, p_l: Real, celerity_l: Real, rho_r: Real, v_r: Real, p_r: Real, celerity_r: Real,
    ):  # fmt: skip
        """Mass and momentum flux (F0 [m2/s], F1 [m3/s2]) of the homogeneous system (B.12).

        Each side has rho = phi h [m], v [m/s], p = g_c phi h^2/2 [m3/s2] and celerity sqrt(g_c h) [m/s].
        """
        D = v_l - v_r
        up = p_r >= p_l  # pressure rises to the right
        S_1, S_2 = speeds_of(
            wp.abs(p_r - p_l), wp.where(up, rho_l, rho_r), wp.where(up, celerity_l, celerity_r),
            wp.where(up, rho_r, rho_l), wp.where(up, celerity_r, celerity_l), D,
        )  # fmt: skip
        S_l = wp.where(up, S_1, S_2)
        S_r = wp.where(up, S_2, S_1)
        C_l = rho_l * S_l
        C_r = rho_r * S_r
        C = wp.max(C_l + C_r, tiny)
        push = C_l * v_l + C_r * v_r + p_l - p_r  # C v*

        # The upwind side (u), seen along its own direction of flow; downwind (d).
        to_right = push >= Real(0.0)
        rho_u = wp.where(to_right, rho_l, rho_r)
        v_u = wp.where(to_right, v_l, v_r)
        p_u = wp.where(to_right, p_l, p_r)
        S_u = wp.where(to_right, S_l, S_r)
        C_d = wp.where(to_right, C_r, C_l)
        p_d = wp.where(to_right, p_r, p_l)
        per_C, ratio = between_of(C, S_u, p_u - p_d - C_d * D, rho_u > Real(0.0))
        v_star = push * per_C
        p_star = (C_r * p_l + C_l * p_r + C_l * C_r * D) * per_C
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
        # inputs
        h: A, v: A, phi: A, celerity: A, h_star: A, phi_star: A, Dz: A,
        # per run
        params: Params, lo: Ints, hi: Ints, active: Ints, chunks: int,
        # outputs
        F0: A, F1_l: A, F1_r: A, F2: A,
    ):  # fmt: skip
        """Flux through each interface, its momentum as the cells on the left and on the right see it."""
        thread = wp.tid()
        run = run_of(thread, chunks)
        p = params[run]
        left = before_first(thread, chunks, p.row, lo[run], hi[run])
        end = end_of(thread, chunks, p.row, lo[run], hi[run], active[run]) - 1
        half_g = Real(0.5) * p.g_c
        while left < end:
            i = left + 1
            rising = Dz[i] > Real(0.0)  # the left side climbs and is reconstructed (_star), else the right side
            v_l = v[left]
            v_r = v[i]
            rho_l = phi[left] * h[left]
            rho_r = phi[i] * h[i]
            p_l = half_g * rho_l * h[left]
            p_r = half_g * rho_r * h[i]
            rho_star = phi_star[i] * h_star[i]
            p_star = half_g * rho_star * h_star[i]
            celerity_star = wp.sqrt(p.g_c * h_star[i])
            mass, momentum = suliciu(
                wp.where(rising, rho_star, rho_l), v_l, wp.where(rising, p_star, p_l),
                wp.where(rising, celerity_star, celerity[left]),
                wp.where(rising, rho_r, rho_star), v_r, wp.where(rising, p_r, p_star),
                wp.where(rising, celerity[i], celerity_star),
            )  # fmt: skip
            F0[i] = mass
            F1_l[i] = momentum + wp.where(rising, p_l - p_star, Real(0.0)) + source(mass, Dz[i], v_l, v_r, p)
            F1_r[i] = momentum + wp.where(rising, Real(0.0), p_r - p_star) + source(mass, -Dz[i], v_r, v_l, p)
            phi_u = wp.where(mass >= Real(0.0), phi[left], phi[i])
            F2[i] = mass * power(wp.where(rising == (mass >= Real(0.0)), phi_star[i], phi_u), p)
            left += wp.block_dim()

    return FirstFlux(flux, suliciu, speeds, between, source)
