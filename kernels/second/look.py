"""From a state U to h, v, phi of the runs that are due: no other stage of order 2 needs h and phi as such."""

from typing import Any

import warp as wp

from warpgran.kernels.precision import Ints, Variant, precision
from warpgran.kernels.ranges import end_of, first_of, run_of
from warpgran.kernels.second.rheology import SecondRheology


def make(variant: Variant, rheology: SecondRheology, module: Any) -> Any:
    """The kernel of a variant."""
    kinds = precision(variant.precision)
    Real, A, RunParams, Params = kinds.Real, kinds.Array, kinds.RunParams, kinds.Params
    one, zero = Real(1.0), Real(0.0)
    is_wet, motion = rheology.wet, rheology.motion

    @wp.func
    def decoded_at(U0: A, U1: A, U2: A, i: int, p: RunParams):
        """h [m], v [m/s], phi of an element, all 0 if it is dry."""
        wet = is_wet(U0[i], U2[i])
        mass = wp.where(wet, U0[i], one)
        v, phi = motion(mass, U1[i], wp.where(wet, U2[i], one), p)
        return wp.where(wet, mass / phi, zero), wp.where(wet, v, zero), wp.where(wet, phi, zero)

    @wp.func
    def inside(i: int, p: RunParams) -> int:
        """The element of a neighbour; of the cell itself, which is dry, where there is none."""
        return wp.min(wp.max(i, p.row), p.row + p.cells - 1)

    @wp.func
    def around(i: int, p: RunParams) -> int:
        """The element of a neighbour, beyond one end that at the other."""
        last = p.row + p.cells - 1
        return wp.where(i < p.row, last, wp.where(i > last, p.row, i))

    neighbour = around if variant.periodic else inside

    @wp.kernel(module=module)
    def look(
        # inputs
        U0: A, U1: A, U2: A,
        # per run
        params: Params, lo: Ints, hi: Ints, due: Ints, chunks: int,
        # outputs
        h: A, v: A, phi: A,
    ):  # fmt: skip
        """h, v, phi of cells; dry ones have the larger phi of their wet neighbours (3.14), phi_stat without any."""
        thread = wp.tid()
        run = run_of(thread, chunks)
        p = params[run]
        i = first_of(thread, chunks, p.row, lo[run], hi[run])
        end = wp.min(end_of(thread, chunks, p.row, lo[run], hi[run], due[run]), p.row + p.cells)
        while i < end:
            h_i, v_i, phi_i = decoded_at(U0, U1, U2, i, p)
            _h_l, _v_l, phi_l = decoded_at(U0, U1, U2, neighbour(i - 1, p), p)
            _h_r, _v_r, phi_r = decoded_at(U0, U1, U2, neighbour(i + 1, p), p)
            beside = wp.max(phi_l, phi_r)
            h[i] = h_i
            v[i] = v_i
            phi[i] = wp.where(phi_i > zero, phi_i, wp.where(beside > zero, beside, p.phi_stat))
            i += wp.block_dim()

    return look
