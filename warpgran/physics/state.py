"""What a state means, and a run that is advanced step by step: what both schemes of the reference share."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from warpgran.arrays import Array

if TYPE_CHECKING:
    from warpgran.case.case import Case

Sides = tuple[Array, Array]  # the left and the right side of every interface

DRY = 1e-12
"""A cell holding no more solid than this (m) is dry."""

SCALARS = ("front", "h_max", "v_max", "v_flow", "volume", "mass", "energy")
"""What `Run.scalars` returns, in the order of the kernels: m, m, m/s, m/s, m2, m2, m4/s2."""


class Fields(NamedTuple):
    """What a state decodes to, at cells, shape (cells,): h [m], v [m/s], phi [-]."""

    h: Array
    v: Array
    phi: Array


def decode(U: Array, case: Case) -> Fields:
    """h, v, phi of a state U of shape (3, cells).

    A dry cell has h = v = 0 and the larger phi of its wet neighbours (3.14), phi_stat if it has none.
    """
    U0, U1, U2 = U
    a = case.scheme.alpha - 1.0
    wet = (U0 > DRY) & (U2 > 0.0)
    mass = np.where(wet, U0, 1.0)
    phi = np.where(wet, np.where(wet, U2, 0.0) / mass, 0.0) ** (1.0 / a)
    h = np.where(wet, U0 / np.where(wet, phi, 1.0), 0.0)
    v = np.where(wet, U1 / mass, 0.0)
    wet_l, wet_r = with_ghosts(phi, 0.0, 0.0, periodic=case.scheme.periodic)
    beside = np.maximum(wet_l[:-1], wet_r[1:])
    dry_phi = np.where(beside > 0.0, beside, case.rheology.phi_stat)
    return Fields(h, v, np.where(wet, phi, dry_phi))


def with_ghosts(cells: Array, left: float = 1.0, right: float = 1.0, *, periodic: bool = False) -> Sides:
    """The values on the two sides of every interface.

    Beyond an end stands the end's cell times `left` or `right`; if the ends are periodic, the cell at the other end.
    """
    before, after = (cells[-1], cells[0]) if periodic else (left * cells[0], right * cells[-1])
    padded = np.concatenate(([before], cells, [after]))
    return padded[:-1], padded[1:]


def mirrored(end: str, inward: float) -> float:
    """Velocity beyond an end over that at it: -1 at a wall, and at an open end where grains would flow in, else 1.

    end: "wall" or "open"; inward: velocity at the end [m/s], positive into the grid.
    """
    return -1.0 if end == "wall" or inward > 0.0 else 1.0


class Run(ABC):
    """One run of a case.

    Attributes:
        case: The case, on the cells that U is on.
        U: state (3, cells): phi h [m], phi h v [m2/s], phi^alpha h [m].
        t: time, s.
        steps: steps taken; cell_steps: the same times the cells of each.
    """

    def __init__(self, case: Case) -> None:
        self.case = case
        h, phi = case.initial_state()
        self.U: Array = np.stack((phi * h, phi * h * case.initial_velocity(), phi**case.scheme.alpha * h))
        self.t = 0.0
        self.steps = 0
        self.cell_steps = 0

    @property
    def recorded(self) -> tuple[Array, Case]:
        """The state on the cells of the run proper, and its case."""
        return self.U, self.case

    @property
    def fields(self) -> Fields:
        """h [m], v [m/s], phi [-] at the cells of the run proper."""
        return decode(*self.recorded)

    @abstractmethod
    def step(self, t_out: float = np.inf) -> float:
        """One step, not beyond t_out [s]; returns dt [s]."""

    def advance(self, t_out: float) -> None:
        """Step to the time t_out [s], which is met exactly."""
        while self.t < t_out and self.steps < self.case.time.step_limit:
            self.step(t_out)

    def scalars(self) -> dict[str, float]:
        """Front [m], h_max [m], v_max and v_flow [m/s], volume and mass [m2], energy [m4/s2], as in the series.

        The compacted thickness h_c = phi h/phi_stat is what the solid of a cell would be thick at phi_stat. The front
        is where it falls through h_front; v_flow (largest speed) and volume count only the cells where it is more. mass
        is the volume of solid per unit width; energy is (2.7) per rho_s and unit width.
        """
        U, case = self.recorded
        h, v, phi = decode(U, case)
        rho, g_c = phi * h, case.g_c
        h_c = rho / case.rheology.phi_stat
        thick = h_c > case.h_front
        energy = rho * (0.5 * v**2 + 0.5 * g_c * h + g_c * case.bhat)
        return {
            "front": _front(h_c, case),
            "h_max": float(h.max()),
            "v_max": float(np.abs(v).max()),
            "v_flow": float(np.abs(v[thick]).max(initial=0.0)),
            "volume": float(h[thick].sum() * case.dx),
            "mass": float(U[0].sum() * case.dx),
            "energy": float(energy.sum() * case.dx),
        }


def _front(h_c: Array, case: Case) -> float:
    """Largest x [m] where the compacted thickness h_c [m] falls through h_front, linear between cell centres."""
    x, level = case.x, case.h_front
    thick = np.flatnonzero(h_c > level)
    if thick.size == 0:
        return float(case.grid.left)
    i = thick[-1]
    if i == h_c.size - 1:
        return float(x[i])
    return float(x[i] + (h_c[i] - level) / (h_c[i] - h_c[i + 1]) * case.dx)
