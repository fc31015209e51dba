"""A flow computed on finer and finer grids, and its distance from the exact one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpgran.arrays import Array
from warpgran.case.case import Case
from warpgran.case.sections import Grid
from warpgran.run.simulate import simulate_quietly
from warpgran.verification.check import CheckOptions, Row, scheme
from warpgran.verification.exact import Flow

Fields = tuple[Array, Array, Array]
Exact = Callable[[Array, float], Fields]
"""h [m], v [m/s], phi at places x [m] and a time t [s]."""

POINTS = 16
"""Points in a cell over which an exact solution is averaged."""

G = Case().slope.gravity
"""m/s2."""
PHI = 0.6
"""Volume fraction where it plays no part."""


def coulomb(mu: float) -> dict[str, Any]:
    """Friction of a constant coefficient, and no dilatancy."""
    return {"rheology.mu1": mu, "rheology.mu2": mu, "rheology.K": 0.0}


def of_constant_phi(flow: Callable[[Array, float], Flow]) -> Exact:
    """An exact flow with the volume fraction PHI."""
    return lambda x, t: (*flow(x, t), np.full(x.shape, PHI))


def centres(left: float, right: float, cells: int) -> Array:
    """Cell centres of a grid from left to right, m."""
    return Grid(left=left, right=right, cells=cells).x


SMOOTH = {1: 0.9, 2: 1.9}
"""Order of accuracy asked for where the solution is smooth, by the order of the scheme."""


def starting_from(
    order: int, h: Array, v: Array | float, phi: Array | float, left: float, right: float, **changes: Any
) -> Case:
    """A case whose state at the cell centres at time 0 is this.

    Args:
        order: Of the scheme.
        h: Thickness, m, shape (cells,).
        v: Velocity, m/s.
        phi: Solid volume fraction.
        left: End of the grid, m.
        right: The other end, m.
        changes: Other values by dotted key.
    """
    profile = {
        "x": centres(left, right, h.size),
        "h": h,
        "v": np.broadcast_to(v, h.shape),
        "phi": np.broadcast_to(phi, h.shape),
    }
    return Case().with_(
        **{
            "column.profile": profile,
            "grid.left": left,
            "grid.right": right,
            "grid.cells": h.size,
            "time.series": [],
            **scheme(order),
            "scheme.h_front": 1e-3,
            "scheme.left": "open",
            "scheme.right": "open",
            **changes,
        }
    )


@dataclass(frozen=True)
class Computed:
    """A case computed on one grid.

    Attributes:
        x: Cell centres, m.
        h: Thickness, m, shape (times, cells).
        v: Velocity, m/s, the same.
        phi: Solid volume fraction, the same.
        dx: Cell size, m.
    """

    x: Array
    h: Array
    v: Array
    phi: Array
    dx: float


@dataclass(frozen=True)
class Comparison:
    """One problem on all grids, and its exact solution.

    Attributes:
        exact: The exact solution.
        times: Times of the comparison, s.
        grids: Results, coarse to fine.
        span: At each time, the ends of the interval compared, m.
    """

    exact: Exact
    times: tuple[float, ...]
    grids: tuple[Computed, ...]
    span: Callable[[float], tuple[float, float]]

    def error(self, name: str, at: int, grid: Computed, apart: tuple[float, float] | None = None) -> float:
        """Distance in L1 of "h", "h v" or "phi" from the exact cell averages, relative to the norm of those.

        Args:
            name: "h", "h v" or "phi".
            at: Which time.
            grid: Which result.
            apart: A place, m, and the distance from it, m, within which cells do not count.
        """
        low, high = self.span(self.times[at])
        inside = (grid.x > low) & (grid.x < high)
        if apart:
            inside &= np.abs(grid.x - apart[0]) > apart[1]
        offset = grid.dx * ((np.arange(POINTS) + 0.5) / POINTS - 0.5)
        fields = self.exact((grid.x[inside, None] + offset).ravel(), self.times[at])
        quantity = QUANTITIES[name]
        exact = quantity(*fields).reshape(-1, POINTS).mean(axis=1)
        found = quantity(grid.h[at, inside], grid.v[at, inside], grid.phi[at, inside])
        return float(np.abs(found - exact).sum() / np.abs(exact).sum())

    def row(
        self,
        name: str,
        at: int,
        least_order: float,
        most: float,
        where: str = "",
        apart: tuple[float, float] | None = None,
    ) -> Row:
        """The errors of a quantity on all grids, which must fall.

        Args:
            name: "h", "h v" or "phi".
            at: Which time.
            least_order: Over the three finest grids.
            most: Error of the finest.
            where: Words on what is compared.
            apart: As of `error`.
        """
        errors = tuple((grid.x.size, self.error(name, at, grid, apart)) for grid in self.grids)
        compared = f"{name} at t = {self.times[at]:.3g} s{where}, L1"
        return falling(compared, "-", errors, least_order, most)


QUANTITIES: dict[str, Callable[[Array, Array, Array], Array]] = {
    "h": lambda h, v, phi: h,
    "h v": lambda h, v, phi: h * v,
    "phi": lambda h, v, phi: phi,
}


def observed_order(errors: Sequence[tuple[int, float]]) -> float:
    """Order of accuracy over the three finest of (cells, error), by least squares; NaN if an error is 0."""
    cells, values = np.array(errors[-3:]).T
    if not values.all():
        return float("nan")
    return -float(np.polyfit(np.log(cells), np.log(values), 1)[0])


def falling(compared: str, unit: str, errors: Sequence[tuple[int, float]], least_order: float, most: float) -> Row:
    """A row for errors on finer and finer grids; an error of 0 on the finest holds whatever the order."""
    order, last = observed_order(errors), float(errors[-1][1])
    bound = f"order >= {least_order:g}, error <= {most:g}"
    held = last == 0.0 or (order >= least_order and last <= most)
    return Row(compared, last, unit, bound, bool(held), order, tuple(errors))


def compare(
    options: CheckOptions,
    start: Callable[[int], Case],
    exact: Exact,
    times: Sequence[float],
    coarsest: int,
    span: Callable[[float], tuple[float, float]] | None = None,
) -> Comparison:
    """Compute a problem on all grids.

    Args:
        options: How to compute.
        start: The case with so many cells.
        exact: The exact solution.
        times: Times of the comparison, s, > 0.
        coarsest: Cells of the first grid.
        span: The ends of the interval compared at a time, m; by default the grid's.
    """
    output = {"time.end": float(times[-1]), "time.snapshots": [float(t) for t in times]}
    cases = [start(cells).with_(**output) for cells in options.cells(coarsest)]
    grids = tuple(computed(case, options) for case in cases)
    ends = cases[0].grid.left, cases[0].grid.right
    return Comparison(exact, tuple(times), grids, span or (lambda t: ends))


def computed(case: Case, options: CheckOptions) -> Computed:
    """A case computed, at its snapshots.

    Raises:
        RuntimeError: It did not reach its end.
    """
    data = simulate_quietly(case, device=options.device, precision=options.precision).isel(run=0)
    if not np.isfinite(data["h"].values).all():
        raise RuntimeError(f"{case.title or 'a run'} with {case.grid.cells} cells did not reach its end")
    return Computed(data["x"].values, data["h"].values, data["v"].values, data["phi"].values, case.dx)
