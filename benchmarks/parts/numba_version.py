"""The default variant of the scheme in numba: what one would write without Warp, to compare with.

alpha = 2, lambda = 0, f2 with N = 1, rational relaxation, bounded viscosity, no bed but the plane; one run, one thread,
float64. A step is seven loops over the cells in one compiled function: separate contiguous arrays, no branches, no
calls, indices i, i + 1 and i + 2, values read into names before anything is written, and the divisions shared as in
the kernels. All are vectorised but that of the time step, where the compiler sees no reduction in a maximum.
Reconstruction and flux in one loop are slower than in two.

Arrays have a ghost cell at either end: cell i of the grid is element i + 1, and interface i lies before it.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numba import njit

from warpgran.case.case import Case

Array = np.ndarray

DRY, NOTHING = 1e-12, 1e-30
TINY = 1e-150


class Constants(NamedTuple):
    """What a run needs of its case; see kernels/precision.py for the meaning and units."""

    dx: float
    g_c: float
    cfl: float
    mu1: float
    dmu: float
    I0: float
    d: float
    K: float
    K_tilde: float
    phi_stat: float
    wall: float
    h_min: float
    xi1: float
    xi2: float
    xi3: float
    v_left: float
    v_right: float


def compiled(function: Any, inline: str = "never") -> Any:
    """Compile for speed: sums in any order, and no test of denominators and indices."""
    return njit(function, fastmath=True, error_model="numpy", boundscheck=False, nogil=True, inline=inline)


def inlined(function: Any) -> Any:
    """Compile as a part of what calls it: a loop with a call in it is not vectorised."""
    return compiled(function, inline="always")


def _inertia(U0: float, U1: float, U2: float, deep: float, c: Constants) -> tuple[float, float]:
    """Numerator and denominator of I, both times U0 U2; deep is h_e U2."""
    return 2.5 * abs(U1) * U2 * c.d, deep * math.sqrt(c.g_c * deep * U0)


def _phi_equilibrium(num: float, den: float, c: Constants) -> tuple[float, float]:
    return c.phi_stat * c.phi_stat * den, c.phi_stat * den + c.K_tilde * num


def _apparent_bed(X: float, Y: float, mu: float) -> float:
    against = -X if Y > 0.0 else X
    push = 2.0 * Y * mu / max(mu + max(mu, against), TINY)
    return min(max(min(max(X, -mu), mu) + push, -mu), mu)


def _suliciu(
    rho_l: float, v_l: float, p_l: float, s_l: float, rho_r: float, v_r: float, p_r: float, s_r: float
) -> tuple[float, float]:
    D = v_l - v_r
    up = p_r >= p_l
    rho_1, rho_2 = (rho_l if up else rho_r), (rho_r if up else rho_l)
    s_1, s_2 = (s_l if up else s_r), (s_r if up else s_l)
    dp = abs(p_r - p_l)
    b = rho_2 * s_2
    bc = rho_1 * (s_1 * b + 1.5 * max(dp + D * b, 0.0))
    b_safe, bc_safe = max(b, TINY), max(bc, TINY)
    r = 1.0 / (b_safe * bc_safe)
    S_1 = s_1 + 1.5 * max(dp * (bc_safe * r) + D, 0.0)
    rise = max(D - dp * (b * (b_safe * r)), 0.0)
    S_2 = s_2 + 1.5 * (rise if bc > 0.0 else 0.0)
    S_l, S_r = (S_1 if up else S_2), (S_2 if up else S_1)
    c_l, c_r = rho_l * S_l, rho_r * S_r
    c = max(c_l + c_r, TINY)
    push = c_l * v_l + c_r * v_r + p_l - p_r
    right = push >= 0.0
    rho_u, v_u, p_u = (rho_l if right else rho_r), (v_l if right else v_r), (p_l if right else p_r)
    S_u, c_d, p_d = (S_l if right else S_r), (c_r if right else c_l), (p_r if right else p_l)
    stretched = S_u * c + (p_u - p_d - c_d * D) if rho_u > 0.0 else 1.0
    r_2 = 1.0 / (c * stretched)
    per_c = stretched * r_2
    rho_star = rho_u * (S_u * c) * (c * r_2)
    v_star = push * per_c
    p_star = (c_r * p_l + c_l * p_r + c_l * c_r * D) * per_c
    fast = (v_u if right else -v_u) >= S_u
    speed = v_u if fast else v_star
    F0 = (rho_u if fast else rho_star) * speed
    return F0, F0 * speed + (p_u if fast else p_star)


def _decode(
    U0: Array, U1: Array, U2: Array, h: Array, v: Array, phi_wet: Array, mu: Array, per_mass: Array, celerity: Array,
    c: Constants,
) -> None:  # fmt: skip
    for i in range(U0.size):
        wet = (U0[i] > DRY) & (U2[i] > 0.0)
        mass, U2_i = (U0[i] if wet else 1.0), (U2[i] if wet else 1.0)
        num, den = inertia(mass, U1[i], U2_i, max(mass * mass, c.h_min * U2_i), c)
        top, bottom = phi_equilibrium(num, den, c)
        scale = num + c.I0 * den
        both = bottom * scale
        r = 1.0 / (mass * U2_i * both)
        per_both = mass * U2_i * r
        per_U0 = U2_i * (both * r)
        phi, h_i = U2_i * per_U0, mass * mass * (mass * (both * r))
        mu_I = c.mu1 + c.dmu * num * (bottom * per_both)
        mu[i] = max(0.0, mu_I + c.K * (phi - top * (scale * per_both))) + c.wall * h_i
        h[i] = h_i if wet else 0.0
        v[i] = U1[i] * per_U0 if wet else 0.0
        phi_wet[i] = phi if wet else 0.0
        per_mass[i] = per_U0 if wet else 0.0
        celerity[i] = math.sqrt(c.g_c * h_i) if wet else 0.0


def _fill(phi_wet: Array, phi: Array, mu: Array, c: Constants) -> None:
    for i in range(phi.size - 2):
        beside = max(phi_wet[i], phi_wet[i + 2])
        dry_phi = beside if beside > 0.0 else c.phi_stat
        wet_phi = phi_wet[i + 1]
        mu_i = mu[i + 1]
        phi[i + 1] = wet_phi if wet_phi > 0.0 else dry_phi
        mu[i + 1] = mu_i if wet_phi > 0.0 else max(0.0, c.mu1 + c.K * (dry_phi - c.phi_stat))


def _ghosts(h: Array, v: Array, phi: Array, mu: Array, celerity: Array, c: Constants) -> None:
    """A ghost's friction is -mu, so that the friction at the end, and with it Dz and iota, is 0."""
    n = h.size
    for ghost, cell, factor in ((0, 1, c.v_left), (n - 1, n - 2, c.v_right)):
        h[ghost], v[ghost], phi[ghost], mu[ghost] = h[cell], factor * v[cell], phi[cell], -mu[cell]
        celerity[ghost] = celerity[cell]


def _time_step(
    h: Array, v: Array, phi: Array, mu: Array, celerity: Array, dbhat: Array, v_f: Array, X: Array, c: Constants
) -> float:
    speed = 0.0
    bound = 0.0
    per_dx = 1.0 / c.dx
    for i in range(v_f.size):
        h_l, h_r, phi_l, phi_r = h[i], h[i + 1], phi[i], phi[i + 1]
        rho_l, rho_r = phi_l * h_l, phi_r * h_r
        rho, phi_sum = max(rho_l + rho_r, TINY), phi_l + phi_r
        r = 1.0 / (rho * phi_sum)
        v_l, v_r, mu_l, mu_r, dbhat_i, celerity_r = v[i], v[i + 1], mu[i], mu[i + 1], dbhat[i], celerity[i + 1]
        v_i = (rho_l * v_l + rho_r * v_r) * (phi_sum * r)
        v_f[i] = v_i
        X[i] = (h_l - h_r - dbhat_i + (h_l + h_r) * (phi_l - phi_r) * (rho * r) * 0.5) * per_dx
        bound = max(bound, v_i * dbhat_i + abs(v_i) * 0.5 * (mu_l + mu_r) * c.dx)
        speed = max(speed, abs(v_r) + celerity_r)
    viscosity = max(c.xi1, c.xi2, c.xi3) * bound
    dt = c.cfl * c.dx / speed
    return min(dt, c.dx * c.dx / (2.0 * viscosity)) if viscosity > 0.0 else dt


def _reconstruct(
    h: Array, phi: Array, mu: Array, per_mass: Array, v_f: Array, X: Array, dbhat: Array, dt: float, c: Constants,
    h_star: Array, phi_star: Array, Dz: Array, iota: Array,
) -> None:  # fmt: skip
    per_g_dt = 1.0 / (c.g_c * dt)
    for i in range(v_f.size):
        h_l, h_r, phi_l, phi_r, per_l, per_r, v_i = (
            h[i],
            h[i + 1],
            phi[i],
            phi[i + 1],
            per_mass[i],
            per_mass[i + 1],
            v_f[i],
        )
        jump = dbhat[i] + c.dx * apparent_bed(X[i], v_i * per_g_dt, 0.5 * (mu[i] + mu[i + 1]))
        rising = jump > 0.0
        h_c, phi_c = (h_l if rising else h_r), (phi_l if rising else phi_r)
        phi_over, per = (phi_r if rising else phi_l), (per_l if rising else per_r)
        z = abs(jump)
        deficit = max(1.0 - phi_over * (h_c * per), 0.0)
        h_s = max(h_c + min(h_c * deficit * 0.5, z / 3.0) - z, 0.0)
        lowered = max(phi_c * (h_s * (phi_c * per)), phi_over)
        h_star[i] = h_s
        phi_star[i] = lowered if phi_over < phi_c else phi_c
        Dz[i] = jump
        iota[i] = max(v_i * jump, 0.0)


def _flux(
    h: Array, v: Array, phi: Array, celerity: Array, h_star: Array, phi_star: Array, Dz: Array, g_c: float,
    F0: Array, F1_l: Array, F1_r: Array, F2: Array,
) -> None:  # fmt: skip
    for i in range(F0.size):
        rising = Dz[i] > 0.0
        h_l, h_r, h_s, c_l, c_r = h[i], h[i + 1], h_star[i], celerity[i], celerity[i + 1]
        phi_l, phi_r, phi_s = phi[i], phi[i + 1], phi_star[i]
        rho_l, rho_r, rho_s = phi_l * h_l, phi_r * h_r, phi_s * h_s
        p_l, p_r, p_s = 0.5 * g_c * rho_l * h_l, 0.5 * g_c * rho_r * h_r, 0.5 * g_c * rho_s * h_s
        c_s = math.sqrt(g_c * h_s)
        mass, momentum = suliciu(
            rho_s if rising else rho_l, v[i], p_s if rising else p_l, c_s if rising else c_l,
            rho_r if rising else rho_s, v[i + 1], p_r if rising else p_s, c_r if rising else c_s,
        )  # fmt: skip
        F0[i] = mass
        F1_l[i] = momentum + (p_l - p_s if rising else 0.0)
        F1_r[i] = momentum + (0.0 if rising else p_r - p_s)
        phi_from_l, phi_from_r = (phi_s if rising else phi_l), (phi_r if rising else phi_s)
        F2[i] = mass * (phi_from_l if mass >= 0.0 else phi_from_r)


def _update(
    U0: Array, U1: Array, U2: Array, F0: Array, F1_l: Array, F1_r: Array, F2: Array, dt: float, c: Constants,
    W0: Array, W1: Array, W2: Array, s: Array,
) -> None:  # fmt: skip
    """Finite volume update and relaxation."""
    k = dt / c.dx
    for i in range(U0.size - 2):
        mass = U0[i + 1] - k * (F0[i + 1] - F0[i])
        momentum = U1[i + 1] - k * (F1_l[i + 1] - F1_r[i])
        U2_i = U2[i + 1] - k * (F2[i + 1] - F2[i])
        some = mass > NOTHING
        wet = (mass > DRY) & (U2_i > 0.0)
        safe, safe_2 = (mass if some else 1.0), (U2_i if wet else 1.0)
        deep = max(safe * safe, c.h_min * safe_2)
        num, den = inertia(safe, momentum, safe_2, deep, c)
        top, bottom = phi_equilibrium(num, den, c)
        left = deep * safe * safe
        whole = left + dt * 2.5 * abs(momentum) * c.K * safe_2 * safe_2
        both = bottom * whole
        r = 1.0 / (safe * both)
        per_mass = both * r
        phi, phi_eq = safe_2 * per_mass, top * (whole * (safe * r))
        after = phi_eq + (phi - phi_eq) * (left * (bottom * (safe * r)))
        before = U2_i * per_mass if some else 0.0
        s_i = after if wet else before
        W0[i + 1] = mass
        W1[i + 1] = momentum
        W2[i + 1] = mass * s_i if wet else U2_i
        s[i + 1] = s_i


def _diffuse(
    W0: Array, W1: Array, W2: Array, s: Array, iota: Array, dt: float, c: Constants, U0: Array, U1: Array, U2: Array
) -> None:
    ratio = dt / (c.dx * c.dx)
    for i in range(U0.size - 2):
        k_l, k_r = iota[i] * ratio, iota[i + 1] * ratio
        a, b, e = W0[i], W0[i + 1], W0[i + 2]
        donor_l, donor_r = (s[i] if a > b else s[i + 1]), (s[i + 1] if b > e else s[i + 2])
        G2_l = k_l * (c.xi1 * donor_l * (b - a) + c.xi3 * min(a, b) * (s[i + 1] - s[i]))
        G2_r = k_r * (c.xi1 * donor_r * (e - b) + c.xi3 * min(b, e) * (s[i + 2] - s[i + 1]))
        U0[i + 1] = b + c.xi1 * (k_r * (e - b) - k_l * (b - a))
        U1[i + 1] = W1[i + 1] + c.xi2 * (k_r * (W1[i + 2] - W1[i + 1]) - k_l * (W1[i + 1] - W1[i]))
        U2[i + 1] = W2[i + 1] + (G2_r - G2_l)


def _advance(U: Any, W: Any, cells: Any, dbhat: Array, faces: Any, c: Constants, steps: int) -> float:
    """Take steps; returns the time passed [s]."""
    U0, U1, U2 = U
    W0, W1, W2 = W
    h, v, phi, phi_wet, mu, per_mass, celerity, s = cells
    v_f, X, Dz, iota, F0, F1_l, F1_r, F2, h_star, phi_star = faces
    t = 0.0
    for _ in range(steps):
        decode(U0, U1, U2, h, v, phi_wet, mu, per_mass, celerity, c)
        fill(phi_wet, phi, mu, c)
        ghosts(h, v, phi, mu, celerity, c)
        dt = time_step(h, v, phi, mu, celerity, dbhat, v_f, X, c)
        reconstruct(h, phi, mu, per_mass, v_f, X, dbhat, dt, c, h_star, phi_star, Dz, iota)
        flux(h, v, phi, celerity, h_star, phi_star, Dz, c.g_c, F0, F1_l, F1_r, F2)
        update(U0, U1, U2, F0, F1_l, F1_r, F2, dt, c, W0, W1, W2, s)
        diffuse(W0, W1, W2, s, iota, dt, c, U0, U1, U2)
        t += dt
    return t


inertia = inlined(_inertia)
phi_equilibrium = inlined(_phi_equilibrium)
apparent_bed = inlined(_apparent_bed)
suliciu = inlined(_suliciu)
decode, fill, ghosts, time_step = compiled(_decode), compiled(_fill), compiled(_ghosts), compiled(_time_step)
reconstruct, flux, update, diffuse = compiled(_reconstruct), compiled(_flux), compiled(_update), compiled(_diffuse)
_steps = compiled(_advance)


class NumbaRun:
    """One run of a case of the default variant, from a given state.

    Attributes:
        U: state (3, cells), as `warpgran.physics.first_order.FirstOrder` has it.
    """

    def __init__(self, case: Case, U: Array) -> None:
        n = case.grid.cells
        self._U, self._W = (tuple(np.zeros(n + 2) for _ in range(3)) for _ in range(2))
        self._cells = tuple(np.zeros(n + 2) for _ in range(8))
        self._faces = tuple(np.zeros(n + 1) for _ in range(10))
        self._dbhat = np.concatenate(([0.0], np.diff(case.bhat), [0.0]))
        self._constants = _constants(case)
        self.U = U

    @property
    def U(self) -> Array:
        """The state, a copy."""
        return np.stack([array[1:-1] for array in self._U])

    @U.setter
    def U(self, values: Array) -> None:
        for array, row in zip(self._U, values, strict=True):
            array[1:-1] = row

    def advance(self, steps: int) -> float:
        """Take steps; returns the time passed [s]."""
        return float(_steps(self._U, self._W, self._cells, self._dbhat, self._faces, self._constants, steps))


def _constants(case: Case) -> Constants:
    r, scheme = case.rheology, case.scheme
    factor = {"wall": -1.0, "open": 1.0}
    return Constants(
        dx=case.dx, g_c=case.g_c, cfl=scheme.cfl, mu1=r.mu1, dmu=r.mu2 - r.mu1, I0=r.I0,
        d=r.grain_diameter, K=r.K, K_tilde=r.K_tilde, phi_stat=r.phi_stat, wall=r.mu_wall / r.channel_width,
        h_min=case.h_min, xi1=scheme.xi[0], xi2=scheme.xi[1], xi3=scheme.xi[2],
        v_left=factor[scheme.left], v_right=factor[scheme.right],
    )  # fmt: skip
