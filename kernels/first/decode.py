"""From a state U to h, v, phi of cells, and the friction coefficient mu that it gives."""

from typing import Any, NamedTuple

import warp as wp

from warpgran.kernels.first.rheology import FirstRheology
from warpgran.kernels.laws import Laws
from warpgran.kernels.precision import DRY, Ints, Variant, precision
from warpgran.kernels.ranges import before_first, end_of, first_of, run_of


class Decode(NamedTuple):
    """The kernels of this file, in the order of launch."""

    decode: Any
    fill: Any


def make(variant: Variant, laws: Laws, rheology: FirstRheology, module: Any) -> Decode:
    """The kernels of a variant."""
    kinds = precision(variant.precision)
    Real, A, Params = kinds.Real, kinds.Array, kinds.Params
    dry = Real(DRY)
    properties, friction, phi_at_rest = rheology.properties, laws.friction, laws.phi_at_rest

    @wp.kernel(module=module)
    def decode(
        # inputs
        U0: A, U1: A, U2: A,
        # per run
        params: Params, lo: Ints, hi: Ints, active: Ints, chunks: int,
        # outputs
        h: A, v: A, phi_wet: A, mu: A, per_mass: A, celerity: A,
    ):  # fmt: skip
        """h = U0/phi, v = U1/U0, phi = (U2/U0)^(1/(alpha - 1)), 1/U0, sqrt(g_c h) of wet cells, 0 in dry ones; mu."""
        thread = wp.tid()
        run = run_of(thread, chunks)
        p = params[run]
        i = first_of(thread, chunks, p.row, lo[run], hi[run])
        end = end_of(thread, chunks, p.row, lo[run], hi[run], active[run])
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
        # inputs
        phi_wet: A,
        # per run
        params: Params, lo: Ints, hi: Ints, active: Ints, chunks: int,
        # outputs
        phi: A, mu: A,
    ):  # fmt: skip
        """Phi of all cells: of dry ones (3.14), phi_stat without a wet neighbour. mu of dry ones, where I = h = 0."""
        thread = wp.tid()
        run = run_of(thread, chunks)
        p = params[run]
        left = before_first(thread, chunks, p.row, lo[run], hi[run])
        end = end_of(thread, chunks, p.row, lo[run], hi[run], active[run]) - 1
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

    return Decode(decode, fill)
