"""Values at the two faces of each cell, by slopes that keep its mass, momentum and phi^alpha h (E4)."""

from typing import Any, NamedTuple

import warp as wp

from warpgran.kernels.precision import Ints, Variant, precision
from warpgran.kernels.ranges import before_first, end_of, run_of
from warpgran.kernels.second.limiter import Limiter


class Faces(NamedTuple):
    """The kernel of this file, and its functions."""

    faces: Any
    of_q: Any
    limit: Any
    weighted: Any


def make(variant: Variant, limiter: Limiter, module: Any) -> Faces:
    """The kernel of a variant."""
    kinds = precision(variant.precision)
    Real, A, Params = kinds.Real, kinds.Array, kinds.Params
    zero, half, one = Real(0.0), Real(0.5), Real(1.0)
    half_lim, clip = limiter.half_lim, limiter.clip

    @wp.func
    def of_q(q: Real, d_l: Real, d_r: Real) -> Real:
        """b q [m] of a cell, no more than q. d_l, d_r: differences of q on both sides [m]."""
        return clip(half_lim(d_l, d_r, one), q)

    @wp.func
    def limit(b: Real) -> Real:
        """t/2 of a quantity whose weight is 1 - b at L and 1 + b at R."""
        return wp.max(half, one - wp.abs(b))

    @wp.func
    def weighted(z: Real, e: Real, b: Real):
        """z_L, z_R: apart by 2 e, of mean z with the weights 1 - b at L and 1 + b at R."""
        return z - e * (one + b), z + e * (one - b)

    @wp.kernel(module=module)
    def faces(
        # inputs
        q: A, s: A, v: A, c: A,
        # per run
        params: Params, lo: Ints, hi: Ints, active: Ints, chunks: int,
        # outputs
        q_L: A, q_R: A, s_L: A, s_R: A, v_L: A, v_R: A, c_L: A, c_R: A,
    ):  # fmt: skip
        """Values at the left (L) and the right face (R) of each cell; s and c of dry cells are the same at both."""
        thread = wp.tid()
        run = run_of(thread, chunks)
        p = params[run]
        left = before_first(thread, chunks, p.row, lo[run], hi[run])
        end = end_of(thread, chunks, p.row, lo[run], hi[run], active[run]) - 1
        while left < end:
            i = left + 1
            q_i = q[i]
            s_i = s[i]
            v_i = v[i]
            c_i = c[i]
            wet = q_i > zero
            per_q = one / wp.where(wet, q_i, one)
            per_s = one / s_i
            bq = of_q(q_i, q_i - q[left], q[left + 2] - q_i)
            b = bq * per_q
            e_s = half_lim(s_i - s[left], s[left + 2] - s_i, wp.where(wet, limit(b), zero))
            w = b + (one - b * b) * (e_s * per_s)  # mass is 1 - w times that of the cell at L, 1 + w at R
            t_2 = wp.where(wet, limit(w), zero)
            e_v = half_lim(v_i - v[left], v[left + 2] - v_i, t_2)
            e_c = half_lim(c_i - c[left], c[left + 2] - c_i, t_2)
            s_i_L, s_i_R = weighted(s_i, e_s, b)
            v_i_L, v_i_R = weighted(v_i, e_v, w)
            c_i_L, c_i_R = weighted(c_i, e_c, w)
            q_L[i] = q_i - bq
            q_R[i] = q_i + bq
            s_L[i] = s_i_L
            s_R[i] = s_i_R
            v_L[i] = v_i_L
            v_R[i] = v_i_R
            c_L[i] = c_i_L
            c_R[i] = c_i_R
            left += wp.block_dim()

    return Faces(faces, of_q, limit, weighted)
