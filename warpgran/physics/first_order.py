"""The scheme of order 1 in NumPy: one run, whole-array expressions, written to be read beside the paper.

Solves, for the state U = (U0, U1, U2) = (phi h, phi h v, phi^alpha h),

    (3.1)  d_t(phi h)       + d_x(phi h v)                      = 0
    (3.2)  d_t(phi h v)     + d_x(phi h v^2 + g_c phi h^2/2)    = -g_c phi h d_x bhat - tau_b sgn(v)/rho_s
    (3.3)  d_t(phi^alpha h) + d_x(phi^alpha h v)                = -(alpha - 1) phi^alpha h gamma tan(psi)

with g_c = g cos(theta), bhat = b - x tan(theta) (theta > 0 is downhill toward +x), friction tau_b = mu rho_s g_c phi h
and the dilatancy law tan(psi) = K (phi - phi_eq(I)). A step is, in this order: decode, rheology, time step, apparent
topography, hydrostatic reconstruction, Suliciu flux, update, dilatancy relaxation, artificial viscosity. First order
in space and time; stable under the CFL condition and the parabolic condition (3.22).

Equation numbers are those of Bouchut, Fernandez-Nieto, Kone, Mangeney and Narbona-Reina, "Dilatancy in dry granular
flows with a compressible mu(I) rheology". This module imports NumPy alone and shares no code with the kernels: it is
what they are compared with, and a readable statement of what they compute. Suffixes `_l` and `_r` are the two sides of
an interface, `_star` a reconstructed or intermediate value; arrays are (cells,) or, at interfaces, (cells + 1,), the
first and last being the two ends of the grid.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from warpgran.arrays import Array
from warpgran.physics.laws import effective_friction, mu_of_I, phi_equilibrium, positive, quotient, shear
from warpgran.physics.state import DRY, Fields, Run, Sides, mirrored, with_ghosts

if TYPE_CHECKING:
    from warpgran.case.case import Case


class Flux(NamedTuple):
    """Fluxes through interfaces, shape (cells + 1,); the momentum seen by the cell on the left, and on the right."""

    F0: Array
    F1_l: Array
    F1_r: Array
    F2: Array


def friction(fields: Fields, case: Case) -> Array:
    """Effective friction coefficient mu [-] at cells (2.13), (2.14), with wall friction (4.1)."""
    r = case.rheology
    h, v, phi = fields
    _, I = shear(h, v, phi, case)
    tan_psi = r.K * (phi - phi_equilibrium(I, case))  # (2.8)
    return effective_friction(mu_of_I(I, r.mu1, r.mu2, r.I0), tan_psi, r.mu_wall * h / r.channel_width)


def apparent_topography(h: Sides, phi: Sides, v_f: Array, mu_f: Array, dbhat: Array, dt: float, case: Case) -> Array:
    """Jump of the total topography Dz [m] (3.6)-(3.12): the bed, and the friction as an apparent bed.

    h, phi: (left, right) at interfaces; v_f [m/s], mu_f [-], dbhat [m] at interfaces; dt [s].
    """
    a, dx = case.scheme.alpha - 1.0, case.dx
    (h_l, h_r), (p_l, p_r) = h, (phi[0] ** a, phi[1] ** a)
    X = (h_l - h_r - dbhat + (h_l + h_r) * (p_l - p_r) / (2.0 * a * (p_l + p_r))) / dx  # (3.12)
    Y = v_f / (case.g_c * dt)
    braking = quotient(-X * np.sign(Y), mu_f)
    inner = np.clip(X, -mu_f, mu_f) + 2.0 * Y / (1.0 + np.maximum(1.0, braking))  # (3.10)
    return dbhat + dx * np.clip(inner, -mu_f, mu_f)


def reconstruct(h_l: Array, phi_l: Array, phi_r: Array, z: Array, toward: Array, alpha: float) -> Sides:
    """Reconstructed h* and phi* of the left side (B.23), (B.26); the right side is its mirror image.

    z: the positive part of the jump that this side climbs [m]; toward: whether the bed rises away from this side.
    """
    a = alpha - 1.0
    deficit = positive(1.0 - (phi_r / phi_l) ** a)
    h_star = positive(h_l + np.minimum(h_l * deficit / (2.0 * a), z / (2.0 * (alpha - 0.5))) - z)
    phi_star = np.maximum(phi_l * quotient(h_star, h_l) ** (1.0 / a), phi_r)
    return h_star, np.where(toward & (phi_r < phi_l), phi_star, phi_l)


def suliciu(h: Sides, v: Sides, phi: Sides, case: Case) -> Sides:
    """Suliciu relaxation flux (F0, F1) of the homogeneous system (B.12).

    Bouchut, Nonlinear stability of finite volume methods (2004), section 2.4: gas dynamics with density
    rho = phi h [m], pressure p = g_c phi h^2/2 and sound speed s = sqrt(g_c h). h, v, phi: (left, right).
    """
    (h_l, h_r), (v_l, v_r), g_c = h, v, case.g_c
    rho_l, rho_r = phi[0] * h_l, phi[1] * h_r
    p_l, p_r = 0.5 * g_c * rho_l * h_l, 0.5 * g_c * rho_r * h_r
    s_l, s_r = np.sqrt(g_c * h_l), np.sqrt(g_c * h_r)
    D = v_l - v_r

    # The side of the lower pressure takes its speed first, the other from it; a side without mass has c = 0.
    right_is_higher = p_r >= p_l
    dp = np.abs(p_r - p_l)
    s_1, s_2 = np.where(right_is_higher, s_l, s_r), np.where(right_is_higher, s_r, s_l)
    rho_1, rho_2 = np.where(right_is_higher, rho_l, rho_r), np.where(right_is_higher, rho_r, rho_l)
    S_1 = s_1 + 1.5 * positive(quotient(dp, rho_2 * s_2) + D)
    c_1 = rho_1 * S_1
    S_2 = s_2 + 1.5 * np.where(c_1 > 0.0, positive(quotient(-dp, c_1) + D), 0.0)
    S_l, S_r = np.where(right_is_higher, S_1, S_2), np.where(right_is_higher, S_2, S_1)
    c_l, c_r = rho_l * S_l, rho_r * S_r
    c = c_l + c_r

    v_star = quotient(c_l * v_l + c_r * v_r + p_l - p_r, c)
    p_star = quotient(c_r * p_l + c_l * p_r + c_l * c_r * D, c)
    rho_l_star = quotient(rho_l, 1.0 + rho_l * quotient(-c_r * D + p_l - p_r, c_l * c))
    rho_r_star = quotient(rho_r, 1.0 + rho_r * quotient(-c_l * D + p_r - p_l, c_r * c))

    to_right = v_star >= 0.0  # the upwind side, and whether even its fast wave goes downwind
    supersonic = np.where(to_right, v_l - S_l >= 0.0, v_r + S_r <= 0.0)
    rho = np.where(to_right, np.where(supersonic, rho_l, rho_l_star), np.where(supersonic, rho_r, rho_r_star))
    speed = np.where(supersonic, np.where(to_right, v_l, v_r), v_star)
    p = np.where(supersonic, np.where(to_right, p_l, p_r), p_star)
    F0 = rho * speed
    return F0, F0 * speed + p


def interface_flux(fields: Fields, Dz: Array, case: Case) -> Flux:
    """Well-balanced two-sided flux (B.31), (B.32) through every interface. Dz: (cells + 1,), m."""
    scheme, g_c, periodic = case.scheme, case.g_c, case.scheme.periodic
    mirrors = mirrored(scheme.left, fields.v[0]), mirrored(scheme.right, -fields.v[-1])
    h_l, h_r = with_ghosts(fields.h, periodic=periodic)
    phi_l, phi_r = with_ghosts(fields.phi, periodic=periodic)
    v_l, v_r = with_ghosts(fields.v, *mirrors, periodic=periodic)

    head = scheme.lambda_ / g_c  # (B.16)
    z_plus = positive(Dz - head * positive(0.5 * v_l**2 - 0.5 * v_r**2))
    z_minus = positive(-Dz - head * positive(0.5 * v_r**2 - 0.5 * v_l**2))
    h_l_star, phi_l_star = reconstruct(h_l, phi_l, phi_r, z_plus, Dz > 0.0, scheme.alpha)
    h_r_star, phi_r_star = reconstruct(h_r, phi_r, phi_l, z_minus, Dz < 0.0, scheme.alpha)

    F0, F1 = suliciu((h_l_star, h_r_star), (v_l, v_r), (phi_l_star, phi_r_star), case)
    F2 = F0 * np.where(F0 >= 0.0, phi_l_star, phi_r_star) ** (scheme.alpha - 1.0)  # (B.13)
    F1_l = F1 + 0.5 * g_c * (phi_l * h_l**2 - phi_l_star * h_l_star**2)
    F1_r = F1 + 0.5 * g_c * (phi_r * h_r**2 - phi_r_star * h_r_star**2)
    if scheme.lambda_ > 0.0:
        F1_l = F1_l + F0 * g_c * quotient(positive(Dz) - z_plus, v_l)
        F1_r = F1_r + F0 * g_c * quotient(positive(-Dz) - z_minus, v_r)
    return Flux(F0, F1_l, F1_r, F2)


def update(U: Array, flux: Flux, dt: float, case: Case) -> Array:
    """Finite volume update (3.5)."""
    outflow = np.stack((np.diff(flux.F0), flux.F1_l[1:] - flux.F1_r[:-1], np.diff(flux.F2)))
    return U - dt / case.dx * outflow


def relax(U: Array, dt: float, case: Case) -> Array:
    """Dilatancy relaxation (3.15) on wet cells: (3.17), or (3.18) with `relaxation = "exponential"`."""
    a = case.scheme.alpha - 1.0
    wet = (U[0] > DRY) & (U[2] > 0.0)
    U0, U1, U2 = U[:, wet]
    phi = (U2 / U0) ** (1.0 / a)
    gamma, I = shear(U0 / phi, U1 / U0, phi, case)
    phi_eq = phi_equilibrium(I, case)
    rate = dt * gamma * case.rheology.K * phi
    factor = np.exp(-rate) if case.scheme.relaxation == "exponential" else 1.0 / (1.0 + rate)
    relaxed = U.copy()
    relaxed[2, wet] = U0 * (phi_eq + (phi - phi_eq) * factor) ** a
    return relaxed


def diffuse(U: Array, iota: Array, dt: float, case: Case) -> Array:
    """Artificial viscosity (3.20), (3.21) with iota = (v_f Dz)_+ at interfaces [m2/s].

    The "bounded" form moves solid fraction with the mass, so that a constant phi stays constant; "paper" is (3.20).
    """
    xi1, xi2, xi3 = case.scheme.xi
    k = iota * dt / case.dx**2  # 0 at the ends, unless they are periodic
    (U0_l, U0_r), (U1_l, U1_r), (U2_l, U2_r) = (with_ghosts(u, periodic=case.scheme.periodic) for u in U)
    G0 = xi1 * k * (U0_r - U0_l)
    G1 = xi2 * k * (U1_r - U1_l)
    if case.scheme.viscosity == "paper":
        G2 = xi3 * k * (U2_r - U2_l)
    else:
        s_l, s_r = (np.where(U0 > 0.0, quotient(U2, U0), 0.0) for U0, U2 in ((U0_l, U2_l), (U0_r, U2_r)))
        donor = np.where(U0_l > U0_r, s_l, s_r)
        G2 = k * (xi1 * donor * (U0_r - U0_l) + xi3 * np.minimum(U0_l, U0_r) * (s_r - s_l))
    G = np.stack((G0, G1, G2))
    return U + G[:, 1:] - G[:, :-1]


class FirstOrder(Run):
    """One run of a case by the scheme of order 1, advanced step by step."""

    def __init__(self, case: Case) -> None:
        super().__init__(case)
        self.dbhat = case.dbhat

    def time_step(self, fields: Fields, v_f: Array, mu_f: Array) -> float:
        """Largest stable step [s]: CFL, and the parabolic limit (3.22); infinite where nothing limits it."""
        case = self.case
        speed = np.max(np.abs(fields.v) + np.sqrt(case.g_c * fields.h))
        once = slice(0 if case.scheme.periodic else 1, -1)  # interfaces between two cells, each once
        climb = v_f[once] * self.dbhat[once] + np.abs(v_f[once]) * mu_f[once] * case.dx
        viscosity = max(case.scheme.xi) * max(0.0, np.max(climb))
        dt_cfl = case.scheme.cfl * case.dx / speed if speed > 0.0 else np.inf
        dt_viscous = case.dx**2 / (2.0 * viscosity) if viscosity > 0.0 else np.inf
        return float(min(dt_cfl, dt_viscous))

    def step(self, t_out: float = np.inf) -> float:
        """One step, not beyond t_out [s]; returns dt [s]."""
        case = self.case
        fields = self.fields
        periodic = case.scheme.periodic
        h, v, phi = (with_ghosts(field, periodic=periodic) for field in fields)
        mu_l, mu_r = with_ghosts(friction(fields, case), periodic=periodic)
        rho_l, rho_r = phi[0] * h[0], phi[1] * h[1]
        v_f = quotient(rho_l * v[0] + rho_r * v[1], rho_l + rho_r)  # (3.8)
        mu_f = 0.5 * (mu_l + mu_r)

        dt = self.time_step(fields, v_f, mu_f)
        last = t_out - self.t <= dt
        dt = t_out - self.t if last else dt

        Dz = apparent_topography(h, phi, v_f, mu_f, self.dbhat, dt, case)
        if not periodic:
            Dz[[0, -1]] = 0.0
        U = update(self.U, interface_flux(fields, Dz, case), dt, case)
        U = relax(U, dt, case)
        self.U = diffuse(U, positive(v_f * Dz), dt, case)
        self.t = t_out if last else self.t + dt
        self.steps += 1
        self.cell_steps += self.case.grid.cells
        return dt
