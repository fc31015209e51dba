"""Output of the runs that have reached an output time: whether they are sound, their series, their snapshots.

One block a run, whose lanes share its cells. It stands before the time step, so that what is recorded is what the
next step starts from, and no run waits for another at an output time. It is launched at every step, and leaves at once
the runs that are not due.
"""

import functools
from enum import IntEnum
from typing import Any, NamedTuple

import warp as wp

from warpgran.kernels.clock import AT_REST, DIVERGED, OK, STEP_LIMIT
from warpgran.kernels.lanes import Lanes, lane_of
from warpgran.kernels.precision import DRY, Doubles, Ints, Precision


class Place(IntEnum):
    """Where each scalar stands in a sample.

    v_flow and volume count only the cells whose compacted thickness phi h/phi_stat exceeds h_front.
    """

    FRONT = 0  # m
    H_MAX = 1  # m
    V_MAX = 2  # m/s
    V_FLOW = 3  # m/s
    VOLUME = 4  # m2
    MASS = 5  # m2
    ENERGY = 6  # m4/s2


SCALARS = tuple(place.name.lower() for place in Place)
"""Names of the scalars of a sample, in this order."""

_SCALARS = wp.constant(len(SCALARS))
_OK = wp.constant(OK)
_DIVERGED = wp.constant(DIVERGED)
_STEP_LIMIT = wp.constant(STEP_LIMIT)
_AT_REST = wp.constant(AT_REST)


class Record(NamedTuple):
    """The kernel of this file, and its functions."""

    record: Any
    sound: Any
    at_rest: Any


@functools.cache
def make_sound(kinds: Precision) -> Any:
    """The function of a precision that judges a cell; for modules that honour NaN."""
    Real = kinds.Real

    @wp.func
    def sound(U0: Real, U1: Real, U2: Real) -> bool:
        """Whether a cell's state is finite, its mass not negative and its phi, if it is wet, in (0, 1].

        Written so that a NaN fails. phi <= 1 is U2 <= U0 for every alpha > 1.
        """
        finite = wp.isfinite(U0) and wp.isfinite(U1) and wp.isfinite(U2)
        return finite and U0 >= Real(-DRY) and (U0 <= Real(DRY) or (U2 > Real(0.0) and U2 <= U0))

    return sound


def make(kinds: Precision, lanes: Lanes, module: Any) -> Record:
    """The kernel of a precision; the module must be one that honours NaN."""
    A, RunParams, Params = kinds.Array, kinds.RunParams, kinds.Params
    Sample = wp.types.vector(length=len(SCALARS), dtype=wp.float64)
    most, least, total = lanes.most, lanes.least, lanes.total
    sound = make_sound(kinds)
    zero = wp.float64(0.0)
    half = wp.float64(0.5)

    @wp.func
    def first_unsound(U0: A, U1: A, U2: A, lane: int, p: RunParams) -> int:
        """The first cell of a lane that is not sound, p.cells if all are."""
        i = int(lane)
        while i < p.cells:
            if not sound(U0[p.row + i], U1[p.row + i], U2[p.row + i]):
                return i
            i += wp.block_dim()
        return p.cells

    @wp.func
    def compacted(h: A, phi: A, i: int, p: RunParams) -> wp.float64:
        """Thickness [m] that the solid of an element would have at phi_stat."""
        return wp.float64(phi[i]) * wp.float64(h[i]) / wp.float64(p.phi_stat)

    @wp.func
    def front(h: A, phi: A, last: int, x_left: wp.float64, p: RunParams) -> wp.float64:
        """Largest x [m] where the compacted thickness falls through h_front; left end of the grid if nowhere.

        Linear between centres. last: the last cell that exceeds h_front, negative if there is none.
        """
        if last < 0:
            return x_left
        at = wp.float64(last) + half
        if last < p.cells - 1:
            h_c = compacted(h, phi, p.row + last, p)
            at += (h_c - wp.float64(p.h_front)) / (h_c - compacted(h, phi, p.row + last + 1, p))
        return x_left + at * wp.float64(p.dx)

    @wp.func
    def measure(
        U0: A, h: A, v: A, phi: A, bhat: A, lo: int, hi: int, x_left: wp.float64, lane: int, p: RunParams
    ) -> Sample:  # fmt: skip
        """The scalars of a run, summed in float64: by each lane from left to right, then over the lanes."""
        h_max = zero
        v_max = zero
        v_flow = zero
        volume = zero
        mass = zero
        energy = zero
        last = int(-1)
        # A cell belongs to a lane whatever the window, so that it has no part in the order of the sums; what is to the
        # left of the window is empty.
        i = lo - lo % wp.block_dim() + lane
        while i < wp.min(hi, p.cells):
            h_i = wp.float64(h[p.row + i])
            v_i = wp.float64(v[p.row + i])
            m_i = wp.float64(U0[p.row + i])
            h_max = wp.max(h_max, h_i)
            v_max = wp.max(v_max, wp.abs(v_i))
            if compacted(h, phi, p.row + i, p) > wp.float64(p.h_front):
                v_flow = wp.max(v_flow, wp.abs(v_i))
                volume += h_i
                last = i
            mass += m_i
            if h_i > zero:
                head = half * h_i + wp.float64(bhat[p.row + i])  # of the centre of mass, m
                energy += m_i * (half * v_i * v_i + wp.float64(p.g_c) * head)
            i += wp.block_dim()
        dx = wp.float64(p.dx)
        sample = Sample()
        sample[Place.FRONT] = front(h, phi, most(last), x_left, p)
        sample[Place.H_MAX] = most(h_max)
        sample[Place.V_MAX] = most(v_max)
        sample[Place.V_FLOW] = most(v_flow)
        sample[Place.VOLUME] = total(volume) * dx
        sample[Place.MASS] = total(mass) * dx
        sample[Place.ENERGY] = total(energy) * dx
        return sample

    @wp.func
    def at_rest(v_flow: wp.float64, v_flow_before: wp.float64, p: RunParams) -> bool:
        """Whether a run is slower than rest_speed and not speeding up, since a mass that starts is slow too."""
        return v_flow < wp.float64(p.rest_speed) and v_flow <= v_flow_before

    @wp.func
    def write(sample: Sample, out: Doubles, at: int, end: int, lane: int):
        """Write a sample to the elements of out from `at` to `end`, as often as it fits."""
        i = int(lane)
        while i < end - at:
            out[at + i] = sample[i % _SCALARS]
            i += wp.block_dim()

    @wp.func
    def copy_row(source: A, p: RunParams, target: A, to: int, lane: int):
        """Copy the cells of a run to element `to` of target and on."""
        i = int(lane)
        while i < p.cells:
            target[to + i] = source[p.row + i]
            i += wp.block_dim()

    @wp.kernel(module=module)
    def record(
        # inputs
        U0: A, U1: A, U2: A, h: A, v: A, phi: A, bhat: A, snapshot_at: Ints, sample_at: Ints, snapshots: int,
        samples: int, padded: int,
        # per run
        params: Params, lo: Ints, hi: Ints, x_left: Doubles, steps: Ints,
        # outputs
        due: Ints, active: Ints, status: Ints, bad_cell: Ints, output: Ints, v_flow: Doubles,
        scalars: Doubles, h_out: A, v_out: A, phi_out: A,
    ):  # fmt: skip
        """Record the runs that are due, retire those that have diverged, come to rest or reached their end.

        snapshot_at, sample_at: for each output time its place among the snapshots and samples, -1 if it is none.
        scalars: (runs, samples, len(SCALARS)); h_out, v_out, phi_out: (runs, snapshots, padded); all flat.
        v_flow: of the last sample [m/s]; x_left: left end of the grid [m].
        """
        thread = wp.tid()
        run = thread // wp.block_dim()
        lane = lane_of(thread)
        if active[run] == 0 or due[run] == 0:
            return
        p = params[run]
        at_output = int(output[run])
        v_flow_before = v_flow[run]
        # No lane gets past this before all have read what the first one writes below.
        bad = least(first_unsound(U0, U1, U2, lane, p))
        outputs = snapshot_at.shape[0]
        after = at_output + 1
        ended = int(_OK)
        if bad < p.cells:
            after = at_output
            ended = _DIVERGED
        elif sample_at[at_output] >= 0:
            at = (run * samples + sample_at[at_output]) * _SCALARS
            end = at + _SCALARS
            sample = measure(U0, h, v, phi, bhat, lo[run], hi[run], x_left[run], lane, p)
            if at_output > 0 and at_rest(sample[Place.V_FLOW], v_flow_before, p):
                ended = _AT_REST
                after = outputs  # what it is now is what it will be at all later times
                end = (run + 1) * samples * _SCALARS
            write(sample, scalars, at, end, lane)
            if lane == 0:
                v_flow[run] = sample[Place.V_FLOW]
        while at_output < after:
            if snapshot_at[at_output] >= 0:
                to = (run * snapshots + snapshot_at[at_output]) * padded
                copy_row(h, p, h_out, to, lane)
                copy_row(v, p, v_out, to, lane)
                copy_row(phi, p, phi_out, to, lane)
            at_output += 1
        if ended == _OK and after < outputs and steps[run] >= p.step_limit:
            ended = _STEP_LIMIT
        if lane == 0:
            due[run] = 0
            output[run] = after
            status[run] = ended
            if ended == _DIVERGED:
                bad_cell[run] = bad
            if after == outputs or ended != _OK:
                active[run] = 0

    return Record(record, sound, at_rest)
