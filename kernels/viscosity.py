"""Step 11: artificial viscosity."""

from typing import Any

import warp as wp

from warpgran.kernels.precision import Ints, Variant, precision
from warpgran.kernels.ranges import before_first, end_of, run_of


def make(variant: Variant, module: Any) -> Any:
    """The kernel of a variant."""
    kinds = precision(variant.precision)
    Real, A, RunParams, Params = kinds.Real, kinds.Array, kinds.RunParams, kinds.Params

    @wp.func
    def bounded(U0_l: Real, U2_l: Real, s_l: Real, U0_r: Real, U2_r: Real, s_r: Real, p: RunParams) -> Real:
        """Exchange of U2 over k: solid fraction goes with the mass, and diffuses by xi3 on top."""
        donor = wp.where(U0_l > U0_r, s_l, s_r)
        return p.xi1 * donor * (U0_r - U0_l) + p.xi3 * wp.min(U0_l, U0_r) * (s_r - s_l)

    @wp.func
    def paper(U0_l: Real, U2_l: Real, s_l: Real, U0_r: Real, U2_r: Real, s_r: Real, p: RunParams) -> Real:
        """Exchange of U2 over k, literally (3.20)."""
        return p.xi3 * (U2_r - U2_l)

    exchange = {"bounded": bounded, "paper": paper}[variant.viscosity]

    @wp.kernel(module=module)
    def diffuse(
        U0: A, U1: A, U2: A, s: A, iota: A, dt: A, params: Params, lo: Ints, hi: Ints,
        active: Ints, chunks: int,
        U0_new: A, U1_new: A, U2_new: A,
    ):  # fmt: skip
        """Exchange between neighbours through both interfaces of each cell (3.20), k = iota dt/dx^2."""
        t = wp.tid()
        r = run_of(t, chunks)
        p = params[r]
        left = before_first(t, chunks, p.row, lo[r], hi[r])
        end = end_of(t, chunks, p.row, lo[r], hi[r], active[r]) - 1
        ratio = dt[r] / (p.dx * p.dx)
        while left < end:
            i = left + 1
            k_l = iota[i] * ratio
            k_r = iota[left + 2] * ratio
            G2_l = k_l * exchange(U0[left], U2[left], s[left], U0[i], U2[i], s[i], p)
            G2_r = k_r * exchange(U0[i], U2[i], s[i], U0[left + 2], U2[left + 2], s[left + 2], p)
            U0_new[i] = U0[i] + p.xi1 * (k_r * (U0[left + 2] - U0[i]) - k_l * (U0[i] - U0[left]))
            U1_new[i] = U1[i] + p.xi2 * (k_r * (U1[left + 2] - U1[i]) - k_l * (U1[i] - U1[left]))
            U2_new[i] = U2[i] + (G2_r - G2_l)
            left += wp.block_dim()

    return diffuse
