"""The default variant of the scheme in numba: what one would write without Warp, to compare with.

alpha = 2, lambda = 0, f2 with N = 1, rational relaxation, bounded viscosity, no bed but the plane; one run, one thread,
float64. A step is seven loops over the cells in one compiled function, all vectorised: separate contiguous arrays, no
branches, no calls, indices i, i + 1 and i + 2, and the divisions shared as in the kernels. Reconstruction and flux in
one loop are slower than in two.

Arrays have a ghost cell at either end: cell i of the grid is element i + 1, and interface i lies before it.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numba import njit

from warpgran.case import Case

Array = np.ndarray

DRY = 1e-12
TINY = 1e-200


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


def _inertia(h_e: float, v: float, phi: float, c: Constants) -> tuple[float, float]:
    return 2.5 * abs(v) * c.d, h_e * math.sqrt(phi * c.g_c * h_e)


def _phi_equilibrium(num: float, den: float, c: Constants) -> tuple[float, float]:
    return c.phi_stat * c.phi_stat * den, c.phi_stat * den + c.K_tilde * num


def _friction(h: float, v: float, phi: float, c: Constants) -> float:
    num, den = inertia(max(h, c.h_min), v, phi, c)
    top, bottom = phi_equilibrium(num, den, c)
    scale = num + c.I0 * den
    r = 1.0 / (bottom * scale)
    mu_I = c.mu1 + c.dmu * num * (bottom * r)
    return max(0.0, mu_I + c.K * (phi - top * (scale * r))) + c.wall * h


def _apparent_bed(X: float, Y: float, mu: float) -> float:
    against = -X if Y > 0.0 else X
    push = 2.0 * Y * mu / max(mu + max(mu, against), TINY)
    return min(max(min(max(X, -mu), mu) + push, -mu), mu)


def _suliciu(
    h_l: float, v_l: float, phi_l: float, h_r: float, v_r: float, phi_r: float, g_c: float
) -> tuple[float, float]:
    rho_l, rho_r = phi_l * h_l, phi_r * h_r
    p_l, p_r = 0.5 * g_c * rho_l * h_l, 0.5 * g_c * rho_r * h_r
    s_l, s_r = math.sqrt(g_c * h_l), math.sqrt(g_c * h_r)
    D = v_l - v_r
    up = p_r >= p_l
    rho_1, rho_2 = (rho_l if up else rho_r), (rho_r if up else rho_l)
    s_1, s_2 = (s_l if up else s_r), (s_r if up else s_l)
    dp = abs(p_r - p_l)
    S_1 = s_1 + 1.5 * max(dp / max(rho_2 * s_2, TINY) + D, 0.0)
    c_1 = rho_1 * S_1
    rise = max(D - dp / max(c_1, TINY), 0.0)
    S_2 = s_2 + 1.5 * (rise if c_1 > 0.0 else 0.0)
    S_l, S_r = (S_1 if up else S_2), (S_2 if up else S_1)
    c_l, c_r = rho_l * S_l, rho_r * S_r
    per_c = 1.0 / max(c_l + c_r, TINY)
    v_star = (c_l * v_l + c_r * v_r + p_l - p_r) * per_c
    p_star = (c_r * p_l + c_l * p_r + c_l * c_r * D) * per_c
    right = v_star >= 0.0
    rho_u, v_u, p_u = (rho_l if right else rho_r), (v_l if right else v_r), (p_l if right else p_r)
    S_u, c_d, p_d = (S_l if right else S_r), (c_r if right else c_l), (p_r if right else p_l)
    stretched = S_u + (p_u - p_d - c_d * D) * per_c
    rho_star = rho_u * S_u / (stretched if rho_u > 0.0 else 1.0)
    fast = (v_u if right else -v_u) >= S_u
    speed = v_u if fast else v_star
    F0 = (rho_u if fast else rho_star) * speed
    return F0, F0 * speed + (p_u if fast else p_star)


def _decode(U0: Array, U1: Array, U2: Array, h: Array, v: Array, phi_wet: Array) -> None:
    for i in range(U0.size):
        wet = (U0[i] > DRY) & (U2[i] > 0.0)
        mass, U2_i = (U0[i] if wet else 1.0), (U2[i] if wet else 1.0)
        r = 1.0 / (mass * U2_i)
        per_mass = U2_i * r
        h[i] = mass * mass * (mass * r) if wet else 0.0
        v[i] = U1[i] * per_mass if wet else 0.0
        phi_wet[i] = U2_i * per_mass if wet else 0.0


def _rheology(h: Array, v: Array, phi_wet: Array, phi: Array, mu: Array, c: Constants) -> None:
    for i in range(h.size - 2):
        beside = max(phi_wet[i], phi_wet[i + 2])
        dry_phi = beside if beside > 0.0 else c.phi_stat
        wet_phi = phi_wet[i + 1]
        phi_i = wet_phi if wet_phi > 0.0 else dry_phi
        phi[i + 1] = phi_i
        mu[i + 1] = friction(h[i + 1], v[i + 1], phi_i, c)


def _ghosts(h: Array, v: Array, phi: Array, mu: Array, c: Constants) -> None:
    """A ghost's friction is -mu, so that the friction at the end, and with it Dz and iota, is 0."""
    n = h.size
    h[0], v[0], phi[0], mu[0] = h[1], c.v_left * v[1], phi[1], -mu[1]
    h[n - 1], v[n - 1], phi[n - 1], mu[n - 1] = h[n - 2], c.v_right * v[n - 2], phi[n - 2], -mu[n - 2]


def _time_step(h: Array, v: Array, phi: Array, mu: Array, dbhat: Array, v_f: Array, c: Constants) -> float:
    speed = 0.0
    bound = 0.0
    for i in range(v_f.size):
        rho_l, rho_r = phi[i] * h[i], phi[i + 1] * h[i + 1]
        v_i = (rho_l * v[i] + rho_r * v[i + 1]) / max(rho_l + rho_r, TINY)
        v_f[i] = v_i
        bound = max(bound, v_i * dbhat[i] + abs(v_i) * 0.5 * (mu[i] + mu[i + 1]) * c.dx)
        speed = max(speed, abs(v[i + 1]) + math.sqrt(c.g_c * h[i + 1]))
    viscosity = max(c.xi1, c.xi2, c.xi3) * bound
    dt = c.cfl * c.dx / speed
    return min(dt, c.dx * c.dx / (2.0 * viscosity)) if viscosity > 0.0 else dt


def _reconstruct(
    h: Array, phi: Array, mu: Array, v_f: Array, dbhat: Array, dt: float, c: Constants,
    h_l_star: Array, h_r_star: Array, phi_l_star: Array, phi_r_star: Array, iota: Array,
) -> None:  # fmt: skip
    per_g_dt, per_dx = 1.0 / (c.g_c * dt), 1.0 / c.dx
    for i in range(v_f.size):
        h_l, h_r, phi_l, phi_r = h[i], h[i + 1], phi[i], phi[i + 1]
        X = (h_l - h_r - dbhat[i] + (h_l + h_r) * (phi_l - phi_r) / (phi_l + phi_r) * 0.5) * per_dx
        jump = dbhat[i] + c.dx * apparent_bed(X, v_f[i] * per_g_dt, 0.5 * (mu[i] + mu[i + 1]))
        rising = jump > 0.0
        h_c, phi_c, phi_over = (h_l if rising else h_r), (phi_l if rising else phi_r), (phi_r if rising else phi_l)
        z, h_safe = abs(jump), max(h_c, TINY)
        r = 1.0 / (phi_c * h_safe)
        deficit = max(1.0 - phi_over * (h_safe * r), 0.0)
        h_star = max(h_c + min(h_c * deficit * 0.5, z / 3.0) - z, 0.0)
        lowered = max(phi_c * (h_star * (phi_c * r)), phi_over)
        phi_star = lowered if phi_over < phi_c else phi_c
        h_l_star[i] = h_star if rising else h_l
        h_r_star[i] = h_r if rising else h_star
        phi_l_star[i] = phi_star if rising else phi_l
        phi_r_star[i] = phi_r if rising else phi_star
        iota[i] = max(v_f[i] * jump, 0.0)


def _flux(
    h: Array, v: Array, phi: Array, h_l_star: Array, h_r_star: Array, phi_l_star: Array, phi_r_star: Array, g_c: float,
    F0: Array, F1_l: Array, F1_r: Array, F2: Array,
) -> None:  # fmt: skip
    for i in range(F0.size):
        h_l, h_r, phi_l, phi_r = h_l_star[i], h_r_star[i], phi_l_star[i], phi_r_star[i]
        mass, momentum = suliciu(h_l, v[i], phi_l, h_r, v[i + 1], phi_r, g_c)
        F0[i] = mass
        F1_l[i] = momentum + 0.5 * g_c * (phi[i] * h[i] * h[i] - phi_l * h_l * h_l)
        F1_r[i] = momentum + 0.5 * g_c * (phi[i + 1] * h[i + 1] * h[i + 1] - phi_r * h_r * h_r)
        F2[i] = mass * (phi_l if mass >= 0.0 else phi_r)


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
        some = mass > TINY
        wet = (mass > DRY) & (U2_i > 0.0)
        safe, safe_2 = (mass if some else 1.0), (U2_i if wet else 1.0)
        r = 1.0 / (safe * safe_2)
        per_mass = safe_2 * r
        phi, h_e, v = safe_2 * per_mass, max(safe * safe * (safe * r), c.h_min), momentum * per_mass
        num, den = inertia(h_e, v, phi, c)
        top, bottom = phi_equilibrium(num, den, c)
        whole = h_e + dt * 2.5 * abs(v) * c.K * phi
        r_2 = 1.0 / (bottom * whole)
        phi_eq = top * (whole * r_2)
        after = phi_eq + (phi - phi_eq) * (h_e * (bottom * r_2))
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
    h, v, phi, phi_wet, mu, s = cells
    v_f, iota, F0, F1_l, F1_r, F2, h_l, h_r, phi_l, phi_r = faces
    t = 0.0
    for _ in range(steps):
        decode(U0, U1, U2, h, v, phi_wet)
        rheology(h, v, phi_wet, phi, mu, c)
        ghosts(h, v, phi, mu, c)
        dt = time_step(h, v, phi, mu, dbhat, v_f, c)
        reconstruct(h, phi, mu, v_f, dbhat, dt, c, h_l, h_r, phi_l, phi_r, iota)
        flux(h, v, phi, h_l, h_r, phi_l, phi_r, c.g_c, F0, F1_l, F1_r, F2)
        update(U0, U1, U2, F0, F1_l, F1_r, F2, dt, c, W0, W1, W2, s)
        diffuse(W0, W1, W2, s, iota, dt, c, U0, U1, U2)
        t += dt
    return t


inertia = inlined(_inertia)
phi_equilibrium = inlined(_phi_equilibrium)
friction = inlined(_friction)
apparent_bed = inlined(_apparent_bed)
suliciu = inlined(_suliciu)
decode, rheology, ghosts, time_step = compiled(_decode), compiled(_rheology), compiled(_ghosts), compiled(_time_step)
reconstruct, flux, update, diffuse = compiled(_reconstruct), compiled(_flux), compiled(_update), compiled(_diffuse)
_steps = compiled(_advance)


class NumbaRun:
    """One run of a case of the default variant, from a given state.

    Attributes:
        U: state (3, cells), as `warpgran.reference.Reference` has it.
    """

    def __init__(self, case: Case, U: Array) -> None:
        n = case.grid.cells
        self._U, self._W = (tuple(np.zeros(n + 2) for _ in range(3)) for _ in range(2))
        self._cells = tuple(np.zeros(n + 2) for _ in range(6))
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
