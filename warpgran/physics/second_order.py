"""The scheme of order 2 in NumPy: one run, whole-array expressions.

The equations are (3.1)-(3.3) of `first_order`. With q = sqrt(phi) h and s = sqrt(phi) the solid is s q, the
pressure g_c q^2/2, and the equation of motion (2.4) reads

    phi h (d_t v + v d_x v) = -g_c q (d_x q + s d_x bhat) - friction.

Its right side is the drive. At every interface it is one jump of q, made of the apparent topography: what pressure, bed
and slope ask for, X, less what friction takes of it, P. Where friction holds, P = X, the drive is exactly 0, and the
state stays as it is to the last bit, whatever thickness, bed and phi. Slopes within cells, the force within a cell and
the force at an interface are all made of that jump.

A step is: time step, half a relaxation (R), two stages (E) whose mean with the state before them is taken (Heun's
method), friction's last word on the velocity (E8), half a relaxation. A stage is: rheology at cells (E1), the jumps X
and P (E2), their slopes (E3), the values at the faces of the cells (E4), hydrostatic reconstruction (E5), Suliciu flux
(E6), update (E7), stop (E8). Second order in space and time, stable under the CFL condition alone.

Suffixes `_l` and `_r` are the two sides of an interface, `L` and `R` the left and the right face of a cell; arrays are
(cells,) or, at interfaces, (cells + 1,), the first and last being the two ends of the grid. No code is shared with the
kernels.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from warpgran.arrays import Array
from warpgran.physics.laws import effective_friction, mu_of_I, phi_equilibrium, positive, quotient
from warpgran.physics.state import DRY, Run, Sides, mirrored, with_ghosts

if TYPE_CHECKING:
    from warpgran.case.case import Case

PHI_MIN = 1e-4
"""The relaxation takes phi no lower."""

UNHELD = 1e300
"""A bound on the drive (m) where there is none."""

START_TRAVEL = 20.0
"""A level of the start lasts until the fastest wave of the column at rest has gone so many of its cells."""


class Cells(NamedTuple):
    """What a state decodes to, at cells, shape (cells,): q = sqrt(phi) h [m], s = sqrt(phi), v [m/s], c = s^(2a)."""

    q: Array
    s: Array
    v: Array
    c: Array
    wet: Array


class Drive(NamedTuple):
    """Jumps of q at interfaces, shape (cells + 1,), and what is made of them in cells, shape (cells,).

    X: what pressure, bed and slope ask for [m]; P: what friction takes of it [m]; hold: bound on the jump that remains
    [m]; share: part of the mass that lies on the left side. SX, SP: slopes of -X and P within cells [m]; allowance:
    velocity that unused friction can still take in a stage [m/s].
    """

    X: Array
    P: Array
    hold: Array
    share: Array
    SX: Array
    SP: Array
    allowance: Array


class Faces(NamedTuple):
    """Values at the (left, right) face of every cell, or on the (left, right) side of every interface; as in Cells."""

    q: Sides
    s: Sides
    v: Sides
    c: Sides


class RelativeFlux(NamedTuple):
    """Fluxes at interfaces, shape (cells + 1,); of the momentum, less the pressure of the left and the right side."""

    F0: Array
    E_l: Array
    E_r: Array
    F2: Array


def limited(a: Array, b: Array, t: float | Array) -> Array:
    """lim(a, b, t): the mean of two differences, no more than t times the smaller, 0 where their signs differ."""
    size = np.minimum(t * np.minimum(np.abs(a), np.abs(b)), 0.5 * np.abs(a + b))
    return np.where(a * b > 0.0, np.copysign(size, a), 0.0)


def unknowns(U: Array, case: Case) -> Cells:
    """D: q, s, v, c of a state U of shape (3, cells).

    A dry cell has q = v = 0 and the larger s of its wet neighbours, sqrt(phi_stat) if it has none.
    """
    U0, U1, U2 = U
    a = case.scheme.alpha - 1.0
    wet = (U0 > DRY) & (U2 > 0.0)
    mass = np.where(wet, U0, 1.0)
    c = np.where(wet, U2, 0.0) / mass
    s = np.sqrt(c ** (1.0 / a))
    before, after = with_ghosts(s, 0.0, 0.0, periodic=case.scheme.periodic)
    beside = np.maximum(before[:-1], after[1:])
    s = np.where(wet, s, np.where(beside > 0.0, beside, np.sqrt(case.rheology.phi_stat)))
    return Cells(
        q=np.where(wet, U0, 0.0) / s,
        s=s,
        v=np.where(wet, U1, 0.0) / mass,
        c=np.where(wet, c, s ** (2.0 * a)),
        wet=wet,
    )


def time_step(cells: Cells, case: Case) -> float:
    """Largest stable step [s]; infinite where nothing limits it."""
    speed = np.max(np.abs(cells.v) + np.sqrt(case.g_c * cells.q / cells.s))
    return float(case.scheme.cfl * case.dx / speed) if speed > 0.0 else np.inf


def inertial_number(shear: Array, load: Array, case: Case) -> Array:
    """Inertial number I [-] (2.10), (2.11); 0 where there is no load.

    shear: phi h_e gamma = 2.5 phi |v| [m/s] (2.15); load: phi h_e = max(phi h, phi h_min) [m].
    """
    return quotient(shear * case.rheology.grain_diameter, load * np.sqrt(case.g_c * load))


def relax(U: Array, tau: float, case: Case) -> Array:
    """R: dilatancy relaxation (3.15) of the wet cells that move, over tau [s].

    The midpoint rule, second order; its last factor, the (0, 2) Pade approximation of exp(-y), vanishes where y is
    large. U0 and U1 stay.
    """
    K, a = case.rheology.K, case.scheme.alpha - 1.0
    moving = (U[0] > DRY) & (U[2] > 0.0) & (U[1] != 0.0)
    m, U1, U2 = U[:, moving]
    phi = (U2 / m) ** (1.0 / a)
    w = 2.5 * np.abs(U1) / m

    def equilibrium_and_rate(f: Array) -> tuple[Array, Array]:
        """phi_eq and tau gamma K phi, both at the volume fraction f."""
        load = np.maximum(m, f * case.h_min)
        return phi_equilibrium(inertial_number(w * f, load, case), case), tau * K * w * f**2 / load

    phi_eq, y = equilibrium_and_rate(phi)
    half = phi_eq + (phi - phi_eq) / (1.0 + 0.5 * y)
    phi_eq, y = equilibrium_and_rate(half)
    relaxed = U.copy()
    relaxed[2, moving] = m * np.maximum(PHI_MIN, phi_eq + (phi - phi_eq) / (1.0 + y + 0.5 * y**2)) ** a
    return relaxed


def friction(cells: Cells, case: Case) -> Array:
    """E1: effective friction coefficient mu [-] at cells (2.13), (2.14), with wall friction (4.1)."""
    r = case.rheology
    q, s, v = cells.q, cells.s, cells.v
    phi = s**2
    I = inertial_number(2.5 * np.abs(v) * phi, np.maximum(q * s, phi * case.h_min), case)
    tan_psi = r.K * (phi - phi_equilibrium(I, case))  # (2.8)
    return effective_friction(mu_of_I(I, r.mu1, r.mu2, r.I0), tan_psi, r.mu_wall * (q / s) / r.channel_width)


def drive(cells: Cells, drop: Array, dt: float, case: Case) -> Drive:
    """E2, E3: what drives the grains and what friction takes of it, at interfaces and within cells.

    Friction is (3.10), written with one division: no more than M against what it resists, all of it that X and the
    velocity call for if that is less. drop: jump of the total bed at interfaces [m]; dt [s].
    """
    periodic, g_c, dx = case.scheme.periodic, case.g_c, case.dx
    q_l, q_r = with_ghosts(cells.q, periodic=periodic)
    s_l, s_r = with_ghosts(cells.s, periodic=periodic)
    v_l, v_r = with_ghosts(cells.v, periodic=periodic)
    mu_l, mu_r = with_ghosts(friction(cells, case), periodic=periodic)

    m_l, m_r = s_l * q_l, s_r * q_r
    share = np.where(m_l + m_r > 0.0, quotient(m_l, m_l + m_r), 0.5)
    v_f = share * v_l + (1.0 - share) * v_r  # weighted with mass: a nearly dry neighbour has no say
    mu_f = share * mu_l + (1.0 - share) * mu_r
    s_f = 0.5 * (s_l + s_r)

    X = q_l - q_r - s_f * drop
    M = s_f * dx * mu_f
    Y = s_f * dx * v_f / (g_c * dt)
    against = -X * np.sign(Y)
    P = np.clip(np.clip(X, -M, M) + quotient(2.0 * M * Y, M + np.maximum(M, against)), -M, M)
    hold = np.where(np.abs(P) < M, np.abs(P - X), UNHELD)
    unused = np.where(np.abs(X) <= M, mu_f - np.abs(P) / (s_f * dx), 0.0)
    if not periodic:  # no neighbour, no jump: the cells at the ends have that of their other interface on both sides
        for jump in (X, P, unused):
            jump[0], jump[-1] = jump[1], jump[-2]

    SX = -limited(X[:-1], X[1:], 2.0)
    SP = limited(P[:-1], P[1:], 2.0)
    allowance = dt * g_c * positive(np.minimum(unused[:-1], unused[1:]))
    return Drive(X, P, hold, share, SX, SP, allowance)


def slopes(z: Array, t: Array, case: Case, left: float = 1.0, right: float = 1.0) -> Array:
    """Half the limited difference of a quantity over each cell. left, right: beyond the ends, as in `with_ghosts`."""
    z_l, z_r = with_ghosts(z, left, right, periodic=case.scheme.periodic)
    dz = z_r - z_l
    return 0.5 * limited(dz[:-1], dz[1:], t)


def face_values(cells: Cells, case: Case) -> Faces:
    """E4: values at the two faces of every cell, (left, right).

    The means over the two faces, s by q and v and c by mass, are those of the cell, and s, v, c stay between the
    neighbours' values; the limits t see to that. Dry cells have no slopes.
    """
    scheme, (q, s, v, c, wet) = case.scheme, cells
    q_l, q_r = with_ghosts(q, periodic=scheme.periodic)
    dq = q_r - q_l
    rise = limited(dq[:-1], dq[1:], 2.0)
    if not scheme.periodic:  # one difference is all that a cell at an end has
        rise[0] = np.clip(dq[1], -2.0 * q[0], 2.0 * q[0])
        rise[-1] = np.clip(dq[-2], -2.0 * q[-1], 2.0 * q[-1])
    b = quotient(rise, 2.0 * q)

    e = np.where(wet, slopes(s, np.maximum(1.0, 2.0 - 2.0 * np.abs(b)), case), 0.0)
    s_L, s_R = s - e * (1.0 + b), s + e * (1.0 - b)

    w_R = (1.0 + b) * s_R / s  # mass at a face over that of the cell
    w_L = 2.0 - w_R
    t = np.maximum(1.0, 4.0 - 2.0 * np.maximum(w_R, w_L))
    walls = (-1.0 if end == "wall" else 1.0 for end in (scheme.left, scheme.right))
    dv = np.where(wet, slopes(v, t, case, *walls), 0.0)
    dc = np.where(wet, slopes(c, t, case), 0.0)
    return Faces(
        q=(q * (1.0 - b), q * (1.0 + b)),
        s=(s_L, s_R),
        v=(v - dv * w_R, v + dv * w_L),
        c=(c - dc * w_R, c + dc * w_L),
    )


def at_interfaces(faces: Faces, case: Case) -> Faces:
    """The values on the two sides of every interface, (left, right), from those at the faces of the cells.

    Beyond an end of the grid stands that end's own face, its velocity mirrored at walls and where grains would come in.
    """
    scheme = case.scheme

    def facing(values: Sides, left: float = 1.0, right: float = 1.0) -> Sides:
        at_L, at_R = values
        before, after = (at_R[-1], at_L[0]) if scheme.periodic else (left * at_L[0], right * at_R[-1])
        return np.concatenate(([before], at_R)), np.concatenate((at_L, [after]))

    v_L, v_R = faces.v
    mirrors = mirrored(scheme.left, v_L[0]), mirrored(scheme.right, -v_R[-1])
    return Faces(facing(faces.q), facing(faces.s), facing(faces.v, *mirrors), facing(faces.c))


def reconstruct(q: Sides, on: Drive, case: Case) -> Sides:
    """E5: hydrostatic reconstruction over the jump that remains between the faces (Audusse et al. 2004), (left, right).

    Friction that holds may not be turned round by the slopes: the jump is then no larger than P - X.
    """
    (q_l, q_r), share = q, on.share
    SX_l, SX_r = with_ghosts(on.SX, periodic=case.scheme.periodic)
    SP_l, SP_r = with_ghosts(on.SP, periodic=case.scheme.periodic)
    J = -on.X - 0.5 * (SX_l + SX_r) + on.P - (share * SP_l + (1.0 - share) * SP_r)
    J = np.clip(J, -on.hold, on.hold)
    if not case.scheme.periodic:
        J[[0, -1]] = 0.0
    return np.minimum(q_l, positive(q_r - J)), np.minimum(q_r, positive(q_l + J))


def suliciu(q: Sides, s: Sides, v: Sides, dp: Array, case: Case) -> tuple[Array, Array, Array, Array]:
    """E6: Suliciu relaxation solver, relative to the pressures p_l and p_r of the two sides: F0, u, p* - p_l, p* - p_r.

    Gas dynamics with density rho = s q [m], pressure p = g_c q^2/2 and sound speed sqrt(g_c q/s), as `suliciu` of
    `first_order`; no difference is left where pressures are equal. q, s, v: (left, right); dp: p_r - p_l.
    """
    (v_l, v_r), g_c = v, case.g_c
    rho_l, rho_r = s[0] * q[0], s[1] * q[1]
    a_l, a_r = np.sqrt(g_c * q[0] / s[0]), np.sqrt(g_c * q[1] / s[1])
    D = v_l - v_r

    # The side of the lower pressure takes its speed first, the other from it; a side without mass has c = 0.
    right_is_higher = dp >= 0.0
    step = np.abs(dp)
    a_1, a_2 = np.where(right_is_higher, a_l, a_r), np.where(right_is_higher, a_r, a_l)
    rho_1, rho_2 = np.where(right_is_higher, rho_l, rho_r), np.where(right_is_higher, rho_r, rho_l)
    S_1 = a_1 + 1.5 * positive(quotient(step, rho_2 * a_2) + D)
    c_1 = rho_1 * S_1
    S_2 = a_2 + 1.5 * np.where(c_1 > 0.0, positive(quotient(-step, c_1) + D), 0.0)
    S_l, S_r = np.where(right_is_higher, S_1, S_2), np.where(right_is_higher, S_2, S_1)
    c_l, c_r = rho_l * S_l, rho_r * S_r
    k = quotient(np.ones_like(dp), c_l + c_r)

    u = (c_l * v_l + c_r * v_r - dp) * k
    p_l = c_l * (dp + c_r * D) * k
    p_r = c_r * (c_l * D - dp) * k

    to_right = u >= 0.0  # the upwind side, and whether even its fast wave goes downwind
    supersonic = np.where(to_right, v_l - S_l >= 0.0, v_r + S_r <= 0.0)
    rho, c = np.where(to_right, rho_l, rho_r), np.where(to_right, c_l, c_r)
    slower = np.where(to_right, c_r * D + dp, c_l * D - dp) * k
    rho_star = quotient(rho * c, c - rho * slower)
    speed = np.where(supersonic, np.where(to_right, v_l, v_r), u)
    F0 = np.where(supersonic, rho, rho_star) * speed
    p_l = np.where(supersonic, np.where(to_right, 0.0, dp), p_l)
    p_r = np.where(supersonic, np.where(to_right, -dp, 0.0), p_r)
    return F0, speed, p_l, p_r


def interface_flux(sides: Faces, on: Drive, dt: float, case: Case) -> RelativeFlux:
    """E5, E6: fluxes through every interface. No more than half the mass of a cell leaves through one of its faces."""
    (q_l, q_r), (s_l, s_r), (c_l, c_r) = sides.q, sides.s, sides.c
    q_star = reconstruct(sides.q, on, case)
    dp = 0.5 * case.g_c * (q_star[1] ** 2 - q_star[0] ** 2)
    F0, u, p_l, p_r = suliciu(q_star, sides.s, sides.v, dp, case)
    most = 0.5 * case.dx / dt
    F0 = np.clip(F0, -most * (q_r * s_r), most * (q_l * s_l))
    return RelativeFlux(F0, F0 * u + p_l, F0 * u + p_r, F0 * np.where(F0 >= 0.0, c_l, c_r))


def stopped(U: Array, allowance: Array) -> Array:
    """E8: friction that the drive has not used up takes what velocity is left. allowance: (cells,), m/s."""
    U0, U1, U2 = U
    return np.stack((U0, np.copysign(positive(np.abs(U1) - positive(U0) * allowance), U1), U2))


def stage(U: Array, dt: float, drop: Array, case: Case) -> tuple[Array, Array]:
    """E: a state after dt [s], first order in time, and the velocity [m/s] that friction was allowed to take of it."""
    cells = unknowns(U, case)
    on = drive(cells, drop, dt, case)
    flux = interface_flux(at_interfaces(face_values(cells, case), case), on, dt, case)
    force = case.g_c * cells.q * (on.SX + on.SP)
    outflow = np.stack((np.diff(flux.F0), flux.E_l[1:] - flux.E_r[:-1] + force, np.diff(flux.F2)))
    return stopped(U - dt / case.dx * outflow, on.allowance), on.allowance


def step(U: Array, dt: float, drop: Array, case: Case) -> Array:
    """A state after dt [s]. drop: jump of the total bed at interfaces [m]."""
    dilates = case.rheology.K > 0.0
    before = relax(U, 0.5 * dt, case) if dilates else U
    U, _ = stage(before, dt, drop, case)
    U, allowance = stage(U, dt, drop, case)
    U = stopped(0.5 * (before + U), allowance)
    return relax(U, 0.5 * dt, case) if dilates else U


def bed_drop(case: Case) -> Array:
    """Jump of the total bed at interfaces [m], as (b_r - b_l) - dx tan(theta): the slope's part is the same at each.

    Periodic ends are one interface between the last cell and the first; other ends have one side, and no jump is used.
    """
    b_l, b_r = with_ghosts(case.bed, periodic=case.scheme.periodic)
    return (b_r - b_l) - case.dx * np.tan(np.deg2rad(case.slope.angle))


def means_of_pairs(U: Array) -> Array:
    """A state on half as many cells. U: (3, cells)."""
    return 0.5 * (U[:, ::2] + U[:, 1::2])


def end_of_level(case: Case, c_0: float) -> float:
    """When a level of the start ends [s], given its case and c_0, sqrt(g_c max h) of the finest level's state [m/s]."""
    return float(START_TRAVEL * case.dx / c_0) if c_0 > 0.0 else 0.0


class SecondOrder(Run):
    """One run of a case by the scheme of order 2, advanced step by step.

    A start on finer cells (`scheme.start`) begins on the level of the finest; each level hands over to the next coarser
    one until level 0, the cells of the run proper.
    """

    def __init__(self, case: Case) -> None:
        self._levels = [case.refined(level) for level in range(case.scheme.start_levels + 1)]
        self._level = case.scheme.start_levels
        self._drops = [bed_drop(on) for on in self._levels]
        super().__init__(self._levels[-1])
        c_0 = np.sqrt(case.g_c * self.case.initial_state()[0].max())
        self._ends = [np.inf, *(end_of_level(on, c_0) for on in self._levels[1:])]
        self._coarsen()

    @property
    def recorded(self) -> tuple[Array, Case]:
        """The state as means over the cells of the run proper, and its case."""
        U = self.U
        for _ in range(self._level):
            U = means_of_pairs(U)
        return U, self._levels[0]

    def step(self, t_out: float = np.inf) -> float:
        """One step, not beyond t_out [s] nor the end of a level of the start; returns dt [s]."""
        t_out = min(t_out, self._ends[self._level])
        dt = time_step(unknowns(self.U, self.case), self.case)
        last = t_out - self.t <= dt
        dt = t_out - self.t if last else dt
        self.cell_steps += self.case.grid.cells
        self.U = step(self.U, dt, self._drops[self._level], self.case)
        self.t = t_out if last else self.t + dt
        self.steps += 1
        self._coarsen()
        return dt

    def _coarsen(self) -> None:
        """Go to the run proper, or to the level whose time has not come yet."""
        while self.t >= self._ends[self._level]:
            self._level -= 1
            self.U, self.case = means_of_pairs(self.U), self._levels[self._level]
