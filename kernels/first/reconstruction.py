"""Apparent topography and reconstructed states at interfaces."""

from typing import Any, NamedTuple

import warp as wp

from warpgran.kernels.laws import Laws
from warpgran.kernels.precision import Ints, Variant, precision
from warpgran.kernels.ranges import before_first, end_of, run_of


class FirstReconstruction(NamedTuple):
    """The kernel of this file, and its functions."""

    reconstruct: Any
    apparent_slope: Any
    reconstructed: Any
    climb: Any


def make(variant: Variant, laws: Laws, module: Any) -> FirstReconstruction:
    """The kernel of a variant."""
    kinds = precision(variant.precision)
    Real, A, RunParams, Params = kinds.Real, kinds.Array, kinds.RunParams, kinds.Params
    tiny = Real(kinds.tiny)
    power, root = laws.power, laws.root

    @wp.func
    def projection(x: Real, mu: Real) -> Real:
        """proj_mu (3.11)."""
        return wp.min(wp.max(x, -mu), mu)

    @wp.func
    def apparent_slope(X: Real, Y: Real, mu: Real) -> Real:
        """Slope of the apparent topography, Proj_mu(X, Y) (3.10)."""
        against = wp.where(Y > Real(0.0), -X, X)
        # 2 Y/(1 + max(1, against/mu)), with one division
        push = Real(2.0) * Y * mu / wp.max(mu + wp.max(mu, against), tiny)
        return projection(projection(X, mu) + push, mu)

    @wp.func
    def reconstructed(h: Real, phi: Real, per_mass: Real, phi_over: Real, z: Real, p: RunParams):
        """h* [m] and phi* of the side that climbs by z [m] toward phi_over (B.23), (B.24), (B.26), (B.27).

        per_mass: 1/(phi h), for phi_over/phi and h*/h without a division; 0 if dry, which gives h* = 0.
        """
        deficit = wp.max(Real(1.0) - power(phi_over * (h * per_mass), p), Real(0.0))
        regain = wp.min(h * deficit * p.per_2a, z * p.per_2alpha_1)
        h_star = wp.max(h + regain - z, Real(0.0))
        lowered = wp.max(phi * root(h_star * (phi * per_mass), p), phi_over)
        return h_star, wp.where(phi_over < phi, lowered, phi)

    @wp.func
    def full_climb(Dz: Real, v_l: Real, v_r: Real, p: RunParams) -> Real:
        """Height climbed [m] with lambda = 0 (B.16)."""
        return wp.abs(Dz)

    @wp.func
    def climb_with_head(Dz: Real, v_l: Real, v_r: Real, p: RunParams) -> Real:
        """Height climbed [m] less the part that the kinetic head carries (B.16)."""
        head = wp.where(Dz > Real(0.0), v_l * v_l - v_r * v_r, v_r * v_r - v_l * v_l)
        return wp.max(wp.abs(Dz) - p.head * Real(0.5) * wp.max(head, Real(0.0)), Real(0.0))

    climb = full_climb if variant.lambda_zero else climb_with_head

    @wp.kernel(module=module)
    def reconstruct(
        # inputs
        h: A, v: A, phi: A, mu: A, per_mass: A, v_f: A, X: A, dbhat: A, dt: A,
        # per run
        params: Params, lo: Ints, hi: Ints, active: Ints, chunks: int,
        # outputs
        h_star: A, phi_star: A, Dz: A, iota: A,
    ):  # fmt: skip
        """The jump Dz at each interface, and the state of the side that climbs it; the other side keeps its own.

        The left side climbs if Dz > 0, the right side else.
        """
        thread = wp.tid()
        run = run_of(thread, chunks)
        p = params[run]
        left = before_first(thread, chunks, p.row, lo[run], hi[run])
        end = end_of(thread, chunks, p.row, lo[run], hi[run], active[run]) - 1
        per_g_dt = Real(1.0) / (p.g_c * dt[run])
        while left < end:
            i = left + 1
            mu_f = Real(0.5) * (mu[left] + mu[i])
            jump = dbhat[i] + p.dx * apparent_slope(X[i], v_f[i] * per_g_dt, mu_f)

            rising = jump > Real(0.0)
            h_climbing = wp.where(rising, h[left], h[i])
            phi_climbing = wp.where(rising, phi[left], phi[i])
            per_mass_climbing = wp.where(rising, per_mass[left], per_mass[i])
            phi_over = wp.where(rising, phi[i], phi[left])
            z = climb(jump, v[left], v[i], p)
            h_i, phi_i = reconstructed(h_climbing, phi_climbing, per_mass_climbing, phi_over, z, p)

            h_star[i] = h_i
            phi_star[i] = phi_i
            Dz[i] = jump
            iota[i] = wp.max(v_f[i] * jump, Real(0.0))
            left += wp.block_dim()

    return FirstReconstruction(reconstruct, apparent_slope, reconstructed, climb)
