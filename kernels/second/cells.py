"""s and c of all cells, those of dry ones from their neighbours (D), and the friction coefficient (E1)."""

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
        q: A, v: A, s_wet: A,
        # per run
        params: Params, lo: Ints, hi: Ints, active: Ints, chunks: int,
        # outputs
        s: A, c: A, mu: A,
    ):  # fmt: skip
        """s, c = s^(2a), mu; a dry cell has the larger s of its wet neighbours, sqrt(phi_stat) without any."""
        thread = wp.tid()
        run = run_of(thread, chunks)
        p = params[run]
        left = before_first(thread, chunks, p.row, lo[run], hi[run])
        end = end_of(thread, chunks, p.row, lo[run], hi[run], active[run]) - 1
        s_stat = wp.sqrt(p.phi_stat)
        while left < end:
            i = left + 1
            own = s_wet[i]
            beside = wp.max(s_wet[left], s_wet[left + 2])
            s_i = wp.where(own > zero, own, wp.where(beside > zero, beside, s_stat))
            phi = s_i * s_i
            s[i] = s_i
            c[i] = power(phi, p)
            mu[i] = friction(q[i] * s_i, v[i], phi, p)
            left += wp.block_dim()

    return cells
