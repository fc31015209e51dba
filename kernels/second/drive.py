"""The drive at interfaces (E2), in units of q: X is what pressure and gravity ask for, P what friction takes of it."""

from typing import Any, NamedTuple

import warp as wp

from warpgran.kernels.precision import Ints, Variant, precision
from warpgran.kernels.ranges import before_first, end_of, run_of
from warpgran.kernels.second.limiter import Limiter

HUGE = 1e30
"""Bound on the jump where friction does not hold (m): more than any jump."""


class SecondDrive(NamedTuple):
    """The kernel of this file, and its functions."""

    drive: Any
    share_of: Any
    friction: Any
    at_interface: Any


def make(variant: Variant, limiter: Limiter, module: Any) -> SecondDrive:
    """The kernel of a variant."""
    kinds = precision(variant.precision)
    Real, A, Params = kinds.Real, kinds.Array, kinds.Params
    zero, half, one, tiny, huge = Real(0.0), Real(0.5), Real(1.0), Real(kinds.tiny), Real(HUGE)
    clip = limiter.clip

    @wp.func
    def share_of(m_l: Real, m_r: Real) -> Real:
        """Share of the left cell in the mass of both, 1/2 if both are dry."""
        m = m_l + m_r
        return wp.where(m > zero, m_l / wp.where(m > zero, m, one), half)

    @wp.func
    def friction(X: Real, M: Real, Y2: Real) -> Real:
        """P [m], what friction takes of X and of the velocity, (3.10) in units of q.

        M: the most that it takes [m]; Y2: 2 Y, what would stop the grains [m].
        """
        against = wp.where(Y2 > zero, -X, X)
        return clip(clip(X, M) + M * Y2 / wp.max(M + wp.max(M, against), tiny), M)

    @wp.func
    def at_interface(
        q_l: Real, s_l: Real, v_l: Real, mu_l: Real, q_r: Real, s_r: Real, v_r: Real, mu_r: Real,
        drop: Real, dx: Real, dx_2_per_g_dt: Real,
    ):  # fmt: skip
        """X, P [m], share, hold [m] and unused friction coefficient of an interface (E2).

        drop: bhat_r - bhat_l [m]; dx_2_per_g_dt: 2 dx/(g_c dt) [s].
        """
        share = share_of(s_l * q_l, s_r * q_r)
        mu = mu_r + share * (mu_l - mu_r)
        v_f = v_r + share * (v_l - v_r)
        s_f = half * (s_l + s_r)
        X = q_l - q_r - s_f * drop
        s_dx = s_f * dx
        M = s_dx * mu
        P = friction(X, M, s_f * v_f * dx_2_per_g_dt)
        hold = wp.where(wp.abs(P) < M, wp.abs(P - X), huge)
        unused = wp.where(wp.abs(X) <= M, mu - wp.abs(P) / s_dx, zero)
        return X, P, share, hold, unused

    @wp.kernel(module=module)
    def drive(
        # inputs
        q: A, s: A, v: A, mu: A, drop: A, dt: A,
        # per run
        params: Params, lo: Ints, hi: Ints, active: Ints, chunks: int,
        # outputs
        X: A, P: A, share: A, hold: A, unused: A,
    ):  # fmt: skip
        """X, P, share, hold and unused friction of the interface on the left of each cell."""
        thread = wp.tid()
        run = run_of(thread, chunks)
        p = params[run]
        left = before_first(thread, chunks, p.row, lo[run], hi[run])
        end = end_of(thread, chunks, p.row, lo[run], hi[run], active[run]) - 1
        dx_2_per_g_dt = Real(2.0) * p.dx / (p.g_c * dt[run])
        while left < end:
            i = left + 1
            X_i, P_i, share_i, hold_i, unused_i = at_interface(
                q[left], s[left], v[left], mu[left], q[i], s[i], v[i], mu[i], drop[i], p.dx, dx_2_per_g_dt
            )
            X[i] = X_i
            P[i] = P_i
            share[i] = share_i
            hold[i] = hold_i
            unused[i] = unused_i
            left += wp.block_dim()

    return SecondDrive(drive, share_of, friction, at_interface)
