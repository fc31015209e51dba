"""Output of the runs that have reached an output time: whether they are sound, their series, their snapshots.

One thread a run. It stands between decode and the time step, so that what is recorded is what the next step starts
from, and so that no run waits for another at an output time.
"""

from typing import Any

import warp as wp

from warpgran.kernels.clock import AT_REST, DIVERGED, OK, STEP_LIMIT
from warpgran.kernels.precision import DRY, Doubles, Ints, Precision

SCALARS = ("front", "h_max", "v_max", "v_flow", "volume", "mass", "energy")
"""What a sample holds, in this order: m, m, m/s, m/s, m2, m2, m4/s2. v_flow and volume count only the cells thicker
than h_front."""

_SCALARS = wp.constant(len(SCALARS))
_OK = wp.constant(OK)
_DIVERGED = wp.constant(DIVERGED)
_STEP_LIMIT = wp.constant(STEP_LIMIT)
_AT_REST = wp.constant(AT_REST)


def make(kinds: Precision, module: Any) -> Any:
    """The kernel of a precision; the module must be one that honours NaN."""
    Real, A, RunParams, Params = kinds.Real, kinds.Array, kinds.RunParams, kinds.Params
    zero = wp.float64(0.0)
    half = wp.float64(0.5)

    @wp.func
    def sound(U0: Real, U1: Real, U2: Real) -> bool:
        """Whether a cell's state is finite, its mass not negative and its phi, if it is wet, in (0, 1].

        Written so that a NaN fails. phi <= 1 is U2 <= U0 for every alpha > 1.
        """
        finite = wp.isfinite(U0) and wp.isfinite(U1) and wp.isfinite(U2)
        return finite and U0 >= Real(-DRY) and (U0 <= Real(DRY) or (U2 > Real(0.0) and U2 <= U0))

    @wp.func
    def first_unsound(U0: A, U1: A, U2: A, p: RunParams) -> int:
        """The first cell that is not sound, -1 if all are."""
        i = int(0)
        while i < p.cells:
            if not sound(U0[p.row + i], U1[p.row + i], U2[p.row + i]):
                return i
            i += 1
        return -1

    @wp.func
    def front(h: A, left: wp.float64, hi: int, p: RunParams) -> wp.float64:
        """Largest x [m] where h falls through h_front, linear between centres; left end of the grid if nowhere."""
        i = wp.min(hi, p.cells) - 1
        while i >= 0 and h[p.row + i] <= p.h_front:
            i -= 1
        if i < 0:
            return left
        at = wp.float64(i) + half
        if i < p.cells - 1:
            h_i = wp.float64(h[p.row + i])
            at += (h_i - wp.float64(p.h_front)) / (h_i - wp.float64(h[p.row + i + 1]))
        return left + at * wp.float64(p.dx)

    @wp.func
    def measure(U0: A, h: A, v: A, bhat: A, lo: int, hi: int, left: wp.float64, p: RunParams, out: Doubles, at: int):
        """Write the scalars of a run from element `at` of out on, summed in float64 from left to right."""
        h_max = zero
        v_max = zero
        v_flow = zero
        volume = zero
        mass = zero
        energy = zero
        i = p.row + lo
        while i < p.row + wp.min(hi, p.cells):
            h_i = wp.float64(h[i])
            v_i = wp.float64(v[i])
            m_i = wp.float64(U0[i])
            h_max = wp.max(h_max, h_i)
            v_max = wp.max(v_max, wp.abs(v_i))
            if h[i] > p.h_front:
                v_flow = wp.max(v_flow, wp.abs(v_i))
                volume += h_i
            mass += m_i
            if h_i > zero:
                head = half * h_i + wp.float64(bhat[i])  # of the centre of mass, m
                energy += m_i * (half * v_i * v_i + wp.float64(p.g_c) * head)
            i += 1
        dx = wp.float64(p.dx)
        out[at] = front(h, left, hi, p)
        out[at + 1] = h_max
        out[at + 2] = v_max
        out[at + 3] = v_flow
        out[at + 4] = volume * dx
        out[at + 5] = mass * dx
        out[at + 6] = energy * dx

    @wp.func
    def at_rest(speed: wp.float64, speed_before: wp.float64, p: RunParams) -> bool:
        """Whether a run is slower than rest_speed and not speeding up, since a mass that starts is slow too."""
        return speed < wp.float64(p.rest_speed) and speed <= speed_before

    @wp.func
    def repeat(out: Doubles, at: int, end: int):
        """Copy the sample at element `at` of out to all that follow, up to element `end`."""
        i = at + _SCALARS
        while i < end:
            out[i] = out[i - _SCALARS]
            i += 1

    @wp.func
    def copy_row(source: A, p: RunParams, target: A, to: int):
        """Copy the cells of a run to element `to` of target and on."""
        i = int(0)
        while i < p.cells:
            target[to + i] = source[p.row + i]
            i += 1

    @wp.kernel(module=module)
    def record(
        U0: A, U1: A, U2: A, h: A, v: A, phi: A, bhat: A, lo: Ints, hi: Ints, left: Doubles, params: Params,
        steps: Ints, snapshot_at: Ints, sample_at: Ints, snapshots: int, samples: int, length: int,
        due: Ints, active: Ints, status: Ints, bad_cell: Ints, output: Ints, speed: Doubles,
        scalars: Doubles, h_out: A, v_out: A, phi_out: A,
    ):  # fmt: skip
        """Record the runs that are due, retire those that have diverged, come to rest or reached their end.

        snapshot_at, sample_at: for each output time its place among the snapshots and samples, -1 if it is none.
        scalars: (runs, samples, len(SCALARS)); h_out, v_out, phi_out: (runs, snapshots, length); all flat.
        """
        r = wp.tid()
        if active[r] == 0 or due[r] == 0:
            return
        due[r] = 0
        p = params[r]
        k = int(output[r])
        bad = first_unsound(U0, U1, U2, p)
        if bad >= 0:
            bad_cell[r] = bad
            status[r] = _DIVERGED
            active[r] = 0
            return
        outputs = snapshot_at.shape[0]
        after = k + 1
        if sample_at[k] >= 0:
            at = (r * samples + sample_at[k]) * _SCALARS
            measure(U0, h, v, bhat, lo[r], hi[r], left[r], p, scalars, at)
            if k > 0 and at_rest(scalars[at + 3], speed[r], p):
                status[r] = _AT_REST
                after = outputs  # what it is now is what it will be at all later times
                repeat(scalars, at, (r + 1) * samples * _SCALARS)
            speed[r] = scalars[at + 3]
        while k < after:
            if snapshot_at[k] >= 0:
                to = (r * snapshots + snapshot_at[k]) * length
                copy_row(h, p, h_out, to)
                copy_row(v, p, v_out, to)
                copy_row(phi, p, phi_out, to)
            k += 1
        output[r] = after
        if after < outputs and status[r] == _OK and steps[r] >= p.step_limit:
            status[r] = _STEP_LIMIT
        if after == outputs or status[r] != _OK:
            active[r] = 0

    return record
