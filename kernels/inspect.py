"""What is looked at between steps: whether a run is sound, and the scalars of its series."""

from typing import Any, NamedTuple

import warp as wp
from warpgran.kernels.precision import DRY, Doubles, Ints, Variant, precision

SCALARS = ("front", "h_max", "v_max", "v_flow", "volume", "mass", "energy")
"""What `measure` writes, in the order of its columns: m, m, m/s, m/s, m2, m2, m4/s2. v_flow and volume count only the
cells thicker than h_front."""


class Inspect(NamedTuple):
    """The kernels of this stage."""

    check: Any
    measure: Any


def make(variant: Variant, module: Any) -> Inspect:
    """The kernels of a variant; the module must be one that honours NaN."""
    kinds = precision(variant.precision)
    Real, A, RunParams, Params = kinds.Real, kinds.Array, kinds.RunParams, kinds.Params

    @wp.func
    def sound(U0: Real, U1: Real, U2: Real) -> bool:
        """Whether a cell's state is finite, its mass not negative and its phi, if it is wet, in (0, 1].

        Written so that a NaN fails. phi <= 1 is U2 <= U0 for every alpha > 1.
        """
        finite = wp.isfinite(U0) and wp.isfinite(U1) and wp.isfinite(U2)
        return finite and U0 >= Real(-DRY) and (U0 <= Real(DRY) or (U2 > Real(0.0) and U2 <= U0))

    @wp.kernel(module=module)
    def check(U0: A, U1: A, U2: A, params: Params, bad_cell: Ints):
        """The first cell of each run that is not sound; -1 if all are."""
        r = wp.tid()
        p = params[r]
        bad = int(-1)
        i = p.cells - 1
        while i >= 0:
            if not sound(U0[p.row + i], U1[p.row + i], U2[p.row + i]):
                bad = i
            i -= 1
        bad_cell[r] = bad

    @wp.func
    def front(h: A, left: wp.float64, p: RunParams) -> wp.float64:
        """Largest x [m] where h falls through h_front, linear between centres; left end of the grid if nowhere."""
        i = p.cells - 1
        while i >= 0 and h[p.row + i] <= p.h_front:
            i -= 1
        if i < 0:
            return left
        at = wp.float64(i) + wp.float64(0.5)
        if i < p.cells - 1:
            h_i = wp.float64(h[p.row + i])
            at += (h_i - wp.float64(p.h_front)) / (h_i - wp.float64(h[p.row + i + 1]))
        return left + at * wp.float64(p.dx)

    @wp.kernel(module=module)
    def measure(
        U0: A, h: A, v: A, bhat: A, left: Doubles, params: Params,
        scalars: wp.array2d(dtype=wp.float64),
    ):  # fmt: skip
        """The scalars of each run, summed in float64 from left to right."""
        r = wp.tid()
        p = params[r]
        h_max = wp.float64(0.0)
        v_max = wp.float64(0.0)
        v_flow = wp.float64(0.0)
        volume = wp.float64(0.0)
        mass = wp.float64(0.0)
        energy = wp.float64(0.0)
        i = p.row
        while i < p.row + p.cells:
            h_i = wp.float64(h[i])
            v_i = wp.float64(v[i])
            m_i = wp.float64(U0[i])
            h_max = wp.max(h_max, h_i)
            v_max = wp.max(v_max, wp.abs(v_i))
            if h[i] > p.h_front:
                v_flow = wp.max(v_flow, wp.abs(v_i))
                volume += h_i
            mass += m_i
            head = wp.float64(0.5) * h_i + wp.float64(bhat[i])  # of the centre of mass, m
            wet_mass = wp.where(h_i > wp.float64(0.0), m_i, wp.float64(0.0))
            energy += wet_mass * (wp.float64(0.5) * v_i * v_i + wp.float64(p.g_c) * head)
            i += 1
        dx = wp.float64(p.dx)
        scalars[r, 0] = front(h, left[r], p)
        scalars[r, 1] = h_max
        scalars[r, 2] = v_max
        scalars[r, 3] = v_flow
        scalars[r, 4] = volume * dx
        scalars[r, 5] = mass * dx
        scalars[r, 6] = energy * dx

    return Inspect(check, measure)
