"""Step 1 and 2: what a state means, U -> h, v, phi (cells), and the friction coefficient mu that it gives."""

from typing import Any, NamedTuple

import warp as wp

from warpgran.kernels.precision import DRY, Ints, Variant, precision
from warpgran.kernels.ranges import before_first, end_of, first_of, run_of
from warpgran.kernels.rheology import Rheology


class Decode(NamedTuple):
    """The kernels of this stage, in the order of launch."""

    decode: Any
    fill: Any
    boundary: Any


def make(variant: Variant, rheology: Rheology, module: Any) -> Decode:
    """The kernels of a variant."""
    kinds = precision(variant.precision)
    Real, A, Params = kinds.Real, kinds.Array, kinds.Params
    dry = Real(DRY)
    properties, friction, phi_at_rest = rheology.properties, rheology.friction, rheology.phi_at_rest

    @wp.kernel(module=module)
    def decode(
        U0: A, U1: A, U2: A, params: Params, lo: Ints, hi: Ints,
        active: Ints, chunks: int,
        h: A, v: A, phi_wet: A, mu: A, per_mass: A, celerity: A,
    ):  # fmt: skip
        """h = U0/phi, v = U1/U0, phi = (U2/U0)^(1/(alpha - 1)), 1/U0, sqrt(g_c h) of wet cells, 0 in dry ones; mu."""
        t = wp.tid()
        r = run_of(t, chunks)
        p = params[r]
        i = first_of(t, chunks, p.row, lo[r], hi[r])
        end = end_of(t, chunks, p.row, lo[r], hi[r], active[r])
        while i < end:
            U1_i = U1[i]
            wet = U0[i] > dry and U2[i] > Real(0.0)
            per_U0, phi, h_i, mu_i = properties(
                wp.where(wet, U0[i], Real(1.0)), U1_i, wp.where(wet, U2[i], Real(1.0)), p
            )
            h[i] = wp.where(wet, h_i, Real(0.0))
            v[i] = wp.where(wet, U1_i * per_U0, Real(0.0))
            phi_wet[i] = wp.where(wet, phi, Real(0.0))
            mu[i] = mu_i
            per_mass[i] = wp.where(wet, per_U0, Real(0.0))
            celerity[i] = wp.where(wet, wp.sqrt(p.g_c * h_i), Real(0.0))
            i += wp.block_dim()

    @wp.kernel(module=module)
    def fill(
        phi_wet: A, params: Params, lo: Ints, hi: Ints,
        active: Ints, chunks: int,
        phi: A, mu: A,
    ):  # fmt: skip
        """Phi of dry cells from their wet neighbours (3.14), phi_stat without any; mu of dry cells, where I = h = 0."""
        t = wp.tid()
        r = run_of(t, chunks)
        p = params[r]
        left = before_first(t, chunks, p.row, lo[r], hi[r])
        end = end_of(t, chunks, p.row, lo[r], hi[r], active[r]) - 1
        phi_eq = phi_at_rest(p)
        while left < end:
            i = left + 1
            wet = phi_wet[i] > Real(0.0)
            beside = wp.max(phi_wet[left], phi_wet[left + 2])
            dry_phi = wp.where(beside > Real(0.0), beside, p.phi_stat)
            mu_i = mu[i]
            phi[i] = wp.where(wet, phi_wet[i], dry_phi)
            mu[i] = wp.where(wet, mu_i, friction(p.mu1, dry_phi, phi_eq, Real(0.0), p))
            left += wp.block_dim()

    @wp.func
    def set_ghost(h: A, v: A, phi: A, mu: A, per_mass: A, celerity: A, ghost: int, cell: int, v_factor: Real):
        h[ghost] = h[cell]
        v[ghost] = v_factor * v[cell]
        phi[ghost] = phi[cell]
        mu[ghost] = -mu[cell]
        per_mass[ghost] = per_mass[cell]
        celerity[ghost] = celerity[cell]

    @wp.kernel(module=module)
    def boundary(params: Params, active: Ints, h: A, v: A, phi: A, mu: A, per_mass: A, celerity: A):
        """Ghost cells: a wall mirrors the cell, an open end copies it.

        The ghost's friction is -mu, so that the interface friction, and with it Dz and iota, is exactly 0 there.
        """
        r = wp.tid()
        p = params[r]
        if active[r] != 0:
            set_ghost(h, v, phi, mu, per_mass, celerity, p.row - 1, p.row, p.v_left)
            set_ghost(h, v, phi, mu, per_mass, celerity, p.row + p.cells, p.row + p.cells - 1, p.v_right)

    return Decode(decode, fill, boundary)
