"""Update and stop (E7, E8) at the end of both stages; after the second the mean, the stop and dilatancy (R)."""

from typing import Any, NamedTuple

import warp as wp

from warpgran.kernels.lanes import Lanes, lane_of
from warpgran.kernels.precision import Ints, Variant, precision
from warpgran.kernels.ranges import end_of, first_of, run_of
from warpgran.kernels.second.limiter import Limiter
from warpgran.kernels.second.rheology import SecondRheology


class Update(NamedTuple):
    """The kernels of this file, and their functions."""

    end_first: Any
    end_second: Any
    fastest: Any
    stopped: Any


def make(variant: Variant, rheology: SecondRheology, limiter: Limiter, lanes: Lanes, module: Any) -> Update:
    """The kernels of a variant."""
    kinds = precision(variant.precision)
    Real, A, RunParams, Params = kinds.Real, kinds.Array, kinds.RunParams, kinds.Params
    zero, half, one = Real(0.0), Real(0.5), Real(1.0)
    clip, most = limiter.clip, lanes.most
    is_wet, motion, relaxed = rheology.wet, rheology.motion, rheology.relaxed

    @wp.func
    def stopped(U1: Real, U0: Real, allowed: Real) -> Real:
        """U1 [m2/s] less what friction that is left takes of it (E8). U0: phi h [m]; allowed: of velocity [m/s]."""
        return U1 - clip(U1, wp.max(zero, U0) * allowed)

    @wp.func
    def speed(U0: Real, v: Real, phi: Real, p: RunParams) -> Real:
        """The fastest wave of a wet cell [m/s]."""
        return wp.abs(v) + wp.sqrt(p.g_c * U0 / phi)

    @wp.kernel(module=module)
    def end_first(
        # inputs
        U0: A, U1: A, U2: A, F0: A, E_l: A, E_r: A, F2: A, SX: A, SP: A, allowance: A, q: A, dt: A,
        # per run
        params: Params, lo: Ints, hi: Ints, active: Ints, chunks: int,
        # outputs
        W0: A, W1: A, W2: A, v: A, phi_wet: A,
    ):  # fmt: skip
        """The state W that the first stage leaves, and its v [m/s] and phi, 0 in dry cells."""
        thread = wp.tid()
        run = run_of(thread, chunks)
        p = params[run]
        i = first_of(thread, chunks, p.row, lo[run], hi[run])
        end = end_of(thread, chunks, p.row, lo[run], hi[run], active[run])
        beyond = p.row + p.cells  # the ghost cell and the padding are not updated
        dt_dx = dt[run] / p.dx
        while i < end:
            ratio = wp.where(i < beyond, dt_dx, zero)
            W0_i = U0[i] - ratio * (F0[i + 1] - F0[i])
            W1_i = U1[i] - ratio * (E_l[i + 1] - E_r[i] + p.g_c * q[i] * (SX[i] + SP[i]))
            W2_i = U2[i] - ratio * (F2[i + 1] - F2[i])
            W1_i = stopped(W1_i, W0_i, allowance[i])
            wet = is_wet(W0_i, W2_i)
            mass = wp.where(wet, W0_i, one)
            v_i, phi = motion(mass, W1_i, wp.where(wet, W2_i, one), p)
            W0[i] = W0_i
            W1[i] = W1_i
            W2[i] = W2_i
            v[i] = wp.where(wet, v_i, zero)
            phi_wet[i] = wp.where(wet, phi, zero)
            i += wp.block_dim()

    @wp.kernel(module=module)
    def end_second(
        # inputs
        W0: A, W1: A, W2: A, F0: A, E_l: A, E_r: A, F2: A, SX: A, SP: A, allowance: A, q: A, dt: A,
        # per run
        params: Params, lo: Ints, hi: Ints, active: Ints, chunks: int,
        # outputs
        U0: A, U1: A, U2: A, max_speed: A,
    ):  # fmt: skip
        """The state U at the end of the step, in place of that from its beginning, and the fastest wave of a run."""
        thread = wp.tid()
        run = run_of(thread, chunks)
        p = params[run]
        i = first_of(thread, chunks, p.row, lo[run], hi[run])
        end = end_of(thread, chunks, p.row, lo[run], hi[run], active[run])
        beyond = p.row + p.cells
        dt_dx = dt[run] / p.dx
        tau = half * dt[run]
        fast = zero
        while i < end:
            ratio = wp.where(i < beyond, dt_dx, zero)
            allowed = allowance[i]
            U0_i = W0[i] - ratio * (F0[i + 1] - F0[i])
            U1_i = W1[i] - ratio * (E_l[i + 1] - E_r[i] + p.g_c * q[i] * (SX[i] + SP[i]))
            U2_i = W2[i] - ratio * (F2[i + 1] - F2[i])
            U1_i = stopped(U1_i, U0_i, allowed)
            U0_i = half * (U0[i] + U0_i)
            U1_i = half * (U1[i] + U1_i)
            U2_i = half * (U2[i] + U2_i)
            U1_i = stopped(U1_i, U0_i, allowed)
            wet = is_wet(U0_i, U2_i)
            mass = wp.where(wet, U0_i, one)
            v_i, phi, U2_new = relaxed(mass, U1_i, wp.where(wet, U2_i, one), tau, p)
            fast = wp.max(fast, wp.where(wet, speed(mass, v_i, phi, p), zero))
            U0[i] = U0_i
            U1[i] = U1_i
            U2[i] = wp.where(wet, U2_new, U2_i)
            i += wp.block_dim()
        fast = most(fast)
        if lane_of(thread) == 0 and active[run] != 0:
            wp.atomic_max(max_speed, run, fast)

    @wp.kernel(module=module)
    def fastest(
        # inputs
        U0: A, U1: A, U2: A,
        # per run
        params: Params, lo: Ints, hi: Ints, active: Ints, chunks: int,
        # outputs
        max_speed: A,
    ):  # fmt: skip
        """The fastest wave of a run, for a state that no step has left."""
        thread = wp.tid()
        run = run_of(thread, chunks)
        p = params[run]
        i = first_of(thread, chunks, p.row, lo[run], hi[run])
        end = end_of(thread, chunks, p.row, lo[run], hi[run], active[run])
        fast = zero
        while i < end:
            wet = is_wet(U0[i], U2[i])
            mass = wp.where(wet, U0[i], one)
            v_i, phi = motion(mass, U1[i], wp.where(wet, U2[i], one), p)
            fast = wp.max(fast, wp.where(wet, speed(mass, v_i, phi, p), zero))
            i += wp.block_dim()
        fast = most(fast)
        if lane_of(thread) == 0 and active[run] != 0:
            wp.atomic_max(max_speed, run, fast)

    return Update(end_first, end_second, fastest, stopped)
