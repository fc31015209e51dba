"""Functions of the kernels of order 2 one by one, against the scheme in plain Python."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from helpers.cases import small
from helpers.functions import Caller

from warpgran.case.case import Case
from warpgran.kernels import lanes
from warpgran.kernels import laws as laws_of
from warpgran.kernels.precision import precision
from warpgran.kernels.second import drive, faces, flux, limiter, reconstruction, rheology, update

KINDS = precision("float64")
LIMITER = limiter.make(KINDS)
N = 400


def draw(seed: int, low: float, high: float, zeros: float = 0.0) -> np.ndarray:
    """Random numbers, some of them exactly 0."""
    rng = np.random.default_rng(seed)
    return np.where(rng.random(N) < zeros, 0.0, rng.uniform(low, high, N))


def each(function: Any, *arguments: Any) -> np.ndarray:
    """A plain function of numbers for each of the arguments, shape (results, elements)."""
    columns = np.broadcast_arrays(*(np.atleast_1d(each) for each in arguments))
    values = [function(*(float(x) for x in row)) for row in zip(*columns, strict=True)]
    return np.array([value if isinstance(value, tuple) else (value,) for value in values]).T


def lim(a: float, b: float, t: float) -> float:
    return 0.0 if a * b <= 0.0 else math.copysign(min(t * min(abs(a), abs(b)), abs(a + b) / 2), a)


def clip(x: float, M: float) -> float:
    return min(max(x, -M), M)


def test_lim() -> None:
    a, b = draw(1, -1.0, 1.0, 0.1), draw(2, -1.0, 1.0, 0.1)
    call = Caller(small())
    np.testing.assert_allclose(call(LIMITER.lim, a, b), each(lambda a, b: lim(a, b, 2.0), a, b)[0], atol=3e-16)
    t = draw(3, 1.0, 2.0)
    np.testing.assert_allclose(call(LIMITER.half_lim, a, b, t / 2), each(lim, a, b, t)[0] / 2, atol=3e-16)


def test_lim_of_equal_numbers_is_that_number() -> None:
    a = draw(1, -1.0, 1.0, 0.1)
    np.testing.assert_array_equal(Caller(small())(LIMITER.lim, a, a), a)


def phi_eq(I: float, case: Case) -> float:
    r = case.rheology
    match r.phi_eq:
        case "f0":
            return max(0.0, r.phi_stat - r.K_tilde * I)
        case "f1":
            return r.phi_stat * math.exp(-r.K_tilde * I / r.phi_stat)
        case _:
            return r.phi_stat / (1.0 + r.K_tilde * I / (r.phi_eq_N * r.phi_stat)) ** r.phi_eq_N


LAWS: list[dict[str, Any]] = [
    {},
    {"rheology.phi_eq": "f0", "rheology.mu_wall": 0.18},
    {"rheology.phi_eq": "f1", "rheology.K": 20.0},
    {"rheology.phi_eq_N": 3.0, "scheme.alpha": 1.7},
    {"scheme.alpha": 3.0, "rheology.K": 0.0},
]


@pytest.mark.parametrize("changes", LAWS)
def test_friction(changes: dict[str, Any]) -> None:
    case = small(**changes)
    r = case.rheology

    def page(m: float, v: float, f: float) -> tuple[float, float]:
        M = max(m, f * case.h_min)
        I = 2.5 * abs(v) * f * r.grain_diameter / (M * math.sqrt(case.g_c * M))
        mu = r.mu1 + (r.mu2 - r.mu1) * I / (I + r.I0) + r.K * (f - phi_eq(I, case))
        return m / f, max(0.0, mu) + r.mu_wall * (m / f) / r.channel_width

    m, v, f = 10.0 ** draw(1, -12.0, -1.0, 0.1), draw(2, -2.0, 2.0, 0.1), draw(3, 0.01, 0.64)
    m = np.where(m == 1.0, 0.0, m)  # dry
    call = Caller(case)
    found = call(rheology.make(call.variant, laws_of.make(call.variant)).friction, m, v, f, returns=2)
    np.testing.assert_allclose(found, each(page, m, v, f), rtol=1e-13, atol=1e-14)


@pytest.mark.parametrize("changes", LAWS)
def test_friction_of_a_film_in_single_precision(changes: dict[str, Any]) -> None:
    case = small(**{**changes, "scheme.h_min": 3e-9, "rheology.grain_diameter": 2e-5})
    m, v, f = np.array([0.0, 0.0, 2e-11, 2e-11]), np.array([0.0, 0.0, 0.0, -0.6]), np.array([2e-4, 0.6, 2e-4, 2e-4])
    single, double = (
        caller(rheology.make(caller.variant, laws_of.make(caller.variant)).friction, m, v, f, returns=2)
        for caller in (Caller(case, "float32"), Caller(case))
    )
    np.testing.assert_allclose(single, double, rtol=1e-5)


@pytest.mark.parametrize("changes", LAWS)
def test_relaxed(changes: dict[str, Any]) -> None:
    case = small(**changes)
    r, a = case.rheology, case.scheme.alpha - 1.0

    def page(U0: float, U1: float, U2: float, tau: float) -> tuple[float, float, float]:
        f = (U2 / U0) ** (1.0 / a)
        if U1 == 0.0 or r.K == 0.0:
            return U1 / U0, f, U2
        w = 2.5 * abs(U1) / U0

        def e_and_y(f: float) -> tuple[float, float]:
            M = max(U0, f * case.h_min)
            return phi_eq(w * f * r.grain_diameter / (M * math.sqrt(case.g_c * M)), case), tau * r.K * w * f * f / M

        e, y = e_and_y(f)
        e, y = e_and_y(e + (f - e) / (1.0 + y / 2.0))
        new = max(1e-4, e + (f - e) / (1.0 + y + y * y / 2.0))
        return U1 / U0, new, U0 * new**a

    U0, v, f = 10.0 ** draw(1, -11.0, -1.0), draw(2, -2.0, 2.0, 0.1), draw(3, 0.01, 0.64)
    state = U0, U0 * v, U0 * f**a
    call = Caller(case)
    tau = 10.0 ** draw(4, -5.0, -2.0)
    found = call(rheology.make(call.variant, laws_of.make(call.variant)).relaxed, *state, tau, returns=3)
    np.testing.assert_allclose(found, each(page, *state, tau), rtol=1e-12)
    still = (state[1] == 0.0) | (r.K == 0.0)
    np.testing.assert_array_equal(found[2][still], state[2][still])  # to the bit


@pytest.mark.parametrize("changes", LAWS)
def test_relaxed_film_in_single_precision(changes: dict[str, Any]) -> None:
    case = small(**{**changes, "scheme.h_min": 3e-9, "rheology.grain_diameter": 2e-5})
    a = case.scheme.alpha - 1.0
    U0, v, phi = np.array([2e-12, 2e-11, 2e-11]), np.array([0.0, 1e-6, -0.6]), np.array([0.6, 0.3, 0.01])
    state = U0, U0 * v, U0 * phi**a
    single, double = (
        caller(rheology.make(caller.variant, laws_of.make(caller.variant)).relaxed, *state, 1e-4, returns=3)
        for caller in (Caller(case, "float32"), Caller(case))
    )
    np.testing.assert_allclose(single, double, rtol=1e-4)


def test_interface() -> None:
    dx, g_c, dt = 2e-3, 9.81, 3e-4

    def page(q_l, s_l, v_l, mu_l, q_r, s_r, v_r, mu_r, drop):  # type: ignore[no-untyped-def]
        m_l, m_r = s_l * q_l, s_r * q_r
        wl = m_l / (m_l + m_r) if m_l + m_r > 0.0 else 0.5
        v_f, mu_f, s_f = wl * v_l + (1 - wl) * v_r, wl * mu_l + (1 - wl) * mu_r, (s_l + s_r) / 2
        X = q_l - q_r - s_f * drop
        M, Y = s_f * dx * mu_f, s_f * dx * v_f / (g_c * dt)
        B = -X if Y > 0 else X if Y < 0 else 0.0
        P = clip(clip(X, M) + 2 * M * Y / (M + max(M, B)), M) if M > 0.0 else 0.0
        hold = abs(P - X) if abs(P) < M else drive.HUGE
        return X, P, wl, hold, mu_f - abs(P) / (s_f * dx) if abs(X) <= M else 0.0

    q_l = draw(1, 1e-3, 0.1, 0.3)
    q_r = np.where(draw(2, 0.0, 1.0, 0.3) == 0.0, 0.0, np.abs(q_l + draw(3, -2e-3, 2e-3)))
    s_l, s_r = draw(4, 0.6, 0.8), draw(5, 0.6, 0.8)
    v_l, v_r = np.where(q_l > 0.0, draw(6, -0.1, 0.1, 0.4), 0.0), np.where(q_r > 0.0, draw(7, -0.1, 0.1, 0.4), 0.0)
    mu_l, mu_r, drop = draw(8, 0.3, 0.8, 0.1), draw(9, 0.3, 0.8, 0.1), draw(10, -1e-3, 1e-3, 0.3)
    arguments = q_l, s_l, v_l, mu_l, q_r, s_r, v_r, mu_r, drop
    call = Caller(small())
    function = drive.make(call.variant, LIMITER, call.module).at_interface
    found = call(function, *arguments, dx, 2.0 * dx / (g_c * dt), returns=5)
    expected = each(page, *arguments)
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-15)
    at_rest = (v_l == 0.0) & (v_r == 0.0) & (np.abs(expected[1]) < 0.5 * np.minimum(mu_l, mu_r) * 0.6 * dx)
    assert at_rest.sum() > 5
    np.testing.assert_array_equal(found[0][at_rest], found[1][at_rest])  # P = X to the bit
    assert (found[3][at_rest] == 0.0).all()


def test_face_values_keep_mass_momentum_and_c_and_stay_between_the_neighbours() -> None:
    call = Caller(small())
    parts = faces.make(call.variant, LIMITER, call.module)

    def page(q, q_l, q_r, s, s_l, s_r, z, z_l, z_r):  # type: ignore[no-untyped-def]
        b = lim(q - q_l, q_r - q, 2.0) / (2.0 * q)
        e = lim(s - s_l, s_r - s, max(1.0, 2.0 - 2.0 * abs(b))) / 2.0
        s_L, s_R = s - e * (1.0 + b), s + e * (1.0 - b)
        w = (1.0 + b) * s_R / s
        e = lim(z - z_l, z_r - z, max(1.0, 4.0 - 2.0 * max(w, 2.0 - w))) / 2.0
        return q * (1 - b), q * (1 + b), s_L, s_R, z - e * w, z + e * (2.0 - w)

    q, q_l, q_r = draw(1, 1e-3, 0.1), draw(2, 0.0, 0.1, 0.2), draw(3, 0.0, 0.1, 0.2)
    s, s_l, s_r = draw(4, 0.3, 0.8), draw(5, 0.3, 0.8), draw(6, 0.3, 0.8)
    z, z_l, z_r = draw(7, -1.0, 1.0), draw(8, -1.0, 1.0), draw(9, -1.0, 1.0)
    bq = call(parts.of_q, q, q - q_l, q_r - q)
    b = bq / q
    e_s = call(LIMITER.half_lim, s - s_l, s_r - s, call(parts.limit, b))
    s_L, s_R = call(parts.weighted, s, e_s, b, returns=2)
    w = b + (1.0 - b * b) * (e_s / s)
    e_z = call(LIMITER.half_lim, z - z_l, z_r - z, call(parts.limit, w))
    z_L, z_R = call(parts.weighted, z, e_z, w, returns=2)
    expected = each(page, q, q_l, q_r, s, s_l, s_r, z, z_l, z_r)
    np.testing.assert_allclose((q - bq, q + bq, s_L, s_R, z_L, z_R), expected, rtol=1e-13, atol=1e-15)
    m_L, m_R = (q - bq) * s_L, (q + bq) * s_R
    assert (q >= np.abs(bq)).all()
    np.testing.assert_allclose((m_L + m_R) / 2, q * s, rtol=1e-14)
    np.testing.assert_allclose((m_L * z_L + m_R * z_R) / 2, q * s * z, atol=1e-16)
    for face in (z_L, z_R):
        assert (face <= np.maximum(np.maximum(z_l, z_r), z) + 1e-15).all()
        assert (face >= np.minimum(np.minimum(z_l, z_r), z) - 1e-15).all()


def test_jump_and_reconstruction() -> None:
    call = Caller(small())
    parts = reconstruction.make(KINDS, LIMITER)

    def page(X, P, wl, hold, SX_l, SP_l, SX_r, SP_r):  # type: ignore[no-untyped-def]
        return clip(-X - (SX_l + SX_r) / 2 + P - (wl * SP_l + (1 - wl) * SP_r), hold)

    terms = [draw(k, -1.0, 1.0) for k in range(6)]
    wl, hold = draw(7, 0.0, 1.0), draw(8, 0.0, 2.0, 0.3)
    arguments = terms[0], terms[1], wl, hold, *terms[2:]
    J = call(parts.jump, *arguments)
    np.testing.assert_allclose(J, each(page, *arguments)[0], atol=1e-15)
    q_l, q_r = draw(9, 0.0, 1.0, 0.2), draw(10, 0.0, 1.0, 0.2)
    expected = each(lambda l, r, J: (min(l, max(0.0, r - J)), min(r, max(0.0, l + J))), q_l, q_r, J)
    found = call(parts.reconstructed, q_l, q_r, J, returns=2)
    np.testing.assert_array_equal(found, expected)
    held = J == 0.0
    np.testing.assert_array_equal(found[0][held], found[1][held])


@pytest.mark.parametrize("speed", [0.1, 1.0, 10.0])
def test_flux(speed: float) -> None:
    call = Caller(small())
    g_c = call.case.g_c
    parts = flux.make(call.variant, reconstruction.make(KINDS, LIMITER), call.module)

    def speeds(
        rho_l: float, a_l: float, rho_r: float, a_r: float, dp: float, D: float
    ) -> tuple[float, float, float, float]:
        """S_l, c_l, S_r, c_r for dp >= 0."""
        S_l = a_l + 1.5 * max(0.0, dp / (rho_r * a_r) + D)
        c_l = rho_l * S_l
        S_r = a_r + (1.5 * max(0.0, -dp / c_l + D) if c_l > 0.0 else 0.0)
        return S_l, c_l, S_r, rho_r * S_r

    def page(q_l, s_l, v_l, q_r, s_r, v_r, most_l, most_r):  # type: ignore[no-untyped-def]
        rho_l, rho_r, dp, D = s_l * q_l, s_r * q_r, g_c * (q_r**2 - q_l**2) / 2, v_l - v_r
        a_l, a_r = math.sqrt(g_c * q_l / s_l), math.sqrt(g_c * q_r / s_r)
        if rho_l == rho_r == 0.0:
            return 0.0, 0.0, 0.0
        if dp >= 0.0:
            S_l, c_l, S_r, c_r = speeds(rho_l, a_l, rho_r, a_r, dp, D)
        else:
            S_r, c_r, S_l, c_l = speeds(rho_r, a_r, rho_l, a_l, -dp, D)
        k = 1.0 / (c_l + c_r)
        u, el, er = (c_l * v_l + c_r * v_r - dp) * k, c_l * (dp + c_r * D) * k, c_r * (c_l * D - dp) * k
        if u >= 0.0:
            F0 = 0.0 if rho_l == 0.0 else u * rho_l * c_l / (c_l - rho_l * (c_r * D + dp) * k)
            if rho_l > 0.0 and v_l - S_l >= 0.0:
                F0, u, el, er = rho_l * v_l, v_l, 0.0, -dp
            F0 = min(F0, most_l)
        else:
            F0 = 0.0 if rho_r == 0.0 else u * rho_r * c_r / (c_r - rho_r * (c_l * D - dp) * k)
            if rho_r > 0.0 and v_r + S_r <= 0.0:
                F0, u, el, er = rho_r * v_r, v_r, dp, 0.0
            F0 = max(F0, -most_r)
        return F0, F0 * u + el, F0 * u + er

    q_l, q_r = draw(1, 1e-3, 0.1, 0.2), draw(2, 1e-3, 0.1, 0.2)
    s_l, s_r, v_l, v_r = draw(3, 0.3, 0.8), draw(4, 0.3, 0.8), draw(5, -speed, speed, 0.2), draw(6, -speed, speed, 0.2)
    most_l, most_r = draw(7, 0.0, 0.2 * speed, 0.1), draw(8, 0.0, 0.2 * speed, 0.1)
    rho_l, rho_r = s_l * q_l, s_r * q_r
    dp = g_c * (q_r - q_l) * (q_r + q_l) / 2
    a_l, a_r = call(parts.impedance, q_l, rho_l), call(parts.impedance, q_r, rho_r)

    c_l, c_r = call(parts.speeds, dp, rho_l, a_l, rho_r, a_r, v_l - v_r, returns=2)
    found = call(parts.suliciu, rho_l, v_l, c_l, most_l, rho_r, v_r, c_r, most_r, dp, returns=3)
    expected = each(page, q_l, s_l, v_l, q_r, s_r, v_r, most_l, most_r)
    np.testing.assert_allclose(found, expected, rtol=1e-11, atol=1e-14)


@pytest.mark.parametrize("precision_name", ["float64", "float32"])
def test_no_mass_leaves_an_empty_side(precision_name: str) -> None:
    call = Caller(small(), precision_name)
    kinds = precision(precision_name)
    parts = flux.make(call.variant, reconstruction.make(kinds, limiter.make(kinds)), call.module)
    rho_l, v_l = np.array([0.0, 0.0, 0.0, 0.06, 1e-12]), np.array([0.0, 0.3, 0.0, 0.0, -0.1])
    rho_r, v_r = np.array([0.0, 0.0, 0.06, 0.0, 0.0]), np.array([0.0, 0.0, 0.0, 0.0, 0.0])
    q_l, q_r = rho_l / 0.8, rho_r / 0.8
    dp = call.case.g_c * (q_r - q_l) * (q_r + q_l) / 2
    c = (call(parts.impedance, q, rho) for q, rho in ((q_l, rho_l), (q_r, rho_r)))
    c_l, c_r = call(parts.speeds, dp, rho_l, next(c), rho_r, next(c), v_l - v_r, returns=2)
    F0, E_l, E_r = call(parts.suliciu, rho_l, v_l, c_l, 1.0, rho_r, v_r, c_r, 1.0, dp, returns=3)
    assert (np.sign(F0) == [0.0, 0.0, -1.0, 1.0, 0.0]).all()
    nothing = (rho_l == 0.0) & (rho_r == 0.0)
    np.testing.assert_allclose([E_l[nothing], E_r[nothing]], 0.0, atol=1e-18)


def test_stop() -> None:
    call = Caller(small())
    of = laws_of.make(call.variant)
    point = rheology.make(call.variant, of)
    stopped = update.make(call.variant, point, LIMITER, lanes.make(False), call.module).stopped
    U1, U0, r = draw(1, -1.0, 1.0, 0.1), draw(2, -0.1, 1.0), draw(3, 0.0, 1.0, 0.2)
    expected = each(lambda U1, U0, r: math.copysign(max(0.0, abs(U1) - max(0.0, U0) * r), U1), U1, U0, r)
    np.testing.assert_allclose(call(stopped, U1, U0, r), expected[0], atol=1e-16)
