"""q, s, c of all cells, where dry ones take phi from their neighbours (D), and the friction coefficient (E1)."""

from typing import Any

import warp as wp

from warpgran.kernels.laws import Laws
from warpgran.kernels.precision import Ints, Variant, precision
from warpgran.kernels.ranges import before_first, end_of, run_of
from warpgran.kernels.second.rheology import SecondRheology


def make(variant: Variant, laws: Laws, rheology: SecondRheology, module: Any) -> Any:
    """The kernel of a variant."""
    kinds = precision(variant.precision)
    Real, A, Params = kinds.Real, kinds.Array, kinds.Params
    zero = Real(0.0)
    power, friction = laws.power, rheology.friction

    @wp.kernel(module=module)
    def cells(
        # inputs
        mass: A, v: A, phi_wet: A,
        # per run
        params: Params, lo: Ints, hi: Ints, active: Ints, chunks: int,
        # outputs
        q: A, s: A, c: A, mu: A,
    ):  # fmt: skip
        """q [m], s, c, mu of a state with phi h = mass [m]; a dry cell has the larger phi of its neighbours (3.14)."""
        thread = wp.tid()
        run = run_of(thread, chunks)
        p = params[run]
        left = before_first(thread, chunks, p.row, lo[run], hi[run])
        end = end_of(thread, chunks, p.row, lo[run], hi[run], active[run]) - 1
        while left < end:
            i = left + 1
            own = phi_wet[i]
            beside = wp.max(phi_wet[left], phi_wet[left + 2])
            wet = own > zero
            phi = wp.where(wet, own, wp.where(beside > zero, beside, p.phi_stat))
            h, mu_i = friction(wp.where(wet, mass[i], zero), v[i], phi, p)
            s_i = wp.sqrt(phi)
            q[i] = s_i * h
            s[i] = s_i
            c[i] = power(phi, p)
            mu[i] = mu_i
            left += wp.block_dim()

    return cells
