"""Exact solutions to verify against. NumPy alone: what judges the kernels shares no code with them.

All are solutions of the model of `physics.first_order` in SI units: x [m] along the slope, positive downhill; t [s];
h [m], v [m/s] and phi [-] as arrays over x; g_c = g cos(theta) [m/s2]. A wave speed is c = sqrt(g_c h). With phi
constant and mu1 = mu2 = tan(delta), K = 0, the model is

    d_t h + d_x(h v) = 0,    d_t(h v) + d_x(h v^2 + g_c h^2/2) = g_c h (tan(theta) - tan(delta) sgn(v)),

so that whatever moves downhill is accelerated by m = g_c (tan(theta) - tan(delta)) [m/s2], and with x - m t^2/2 for x
and v - m t for v the equations are those of shallow water on a horizontal bed, as long as no part is at rest.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from warpgran.arrays import Array


class Flow(NamedTuple):
    """Thickness h [m] and velocity v [m/s] at the places asked for; v = 0 where there is nothing."""

    h: Array
    v: Array


class Uniform(NamedTuple):
    """A uniform state: thickness h [m], velocity v [m/s], solid volume fraction phi [-]."""

    h: float
    v: float
    phi: float


def root(f: Callable[[float], float], low: float, high: float) -> float:
    """Where an increasing function changes sign between two points, by bisection, to the last digit."""
    while True:
        middle = 0.5 * (low + high)
        if not low < middle < high:
            return middle
        low, high = (low, middle) if f(middle) > 0.0 else (middle, high)


def ritter(x: Array, t: float, h_0: float, g_c: float) -> Flow:
    """Dam break onto a dry horizontal bed, without friction, the dam at x = 0 and the mass on its left.

    Ritter (1892): h = (2 c_0 - x/t)^2/(9 g_c) and v = 2/3 (c_0 + x/t) for -c_0 t < x < 2 c_0 t. Holds for t > 0.
    """
    c_0, s = np.sqrt(g_c * h_0), x / t
    c = np.clip((2.0 * c_0 - s) / 3.0, 0.0, c_0)
    return Flow(c**2 / g_c, np.where(c > 0.0, 2.0 * (c_0 - c), 0.0))


def stoker(x: Array, t: float, h_l: float, h_r: float, g_c: float) -> Flow:
    """Dam break onto a layer at rest of thickness 0 < h_r < h_l, without friction, the dam at x = 0.

    Stoker (1957): a rarefaction, a uniform state and a bore. The wave speed c_m of the uniform state solves
    8 g_c h_r c_m^2 (c_l - c_m)^2 = (c_m^2 - g_c h_r)^2 (c_m^2 + g_c h_r), which is the form of the SWASHES library
    (Delestre et al., 2013). Holds for t > 0.
    """
    c_l, square = np.sqrt(g_c * h_l), g_c * h_r

    def excess(c: float) -> float:
        return (c**2 - square) ** 2 * (c**2 + square) - 8.0 * square * c**2 * (c_l - c) ** 2

    c_m = root(excess, float(np.sqrt(square)), float(c_l))
    v_m, s = 2.0 * (c_l - c_m), x / t
    c = np.clip((2.0 * c_l - s) / 3.0, c_m, c_l)
    behind = s < v_m * c_m**2 / (c_m**2 - square)
    return Flow(np.where(behind, c**2 / g_c, h_r), np.where(behind, 2.0 * (c_l - c), 0.0))


def acceleration(theta: float, delta: float, g: float) -> float:
    """What moves downhill on a slope theta with friction angle delta [rad] is accelerated by this [m/s2]."""
    return float(g * np.cos(theta) * (np.tan(theta) - np.tan(delta)))


def sliding_dam(x: Array, t: float, h_0: float, m: float, g_c: float) -> Flow:
    """Dam break on a dry slope steeper than the friction angle, m > 0, the dam at x = 0.

    Mangeney, Heinrich and Roche (2000): Ritter's solution in the frame that moves with the acceleration,
    h = (2 c_0 - x/t + m t/2)^2/(9 g_c) and v = 2/3 (c_0 + x/t + m t) for m t^2/2 - c_0 t < x < m t^2/2 + 2 c_0 t. On
    the left of it the undisturbed mass, without an end on that side, slides with m t. Holds for t > 0.

    For m < 0 this is no solution, though its front is right: see `BrakedDam`.
    """
    h, v = ritter(x - 0.5 * m * t**2, t, h_0, g_c)
    return Flow(h, np.where(h > 0.0, v + m * t, 0.0))


class BrakedDam:
    """Dam break on a dry slope less steep than the friction angle, m < 0, the dam at x = 0, until it rests.

    The front is that of `sliding_dam`, x = 2 c_0 t - |m| t^2/2, and stops at t = 2 c_0/|m|, x = 2 c_0^2/|m| =
    2 h_0/(tan(delta) - tan(theta)). Behind it that formula fails: friction holds the undisturbed mass, which does not
    slide back, and every point of the fan hears of that by a characteristic. Faccanoni and Mangeney (2013) treat this
    problem; here it is solved by the hodograph transform, as follows, in units of c_0 and |m|, so that it is the same
    curve for all slopes, frictions and thicknesses.

    In the frame of the acceleration, with u = v + t, the invariants a = u + 2 c and b = u - 2 c are constant along
    dx/dt = u + c and u - c. As functions of them, t and x obey

        t_ab = 3/2 (t_a - t_b)/(a - b),    x_b = (u + c) t_b,    x_a = (u - c) t_a,

    linear, with t = x = 0 on a = 2, the fan at the dam, and on the left edge of what moves, where v = 0 and c = 1,
    t = a - 2 on b = a - 4. The edge runs uphill until its surface has the slope that friction holds; from then on the
    mass stops where its v is 0, from the edge to the front, and keeps its thickness: the speed of that point is above
    c, so that nothing that comes to rest acts on what still moves. With w = (a - b)^(3/2) t the first equation is
    w_ab = -3/4 w/(a - b)^2, which is solved by central differences over a grid of equal steps; second order.

    Attributes:
        stop_time: When all is at rest, s.
        run_out: Where the front then is, m.
        edge: Left end of what has moved, m; the mass left of it keeps h_0.
        arrest: When the mass begins to stop, there, s.
    """

    def __init__(self, h_0: float, m: float, g_c: float, steps: int = 600) -> None:
        """Solve it.

        Args:
            h_0: Thickness behind the dam, m.
            m: Acceleration, m/s2, < 0.
            g_c: Gravity normal to the slope, m/s2.
            steps: Steps of the grid in b; the error goes as their square, and is 1e-5 in the mass that moves for 600.

        Raises:
            ValueError: m >= 0.
        """
        if not m < 0.0:
            raise ValueError(f"m = {m:g} m/s2 is out of range; allowed: < 0")
        c_0 = float(np.sqrt(g_c * h_0))
        self._h, self._speed, self._time, self._length = h_0, c_0, c_0 / -m, c_0**2 / -m
        self.stop_time, self.run_out = 2.0 * self._time, 2.0 * self._length
        t, x, self._a, self._b = _hodograph(steps)
        edge = x.diagonal()
        last = int(np.argmin(edge))
        self._t, self._x, self._rows = t, x, last + 1
        self.edge, self.arrest = float(edge[last]) * self._length, float(self._a[last] - 2.0) * self._time
        self._stops = np.array([self._stop(i) for i in range(1, self._rows)])  # t, x, c where v = 0

    def _row(self, i: int) -> tuple[Array, Array, Array, Array]:
        """Along the forward characteristic i, from the edge on: t, x, v, c."""
        t, a, b = self._t[i, i:], self._a[i], self._b[i:]
        return t, self._x[i, i:], 0.5 * (a + b) - t, 0.25 * (a - b)

    def _stop(self, i: int) -> tuple[float, float, float]:
        """Where the velocity on the characteristic i returns to 0: t, x, c."""
        t, x, v, c = self._row(i)
        after = 1 + int(np.argmax(v[1:] <= 0.0))  # 1 on the last of all, on which v = 0 from the start
        share = v[after - 1] / (v[after - 1] - v[after]) if after > 1 else 0.0
        at_t, at_x, at_c = (float(q[after - 1] + share * (q[after] - q[after - 1])) for q in (t, x, c))
        return at_t, at_x, at_c

    def at(self, x: Array, t: float) -> Flow:
        """Thickness and velocity at the time t [s] >= 0 at the places x [m]."""
        now = min(t / self._time, 2.0)
        points = [(2.0 * now - 0.5 * now**2, 2.0 - now, 0.0)]  # x, v, c from the front uphill
        for i in range(1, self._rows):
            stops, place, c_there = self._stops[i - 1]
            if stops <= now:
                points.append((place, 0.0, c_there))
            elif self._a[i] - 2.0 < now:
                times, places, v, c = self._row(i)
                points.append((np.interp(now, times, places), np.interp(now, times, v), np.interp(now, times, c)))
        since = self._a[: self._rows] - 2.0
        if now < since[-1]:  # the edge still runs uphill
            points.append((np.interp(now, since, self._x.diagonal()[: self._rows]), 0.0, 1.0))
        x_of, v_of, c_of = np.array(points)[::-1].T
        c = np.interp(x / self._length, x_of, c_of, left=1.0, right=0.0)
        v = np.interp(x / self._length, x_of, v_of, left=0.0, right=0.0)
        return Flow(self._h * c**2, self._speed * v)


def _hodograph(n: int) -> tuple[Array, Array, Array, Array]:
    """t and x of `BrakedDam` on the grid a_i = 2 + 4 i/n, b_k = -2 + 4 k/n, known where k >= i, and a and b.

    x is in the frame of the slope.
    """
    step = 4.0 / n
    a, b = 2.0 + step * np.arange(n + 1), -2.0 + step * np.arange(n + 1)
    w = np.zeros((a.size, b.size))
    for along in range(2, a.size + b.size - 1):  # i + k: each of its points follows from the two sums before
        if along % 2 == 0 and along // 2 < a.size:
            w[along // 2, along // 2] = 8.0 * (a[along // 2] - 2.0)
        i = np.arange(max(1, along - n), min(a.size, (along + 1) // 2))
        k = along - i
        q = 3.0 * step**2 / (16.0 * (a[i] - b[k]) ** 2)  # a - b at the middle of the square is that at its corner
        w[i, k] = ((1.0 - q) * (w[i, k - 1] + w[i - 1, k]) - (1.0 + q) * w[i - 1, k - 1]) / (1.0 + q)
    difference = a[:, None] - b
    t = np.divide(w, difference**1.5, out=np.zeros_like(w), where=difference > 0.0)
    back = 0.25 * (a[:, None] + 3.0 * b)  # u - c
    x = np.zeros_like(t)
    x[1:] = np.cumsum(0.5 * (back[1:] + back[:-1]) * np.diff(t, axis=0), axis=0)
    return t, x - 0.5 * t**2, a, b


def cap(x: Array, t: float, h_0: float, length: float, m: float, g_c: float) -> Flow:
    """A parabolic cap that slides from rest down a dry slope steeper than the friction angle and spreads.

    Savage and Hutter (1989), with an earth-pressure coefficient of 1. The cap h = h_0 (1 - (x/L)^2), |x| < L, stays
    one: h = h_0/G (1 - s^2), s = (x - m t^2/2)/(L G), v = m t + s L G'. In the momentum equation d_t v + v d_x v =
    m - g_c d_x h the left side is m + s L G'' and d_x h = -2 h_0 s/(L G^2), so that

        G'' = 2 B/G^2,  B = g_c h_0/L^2,  G(0) = 1, G'(0) = 0;    G' = 2 sqrt(B (1 - 1/G)),
        2 sqrt(B) t = sqrt(G (G - 1)) + ln(sqrt(G) + sqrt(G - 1)).

    Friction acts uphill on all of it only if all moves downhill: v >= 0 at the tail, s = -1, asks for
    m >= 2 g_c h_0/L at t = 0 and then holds for good, since L G'' falls.

    Args:
        x: m.
        t: s, >= 0.
        h_0: Initial thickness at the middle, m.
        length: L, half of the initial length, m.
        m: Acceleration, m/s2.
        g_c: Gravity normal to the slope, m/s2.

    Raises:
        ValueError: The tail would move uphill.
    """
    if m < 2.0 * g_c * h_0 / length:
        raise ValueError(
            f"m = {m:g} m/s2 is out of range; allowed: >= 2 g_c h_0/L, which is {2 * g_c * h_0 / length:g}"
        )
    B = g_c * h_0 / length**2
    late = 2.0 * np.sqrt(B) * t

    def lateness(G: float) -> float:
        return float(np.sqrt(G * (G - 1.0)) + np.log(np.sqrt(G) + np.sqrt(G - 1.0)) - late)

    G = root(lateness, 1.0, 2.0 + late)
    s = (x - 0.5 * m * t**2) / (length * G)
    inside = np.abs(s) < 1.0
    v = m * t + s * length * 2.0 * np.sqrt(B * (1.0 - 1.0 / G))
    return Flow(np.where(inside, h_0 / G * (1.0 - s**2), 0.0), np.where(inside, v, 0.0))


def contact(left: Uniform, right: Uniform, g_c: float) -> tuple[float, float]:
    """Velocity v [m/s] of the contact of a Riemann problem, and q = sqrt(phi) h [m] on either side of it.

    phi is carried with the mass, so that phi is constant on either side of a contact at which v and the pressure
    g_c phi h^2/2 are continuous, and q with them. Within a side phi drops out of mass and momentum, and the outer waves
    are those of shallow water: with f(h, h_k) = 2 (c - c_k) in a rarefaction, h < h_k, and
    (h - h_k) sqrt(g_c/2 (1/h + 1/h_k)) through a shock, v = v_l - f(h_l*, h_l) = v_r + f(h_r*, h_r) is one equation for
    q, solved by bisection.

    Raises:
        ValueError: A side is dry, or the two leave a dry gap.
    """
    if min(left.h, right.h) <= 0.0:
        raise ValueError("both sides must be wet")
    if right.v - left.v >= 2.0 * np.sqrt(g_c) * (np.sqrt(left.h) + np.sqrt(right.h)):
        raise ValueError("the two sides part and leave a dry gap")

    def wave(h: float, h_k: float) -> float:
        if h <= h_k:
            return float(2.0 * np.sqrt(g_c) * (np.sqrt(h) - np.sqrt(h_k)))
        return float((h - h_k) * np.sqrt(0.5 * g_c * (1.0 / h + 1.0 / h_k)))

    def parting(q: float) -> float:
        return wave(q / left.phi**0.5, left.h) + wave(q / right.phi**0.5, right.h) + right.v - left.v

    high = 1.0
    while parting(high) < 0.0:
        high *= 2.0
    q = root(parting, 0.0, high)
    return left.v - wave(q / left.phi**0.5, left.h), q


def riemann(x: Array, t: float, left: Uniform, right: Uniform, g_c: float) -> tuple[Array, Array, Array]:
    """Riemann problem of the homogeneous system, with a jump of phi: h, v, phi at the time t > 0.

    Two outer waves, rarefactions or shocks, and a `contact` between them, by the Rankine-Hugoniot relations and the
    Riemann invariants of (phi h, phi h v, phi); the system is that of Ripa (1993).

    Args:
        x: m, the jump being at 0.
        t: s.
        left: State on the left, h > 0.
        right: State on the right, h > 0.
        g_c: Gravity normal to the slope, m/s2.

    Raises:
        ValueError: A side is dry, or the two leave a dry gap.
    """
    v, q = contact(left, right, g_c)
    s = x / t
    h_left, v_left = _outer_wave(s, left.h, left.v, q / left.phi**0.5, v, g_c)
    h_right, v_right = _outer_wave(-s, right.h, -right.v, q / right.phi**0.5, -v, g_c)
    on_left = s < v
    return (
        np.where(on_left, h_left, h_right),
        np.where(on_left, v_left, -v_right),
        np.where(on_left, left.phi, right.phi),
    )


def _outer_wave(s: Array, h_k: float, v_k: float, h: float, v: float, g_c: float) -> tuple[Array, Array]:
    """The left-going wave from a state (h_k, v_k) to the state (h, v) beside the contact, over s = x/t."""
    if h > h_k:
        before = s < v_k - np.sqrt(0.5 * g_c * h * (h + h_k) / h_k)
        return np.where(before, h_k, h), np.where(before, v_k, v)
    c_k = np.sqrt(g_c * h_k)
    c = np.clip((v_k + 2.0 * c_k - s) / 3.0, np.sqrt(g_c * h), c_k)
    return c**2 / g_c, v_k + 2.0 * (c_k - c)


def uniform_flow(
    h: float, theta: float, mu1: float, mu2: float, I0: float, d: float, K_tilde: float, phi_stat: float, g: float
) -> Uniform:
    """Steady uniform layer on a plane between the angles of mu1 and mu2, with the law f2, N = 1, of phi_eq.

    At rest with itself phi = phi_eq(I), so that tan(psi) = 0 and friction is mu(I) (2.14); it balances gravity at
    I = I0 (tan(theta) - mu1)/(mu2 - tan(theta)). (2.10), (2.11) and (2.15) then give v = 2/5 (I h/d) sqrt(phi g_c h).

    Args:
        h: Thickness, m.
        theta: Slope, rad.
        mu1: Friction at a vanishing inertial number.
        mu2: Friction at a large one.
        I0: Inertial number of the mean of them.
        d: Grain diameter, m.
        K_tilde: Slope of phi_eq.
        phi_stat: phi_eq at rest.
        g: Gravity, m/s2.

    Raises:
        ValueError: The slope is not between atan(mu1) and atan(mu2).
    """
    slope = float(np.tan(theta))
    if not mu1 < slope < mu2:
        raise ValueError(f"tan(theta) = {slope:g} is out of range; allowed: > {mu1:g} and < {mu2:g}")
    I = I0 * (slope - mu1) / (mu2 - slope)
    phi = phi_stat / (1.0 + K_tilde * I / phi_stat)
    return Uniform(h, float(0.4 * I * h / d * np.sqrt(phi * g * np.cos(theta) * h)), phi)


def dilatancy(
    t: Array, phi_0: float, mass: float, v: float, K: float, K_tilde: float, phi_stat: float, d: float, g_c: float
) -> Array:
    """Volume fraction at times t >= 0 [s] of a uniform layer of constant velocity, by the dilatancy law alone.

    At a given mass U = phi h and velocity the law (2.2), (2.8) is phi' = -r phi^2 (phi - phi_eq), r = 5/2 K |v|/U, and
    the inertial number (2.10), (2.11), (2.15) is I = k phi, k = 5/2 |v| d/(U sqrt(g_c U)). With f2 and N = 1,
    phi_eq = phi_s/(1 + b phi), b = K_tilde k/phi_s, and

        -r dt = (1 + b phi) dphi/(phi^2 (b phi^2 + phi - phi_s)),

    integrated by partial fractions over the roots p_1 > 0 > p_2 of b phi^2 + phi - phi_s, and inverted by bisection
    between phi_0 and p_1, which is the limit for late times. Holds while h > h_min.

    Args:
        t: s, infinity allowed.
        phi_0: Solid volume fraction at time 0.
        mass: U, m.
        v: Velocity, m/s.
        K: Dilation coefficient.
        K_tilde: Slope of phi_eq, > 0.
        phi_stat: phi_s.
        d: Grain diameter, m.
        g_c: Gravity normal to the slope, m/s2.
    """
    rate = 2.5 * K * abs(v) / mass
    b = K_tilde * 2.5 * abs(v) * d / (mass * np.sqrt(g_c * mass)) / phi_stat
    p_2 = -(1.0 + np.sqrt(1.0 + 4.0 * b * phi_stat)) / (2.0 * b)
    p_1 = -phi_stat / (b * p_2)  # the product of the roots is -phi_s/b; no cancellation
    C_1 = (1.0 + b * p_1) / (b * p_1**2 * (p_1 - p_2))
    C_2 = (1.0 + b * p_2) / (b * p_2**2 * (p_2 - p_1))

    def integral(phi: float) -> float:
        logs = C_1 * np.log(abs(1.0 - p_1 / phi)) + C_2 * np.log(abs(1.0 - p_2 / phi))
        return float(logs + 1.0 / (phi_stat * phi))

    def at(time: float) -> float:
        if phi_0 < p_1:
            return root(lambda phi: integral(phi_0) - integral(phi) - rate * time, phi_0, float(p_1))
        return root(lambda phi: rate * time - integral(phi_0) + integral(phi), float(p_1), phi_0)

    return np.array([at(time) for time in np.ravel(t)])
