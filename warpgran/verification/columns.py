"""Columns of any aspect ratio that collapse on a horizontal plane, against laws that experiments gave."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from warpgran.arrays import Array
from warpgran.case.case import Case
from warpgran.figures.style import STYLE, WIDTH, letter
from warpgran.run.options import Precision
from warpgran.run.simulate import simulate_quietly
from warpgran.schema import Status
from warpgran.verification.check import CheckOptions, CheckResult, Row, scheme

LENGTH = 0.2
"""Length l_0 of the columns, m."""
ASPECT_RATIOS = tuple(float(a) for a in np.geomspace(0.2, 5.0, 15))
SHALLOW = 1.0
"""Aspect ratio up to which a depth-averaged model is meant to hold (Mangeney-Castelnau et al. 2005)."""
STEEP: dict[str, Any] = {"rheology.mu1": 1.5, "rheology.mu2": 1.75}
"""Friction that no grains have, whose run-outs must lie below the band."""


def lube(a: Array) -> Array:
    """Run-out of Lube et al. (2005), Phys. Rev. E 72, 041301: 1.2 a, then 1.9 a^(2/3) where that is less."""
    return np.minimum(1.2 * a, 1.9 * a ** (2.0 / 3.0))


def lajeunesse(a: Array) -> Array:
    """Run-out of Lajeunesse et al. (2005), Phys. Fluids 17, 103302: 1.8 a, then 2.3 a^(2/3) where that is less."""
    return np.minimum(1.8 * a, 2.3 * a ** (2.0 / 3.0))


def band(a: Array) -> tuple[Array, Array]:
    """Run-outs between which grains are: the lower law less a tenth, the upper one and three tenths more.

    The laws are those of two laboratories, whose grains, walls and gates differ; the wider margin above is for what the
    hydrostatic pressure adds, section 4.2 of the paper.
    """
    return 0.9 * lube(a), 1.3 * lajeunesse(a)


@dataclass(frozen=True)
class Deposits:
    """Deposits of columns.

    Attributes:
        a: Aspect ratios h_0/l_0.
        run_out: (l - l_0)/l_0.
        height: h/l_0 of the highest place.
    """

    a: Array
    run_out: Array
    height: Array


def column(order: int, cells_per_length: int, **changes: Any) -> Case:
    """A column beside a wall; a sweep gives it its height. The front is where h falls through 5 mm."""
    right = 3.6
    return Case().with_(
        **{
            "grid.left": 0.0,
            "grid.right": right,
            "grid.cells": round(cells_per_length * right / LENGTH),
            "column.length": LENGTH,
            "time.end": 4.0,
            "time.snapshots": [4.0],
            "time.series": {"every": 0.02},
            "time.rest_speed": 1e-3,
            "time.stop_at_rest": True,
            **scheme(order),
            "scheme.h_front": 5e-3,
            **changes,
        }
    )


def collapse(case: Case, ratios: Sequence[float], device: str = "cpu", precision: Precision = "float64") -> Deposits:
    """Columns of these aspect ratios, all in one batch, when they have come to rest.

    Raises:
        RuntimeError: One of them did not.
    """
    a = np.array(ratios)
    data = simulate_quietly(case.sweep({"column.height": (a * LENGTH).tolist()}), device=device, precision=precision)
    if (data["status"] != Status.AT_REST).any():
        moving = ", ".join(f"{ratio:.3g}" for ratio in a[data["status"].values != Status.AT_REST])
        raise RuntimeError(f"columns of aspect ratio {moving} did not come to rest")
    return _measure(a, data)


def _measure(a: Array, data: xr.Dataset) -> Deposits:
    last = data.isel(series_time=-1)
    return Deposits(a, last["front"].values / LENGTH - 1.0, last["h_max"].values / LENGTH)


def columns(options: CheckOptions, cells_per_length: int = 200, ratios: Sequence[float] = ASPECT_RATIOS) -> CheckResult:
    """Run-out and height over the aspect ratio, with the friction of glass beads and with far too much."""
    beads, steep = (
        collapse(column(options.order, cells_per_length, **grains), ratios, options.device, options.precision)
        for grains in ({}, STEEP)
    )
    text = (
        "Columns of 0.2 m length beside a wall, of aspect ratio a = h_0/l_0 from 0.2 to 5, on a horizontal bed, with "
        "the grains of Table 1; the run-out l is where the deposit is 5 mm thick. Experiments in channels gave "
        "(l - l_0)/l_0 = 1.2 a for small and 1.9 a^(2/3) for large a (Lube et al. 2005), and 1.8 a and 2.3 a^(2/3) "
        "(Lajeunesse et al. 2005); each law is drawn with the lesser of its two branches.",
        "A depth-averaged model holds for a <= 1 (Mangeney-Castelnau et al. 2005): above, grains fall before they "
        "spread, which the hydrostatic pressure knows nothing of, and the computed run-out grows faster than theirs. "
        "That is shown, not asked. The summit of a column of a < 0.7 stays where it was (Lajeunesse et al. 2005), here "
        "too; above, heights grow with a power of a, 1/3 or 2/5 in the experiments.",
    )
    return CheckResult("Columns of any aspect ratio", text, _rows(beads, steep), {"columns": draw(beads, steep)})


def _rows(beads: Deposits, steep: Deposits) -> tuple[Row, ...]:
    low, high = band(beads.a)
    shallow, tall, flat = beads.a <= SHALLOW, beads.a >= SHALLOW, beads.a < 0.6
    over = (beads.run_out / lajeunesse(beads.a))[shallow].max() - 1.0
    inside = ((beads.run_out >= low) & (beads.run_out <= high))[shallow].all()
    below = (steep.run_out / low)[shallow].max()
    summit = np.abs(beads.height / beads.a - 1.0)[flat].max()
    rows = [
        Row("run-out for a <= 1, over 1.8 a", over, "-", "in 0.9 x 1.2 a to 1.3 x 1.8 a", bool(inside)),
        Row("height for a < 0.6, change of it", summit, "-", "<= 0.02", bool(summit <= 0.02)),
        Row("run-out with mu1 = 1.5 for a <= 1, over the band's lower edge", below, "-", "< 1", bool(below < 1.0)),
    ]
    if tall.sum() > 1:
        excess = float(beads.run_out[-1] / lajeunesse(beads.a)[-1] - 1.0)
        run_out, height = (float(np.polyfit(np.log(beads.a[tall]), np.log(y[tall]), 1)[0])
                           for y in (beads.run_out, beads.height))  # fmt: skip
        rows += [
            Row(f"run-out at a = {beads.a[-1]:g}, over 2.3 a^(2/3)", excess, "-", "reported", None),
            Row("exponent of the run-out over a for a >= 1; experiments 2/3", run_out, "-", "reported", None),
            Row("exponent of the height over a for a >= 1; experiments 1/3, 2/5", height, "-", "reported", None),
        ]
    return tuple(rows)


def draw(beads: Deposits, steep: Deposits) -> Figure:
    """Run-out and height over the aspect ratio."""
    a = np.geomspace(beads.a[0], beads.a[-1], 200)
    with rc_context(STYLE):
        figure = Figure(figsize=(WIDTH, 3.0), layout="constrained")
        run_out, height = figure.subplots(1, 2)
        letter([run_out, height])
        low, high = band(a)
        run_out.fill_between(a, low, high, color="0.88", linewidth=0, label=r"band asked for, $a \leq 1$")
        run_out.fill_between(a[a > SHALLOW], low[a > SHALLOW], high[a > SHALLOW], color="white", alpha=0.6, linewidth=0)
        run_out.plot(a, lube(a), "--", color="0.35", label="Lube et al. 2005")
        run_out.plot(a, lajeunesse(a), "-.", color="0.35", label="Lajeunesse et al. 2005")
        _computed(run_out, beads.a, beads.run_out, steep.run_out)
        run_out.set_ylabel(r"run-out $(\ell - \ell_0)/\ell_0$ (-)")
        run_out.legend(loc="lower right", fontsize=7)
        anchor = float(np.interp(SHALLOW, beads.a, beads.height))
        tall = a[a >= SHALLOW]
        for power, line, words in (
            (1 / 3, "-.", "$a^{1/3}$, Lajeunesse et al."),
            (2 / 5, "--", "$a^{2/5}$, Lube et al."),
        ):
            height.plot(tall, anchor * tall**power, line, color="0.35", label=words)
        _computed(height, beads.a, beads.height, steep.height)
        height.set_ylabel(r"final height $h/\ell_0$ (-)")
        height.legend(loc="upper left")
        for ax in (run_out, height):
            ax.set(xscale="log", yscale="log", xlabel=r"aspect ratio $a = h_0/\ell_0$ (-)")
            ax.set_xticks([0.2, 0.5, 1, 2, 5], ["0.2", "0.5", "1", "2", "5"])
            ax.minorticks_off()
            ax.axvline(SHALLOW, color="0.7", linewidth=0.6, zorder=0)
        run_out.set_yticks([0.1, 0.3, 1, 3, 10], ["0.1", "0.3", "1", "3", "10"])
        height.set_yticks([0.2, 0.5, 1, 2], ["0.2", "0.5", "1", "2"])
    figure.set_label(
        "Computed deposits of columns on a horizontal bed, and experiments in channels. The powers of the right panel "
        "begin at the computed height for a = 1."
    )
    return figure


def _computed(ax: Axes, a: Array, beads: Array, steep: Array) -> None:
    ax.plot(a, beads, "o-", color="#0072b2", markersize=3.5, label=r"computed, $\mu_1 = 0.48$")
    ax.plot(a, steep, "s-", color="#d55e00", markersize=3, markerfacecolor="none", label=r"computed, $\mu_1 = 1.5$")
