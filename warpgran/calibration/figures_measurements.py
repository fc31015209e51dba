"""Figures of what was measured: with the bands of the predictions, and the residuals."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from warpgran.analysis.units import LengthUnit, typical, unit_of
from warpgran.arrays import Array
from warpgran.calibration.experiments import KINDS, Observed
from warpgran.calibration.figures_parameters import FIT, POSTERIOR
from warpgran.figures.style import STYLE, THIN, TIME_LABEL, WIDTH

if TYPE_CHECKING:
    from warpgran.calibration.calibrate import Calibrated

MOST_TIMES = 4
"""Profiles of an experiment that are drawn, spread evenly over those measured."""
MOST_COLUMNS = 4
WET = 0.002
"""Thickness over the greatest that is drawn, at least."""
DATA: dict[str, Any] = {
    "linestyle": "none", "marker": "o", "markersize": 2.4, "markerfacecolor": "white", "markeredgewidth": 0.6,
    "color": "0.2", "elinewidth": 0.5, "zorder": 4,
}  # fmt: skip
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "0.2")
MARKS = "osD^v<>"
BAND = (0.05, 0.95)
MODEL = "model, 90 %"
MEASUREMENT = "model and its errors, 90 %"


def draw_profiles(found: Calibrated) -> Figure | None:
    """Thickness over position: a row an experiment, a column a time; None where no profile was measured."""
    rows = [(number, o, where) for number, o, where in found.stages.experiments.slices() if o.kind == "profiles"]
    if not rows:
        return None
    times = [_spread(np.unique(o.t)) for _, o, _ in rows]
    columns = max(map(len, times))
    thick = unit_of(typical(np.concatenate([o.value for _, o, _ in rows])))
    with rc_context(STYLE):
        figure = Figure(figsize=(WIDTH, 1.65 * len(rows) + 0.5), layout="constrained")
        axes = figure.subplots(len(rows), columns, squeeze=False, sharey="row", sharex="row")
        for line, at, (number, observed, where) in zip(axes, times, rows, strict=True):
            for ax in line[len(at) :]:
                ax.set_axis_off()
            for ax, t in zip(line, at, strict=False):
                here = observed.t == t
                if found.reached("predictive"):
                    _profile_band(ax, found, number, t, thick)
                _lay_over(ax, found, observed, where, np.flatnonzero(here), observed.x, thick.factor)
                ax.text(0.97, 0.94, f"$t$ = {t:.3g} s", transform=ax.transAxes, ha="right", va="top", fontsize=7)
                ax.set_xlabel("$x$ (m)")
            line[0].set_ylim(bottom=0.0)
            line[0].set_xlim(_reached(found, number, observed))
            line[0].set_ylabel(f"{found.stages.experiments.each[number].name}\n$h$ ({thick.name})")
        _legend(figure, axes[0, 0])
    return figure


def draw_series(found: Calibrated) -> Figure | None:
    """Front and volume over time: a row a kind, a column an experiment; None where neither was measured."""
    slices = list(found.stages.experiments.slices())
    kinds = [kind for kind in ("front", "volume") if any(o.kind == kind for _, o, _ in slices)]
    if not kinds:
        return None
    panels = {kind: [(number, o, where) for number, o, where in slices if o.kind == kind] for kind in kinds}
    columns = min(MOST_COLUMNS, max(map(len, panels.values())))
    lines = [(kind, panels[kind][i : i + columns]) for kind in kinds for i in range(0, len(panels[kind]), columns)]
    with rc_context(STYLE):
        figure = Figure(figsize=(WIDTH, 1.9 * len(lines) + 0.4), layout="constrained")
        axes = figure.subplots(len(lines), columns, squeeze=False, sharey="row")
        for line, (kind, row) in zip(axes, lines, strict=True):
            factor, name = 100.0, r"$\Delta V/V_0$ (%)"
            if kind == "front":
                along = unit_of(typical(np.concatenate([o.value for _, o, _ in panels["front"]])))
                factor, name = along.factor, rf"front $x_\mathrm{{f}}$ ({along.name})"
            for ax in line[len(row) :]:
                ax.set_axis_off()
            for ax, (number, observed, where) in zip(line, row, strict=False):
                _lay_over(ax, found, observed, where, np.arange(observed.t.size), observed.t, factor, model=True)
                ax.set_title(found.stages.experiments.each[number].name, fontsize=8, pad=3)
                ax.set_xlabel(TIME_LABEL)
                ax.tick_params(top=True, right=True)
            line[0].set_ylabel(name)
        _legend(figure, axes[0, 0])
    return figure


def draw_residuals(found: Calibrated) -> Figure:
    """Measured less best fit, in standard deviations of noise, grid and model error, against x and t."""
    stages = found.stages
    slices = list(stages.experiments.slices())
    kinds = [kind for kind in KINDS if any(o.kind == kind for _, o, _ in slices)]
    panels = [(kind, axis) for kind in kinds for axis in (("x", "t") if kind == "profiles" else ("t",))]
    deviation = stages.error_model.likeliest(stages.fit.prediction).deviation()
    with rc_context(STYLE):
        figure = Figure(figsize=(WIDTH, 2.3), layout="constrained")
        axes = figure.subplots(1, len(panels), squeeze=False, sharey=True)[0]
        for ax, (kind, axis) in zip(axes, panels, strict=True):
            for number, observed, where in slices:
                if observed.kind == kind:
                    left = (observed.value - stages.fit.prediction[where]) / deviation[where]
                    name = stages.experiments.each[number].name
                    ax.plot(
                        observed.x if axis == "x" else observed.t, left, MARKS[number % len(MARKS)], label=name,
                        color=COLOURS[number % len(COLOURS)], markersize=2.2, alpha=0.7, markeredgewidth=0,
                    )  # fmt: skip
            ax.axhline(0.0, **THIN)
            for level in (-2.0, 2.0):
                ax.axhline(level, **THIN, linestyle=":")
            ax.set_xlabel("$x$ (m)" if axis == "x" else TIME_LABEL)
            ax.set_title(kind, fontsize=8, pad=3)
            ax.tick_params(top=True, right=True)
        axes[0].set_ylabel("residual (standard deviations)")
        handles = {label: handle for ax in axes for handle, label in zip(*ax.get_legend_handles_labels(), strict=True)}
        figure.legend(handles.values(), handles.keys(), loc="outside lower center", ncols=6, markerscale=2)
    return figure


def _spread(times: Array) -> Array:
    """At most MOST_TIMES of them, the last one always among them."""
    return times[np.unique(np.linspace(0, times.size - 1, min(MOST_TIMES, times.size)).round().astype(int))]


def _profile_band(ax: Axes, found: Calibrated, number: int, t: float, thick: LengthUnit) -> None:
    """The band of the runs of the posterior over the whole grid."""
    stages = found.stages
    data = stages.predictive.data.isel(run=slice(number, None, len(stages.experiments.each)))
    h = data["h"].sel(time=t, method="nearest").values
    low, high = np.nanquantile(h, BAND, axis=0) * thick.factor
    ax.fill_between(data["x"].values, low, high, color=POSTERIOR, alpha=0.45, linewidth=0, label=MODEL, zorder=2)


def _reached(found: Calibrated, number: int, observed: Observed) -> tuple[float, float]:
    """From where to where an experiment was measured or is predicted to be wet, m."""
    x = observed.x
    if found.reached("predictive"):
        data = found.stages.predictive.data.isel(run=slice(number, None, len(found.stages.experiments.each)))
        h = data["h"].max(["run", "time"]).values
        x = np.concatenate([x, data["x"].values[h > WET * np.nanmax(h)]])
    margin = 0.03 * float(np.ptp(x))
    return float(x.min()) - margin, float(x.max()) + margin


def _lay_over(
    ax: Axes, found: Calibrated, observed: Observed, where: slice, here: Array, along: Array, factor: float,
    model: bool = False,
) -> None:  # fmt: skip
    """Measurements with what the best fit says of them and the band in which they would lie."""
    here = here[np.argsort(along[here], kind="stable")]
    place = along[here]
    stages = found.stages
    if found.reached("predictive"):
        predictive = stages.predictive
        low, high = factor * np.nanquantile(predictive.replicated[:, where][:, here], BAND, axis=0)
        ax.fill_between(place, low, high, color=POSTERIOR, alpha=0.15, linewidth=0, label=MEASUREMENT, zorder=1)
        if model:
            low, high = factor * np.nanquantile(predictive.predictions[:, where][:, here], BAND, axis=0)
            ax.fill_between(place, low, high, color=POSTERIOR, alpha=0.45, linewidth=0, label=MODEL, zorder=2)
    if found.reached("fit"):
        ax.plot(place, factor * stages.fit.prediction[where][here], color=FIT, label="best fit", zorder=3)
    sigma = None if observed.sigma is None else factor * observed.sigma[here]
    ax.errorbar(place, factor * observed.value[here], sigma, label="measured", **DATA)


def _legend(figure: Figure, ax: Axes) -> None:
    handles, labels = ax.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4)
