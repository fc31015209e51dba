"""What is at rest stays at rest: a lake over a rough bed, and the second family of steady states."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from warpgran.arrays import Array
from warpgran.case.case import Case
from warpgran.figures.style import TIME_LABEL
from warpgran.run.options import Precision
from warpgran.run.simulate import simulate_quietly
from warpgran.verification.check import CheckOptions, CheckResult, Row, paragraphs
from warpgran.verification.grids import centres, computed, coulomb, falling, starting_from
from warpgran.verification.plots import COLOURS, MARKS, panels

CELLS = 200
LEVEL = 0.1
"""Level of the lake, m."""
ALPHAS = (1.5, 2.0, 3.0)
CREEP = 5.0
"""End time of the heaps, s."""
TIMES = (0.01, 0.03, 0.1, 0.3, 1.0)
BOUNDS: dict[Precision, float] = {"float64": 2e-13, "float32": 1e-4}
"""Bounds of v over the wave speed of the lake: a thousand units in the last place."""


def rough_bed(roughness: float) -> Array:
    """A bed drawn at random in every cell, m, with an island where roughness is more than LEVEL."""
    x = centres(0.0, 1.0, CELLS)
    draws = np.random.default_rng(1).uniform(-1.0, 1.0, CELLS)
    return 0.015 * draws + roughness * np.exp(-(((x - 0.5) / 0.1) ** 2))


def lake(order: int, roughness: float, mu: float, alpha: float) -> Case:
    """A level surface and constant phi: the first family, dry where the bed is higher."""
    bed = rough_bed(roughness)
    return _resting(order, np.maximum(LEVEL - bed, 0.0), np.full(CELLS, 0.6), bed, mu, alpha)


def second_family(order: int, mu: float, alpha: float) -> Case:
    """Constant h phi^(1 - alpha), with h (alpha - 1/2)/(alpha - 1) + b constant (B.3)."""
    bed = rough_bed(0.03)
    h = (LEVEL - bed) * (alpha - 1.0) / (alpha - 0.5)
    return _resting(order, h, 0.6 * (h / h.max()) ** (1.0 / (alpha - 1.0)), bed, mu, alpha)


def heap(order: int, cells: int, variation: float, jump: float = 0.0) -> Case:
    """A heap on a plane, less steep than friction holds.

    Args:
        order: Of the scheme.
        cells: Of the grid.
        variation: By which phi varies along it.
        jump: By which phi falls in every second tenth of a metre; h jumps too, so that the pressure does not.
    """
    x = centres(0.0, 1.0, cells)
    h = np.maximum(LEVEL - 0.3 * np.abs(x - 0.5), 0.0)
    phi = 0.58 + variation * np.sin(4.0 * np.pi * x) - jump * (np.floor(10.0 * x) % 2.0)
    if jump > 0.0:
        h = h * np.sqrt(0.58 / phi)
    return starting_from(order, h, 0.0, phi, 0.0, 1.0, **coulomb(0.48))


def _resting(order: int, h: Array, phi: Array, bed: Array, mu: float, alpha: float) -> Case:
    x = centres(0.0, 1.0, CELLS)
    closed = {"scheme.left": "wall", "scheme.right": "wall", "scheme.alpha": alpha}
    table = {"slope.bed": {"x": x, "b": bed}}
    return starting_from(order, h, 0.0, phi, 0.0, 1.0, **closed, **table, **coulomb(mu))


STATES: dict[str, Callable[[int, float, float], Case]] = {
    "lake": lambda order, mu, alpha: lake(order, 0.05, mu, alpha),
    "lake with an island": lambda order, mu, alpha: lake(order, 0.15, mu, alpha),
    "second family": second_family,
}


@dataclass(frozen=True)
class Circumstance:
    """Friction and viscosity under which a state must rest, and whether that is required or only reported."""

    words: str
    mu: tuple[float, ...]
    viscous: bool
    asked: bool


CIRCUMSTANCES = {
    1: (
        Circumstance("xi = 0", (0.0, 0.5), viscous=False, asked=True),
        Circumstance("default xi, mu = 0.5", (0.5,), viscous=True, asked=False),
        Circumstance("default xi, mu = 0", (0.0,), viscous=True, asked=False),
    ),
    2: (
        Circumstance("mu = 0.5", (0.5,), viscous=True, asked=True),
        Circumstance("mu = 0", (0.0,), viscous=True, asked=True),
    ),
}
"""By the order of the scheme; order 2 has no viscosity."""
NOT_KEPT = {("second family", "mu = 0"), ("lake with an island", "mu = 0.5")}
"""States that order 2 does not keep: reported."""


def at_rest(options: CheckOptions) -> CheckResult:
    """Both families, three values of alpha, with and without friction and viscosity, in both precisions."""
    rows = []
    circumstances = CIRCUMSTANCES[options.order]
    figure, (profile, *speeds) = panels(1 + len(circumstances), rows=2 if len(circumstances) == 3 else 1)
    _draw_states(profile)
    for circumstance, ax in zip(circumstances, speeds, strict=True):
        for n, (words, state) in enumerate(STATES.items()):
            for precision, bound in BOUNDS.items():
                cases = [state(options.order, mu, alpha) for alpha in ALPHAS for mu in circumstance.mu]
                fastest = _fastest(cases, circumstance.viscous, replace(options, precision=precision))
                worst = float(fastest.max())
                if options.order == 2 and circumstance.mu == (0.5,):
                    bound = 0.0
                known = (words, circumstance.words) in NOT_KEPT
                asked = (f"<= {bound:g}", worst <= bound) if circumstance.asked and not known else ("reported", None)
                rows.append(Row(f"{words}, {precision}, {circumstance.words}: max |v|/c", worst, "-", *asked))
                line = "-" if precision == "float64" else "--"
                shown = np.maximum(fastest, 1e-18)
                label = words if line == "-" else None
                ax.loglog(TIMES, shown, line, color=COLOURS[n], marker=MARKS[n], markersize=3, label=label)
        ax.set(xlabel=TIME_LABEL, ylabel="largest speed $|v|/c$ (-)", ylim=(1e-18, 10.0))
        ax.set_title(circumstance.words, fontsize=8, pad=3)
    speeds[0].legend(fontsize=6.5, loc="center", labelspacing=0.2)
    rows += _heaps(options)
    figure.set_label(
        "(a) The states for alpha = 2: beds in grey, surfaces in blue and orange. Other panels: the largest "
        "speed that arises, relative to the wave speed of the lake, with and without viscosity (order 1) and friction; "
        "full lines float64, dashed float32."
    )
    text = paragraphs(f"""
        A bed drawn at random in each of {CELLS} cells, and two families of steady states that the step of order 1
        keeps exactly (Theorem B.1, iii, of the paper): a level surface with constant phi, and constant h phi^(1 -
        alpha) with h (alpha - 1/2)/(alpha - 1) + b constant. The lake is computed with and without an island that
        stands out of it; each state with alpha = 1.5, 2 and 3, with mu = 0 and 0.5, up to {TIMES[-1]:g} s; the worst
        counts.

        Exact means to rounding: a velocity below a thousand units in the last place of the wave speed c = sqrt(g h)
        of the lake.

        With the stabilizing viscosity, on by default, rest is still a steady state, for the viscosity iota = (v Dz)_+
        is 0 there, but over a rough bed not always a stable one (order 1): iota grows with the rounding in v, and it
        levels thicknesses, not the surface, so that it carries mass uphill. Without friction rounding then grows
        within a second to motions of a tenth of the wave speed; with friction and constant phi it stays rounding;
        with friction and the phi of the second family it grows until the cells creep at some 1e-4 of the wave speed.
        This is so of the paper's (3.20) as of the bounded form here: a lake wants xi = 0. These rows are reported,
        not asked.

        A heap on a plane, less steep than friction holds, rests exactly where phi is constant. Where phi varies along
        it the heap belongs to neither family, and under order 1 friction does not hold it exactly: it creeps, with
        and without viscosity, by 0.1 % of its thickness in {CREEP:g} s on 100 cells. That is an error of the scheme
        which must vanish with dx: order 1 at least, 0.9 asked. Order 2 holds whatever friction can hold of the
        discrete forces, to the last bit: constant phi, varying phi, and jumps of phi that leave the pressure as it
        is. Asked is v = 0 and no change at all.

        Order 2 keeps a lake, with constant phi, to rounding; the second family only to its order, unless friction
        holds it. An island that stands out of a lake over a bed rougher than friction holds is not kept with
        friction: in the first dry cell of the shore the slope of the bed is limited together with that of the next
        dry cell, friction is taken off what remains of it, and the sum can change its sign; then a cell of the shore
        spills over its edge and back, at a twentieth of the wave speed, which moves a hundred-thousandth of the
        whole. Without friction the island is kept. Both are reported.
        """)
    return CheckResult("Steady states at rest", text, tuple(rows), {"at_rest": figure})


def _fastest(cases: Sequence[Case], viscous: bool, options: CheckOptions) -> Array:
    """Largest |v|/c at each of TIMES in any of the cases."""
    changes: dict[str, Any] = {"time.end": TIMES[-1], "time.snapshots": list(TIMES)}
    if not viscous:
        changes["scheme.xi"] = [0.0, 0.0, 0.0]
    data = simulate_quietly(
        [case.with_(**changes) for case in cases], device=options.device, precision=options.precision
    )
    c = np.sqrt(cases[0].g_c * LEVEL)
    return np.asarray(np.abs(data["v"].values).max(axis=(0, 2)) / c)


def _heaps(options: CheckOptions) -> list[Row]:
    """How a heap that friction holds changes, with phi constant, varying, and with jumps."""
    if options.order == 2:
        return [_held(words, heap(2, 400, variation, jump), options) for words, variation, jump in HEAPS]
    changes = []
    for variation, cells in ((0.0, (400,)), (0.02, options.cells(100))):
        for n in cells:
            changes.append((n, _change(heap(1, n, variation), options)))
    (_, constant), *varying = changes
    most = 1e-12 if options.precision == "float64" else 1e-4
    kept = Row(f"heap held by friction, constant phi: change of h in {CREEP:g} s, L1", constant, "-", f"<= {most:g}",
               constant <= most)  # fmt: skip
    words = f"heap held by friction, phi = 0.58 +- 0.02: change of h in {CREEP:g} s, L1"
    jumps = _change(heap(1, 400, 0.0, 0.08), options)
    jumping = f"heap held by friction, jumps of phi: change of h in {CREEP:g} s, L1"
    return [kept, falling(words, "-", varying, 0.9, 0.01), Row(jumping, jumps, "-", "reported", None)]


HEAPS = (("constant phi", 0.0, 0.0), ("phi = 0.58 +- 0.02", 0.02, 0.0), ("jumps of phi", 0.0, 0.08))


def _change(case: Case, options: CheckOptions) -> float:
    h, _ = case.initial_state()
    ending = case.with_(**{"time.end": CREEP, "time.snapshots": [CREEP]})
    return float(np.abs(computed(ending, options).h[0] - h).sum() / h.sum())


def _held(words: str, case: Case, options: CheckOptions) -> Row:
    """Friction holds the drive to the last bit: no velocity arises, and h is that of the first moment."""
    found = computed(case.with_(**{"time.end": CREEP, "time.snapshots": [1e-3, CREEP]}), options)
    worst = float(max(np.abs(found.v).max(), np.abs(found.h[1] - found.h[0]).max()))
    return Row(f"heap held by friction, {words}: max |v| and change of h in {CREEP:g} s", worst, "-", "0", worst == 0.0)


def _draw_states(ax: Axes) -> None:
    island, second = lake(1, 0.15, 0.0, 2.0), second_family(1, 0.0, 2.0)
    for case, colour, words in ((island, COLOURS[0], "lake with an island"), (second, COLOURS[1], "second family")):
        h, _ = case.initial_state()
        ax.plot(case.x, 100 * case.bed, color="0.6", linewidth=0.5)
        surface = np.where(h > 0.0, case.bed + h, np.nan)
        ax.plot(case.x, 100 * surface, color=colour, label=words)
    ax.set(xlabel="place $x$ (m)", ylabel="elevation (cm)")
    ax.legend(fontsize=6.5)
