"""Artificial viscosity."""

from typing import Any, NamedTuple

import warp as wp

from warpgran.kernels.precision import Ints, Variant, precision
from warpgran.kernels.ranges import before_first, end_of, run_of


class Viscosity(NamedTuple):
    """The kernel of this file, and its function."""

    diffuse: Any
    exchange: Any


def make(variant: Variant, module: Any) -> Viscosity:
    """The kernel of a variant."""
    kinds = precision(variant.precision)
    Real, A, RunParams, Params = kinds.Real, kinds.Array, kinds.RunParams, kinds.Params

    @wp.func
    def bounded(U0_l: Real, U2_l: Real, c_l: Real, U0_r: Real, U2_r: Real, c_r: Real, p: RunParams) -> Real:
        """Exchange of U2 over k: solid fraction goes with the mass, and diffuses by xi3 on top."""
        donor = wp.where(U0_l > U0_r, c_l, c_r)
        return p.xi1 * donor * (U0_r - U0_l) + p.xi3 * wp.min(U0_l, U0_r) * (c_r - c_l)

    @wp.func
    def paper(U0_l: Real, U2_l: Real, c_l: Real, U0_r: Real, U2_r: Real, c_r: Real, p: RunParams) -> Real:
        """Exchange of U2 over k, literally (3.20)."""
        return p.xi3 * (U2_r - U2_l)

    exchange = {"bounded": bounded, "paper": paper}[variant.viscosity]

    @wp.kernel(module=module)
    def diffuse(
        # inputs
        W0: A, W1: A, W2: A, c: A, iota: A, dt: A,
        # per run
        params: Params, lo: Ints, hi: Ints, active: Ints, chunks: int,
        # outputs
        U0: A, U1: A, U2: A,
    ):  # fmt: skip
        """U = W and the exchange between neighbours through both interfaces of each cell (3.20), k = iota dt/dx^2."""
        thread = wp.tid()
        run = run_of(thread, chunks)
        p = params[run]
        left = before_first(thread, chunks, p.row, lo[run], hi[run])
        end = end_of(thread, chunks, p.row, lo[run], hi[run], active[run]) - 1
        ratio = dt[run] / (p.dx * p.dx)
        while left < end:
            i = left + 1
            k_l = iota[i] * ratio
            k_r = iota[left + 2] * ratio
            G2_l = k_l * exchange(W0[left], W2[left], c[left], W0[i], W2[i], c[i], p)
            G2_r = k_r * exchange(W0[i], W2[i], c[i], W0[left + 2], W2[left + 2], c[left + 2], p)
            U0[i] = W0[i] + p.xi1 * (k_r * (W0[left + 2] - W0[i]) - k_l * (W0[i] - W0[left]))
            U1[i] = W1[i] + p.xi2 * (k_r * (W1[left + 2] - W1[i]) - k_l * (W1[i] - W1[left]))
            U2[i] = W2[i] + (G2_r - G2_l)
            left += wp.block_dim()

    return Viscosity(diffuse, exchange)
