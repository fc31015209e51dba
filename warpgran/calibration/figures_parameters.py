"""Figures of the parameters: the posterior in pairs, and next to the prior."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from warpgran.arrays import Array
from warpgran.figures.names import Parameter, named
from warpgran.figures.style import STYLE, WIDTH, letter

if TYPE_CHECKING:
    from warpgran.calibration.calibrate import Calibrated
    from warpgran.case.distributions import Distribution

POSTERIOR, PRIOR, FIT = "#0072b2", "0.55", "#d55e00"
MASSES = (0.9, 0.5)
"""Shares of the posterior that the contours of a pair enclose."""
BINS = 24
DOTS = 2000
"""Most draws of a pair that are drawn as dots."""


def draw_corner(found: Calibrated) -> Figure:
    """Every pair of parameters: draws, contours around half and nine tenths of them, and the best fit."""
    draws, names = _draws(found)
    d = len(names)
    fit = found.stages.fit.theta * [name.factor for name in names]
    size = min(WIDTH, 1.1 + 1.5 * d)
    with rc_context(STYLE):
        figure = Figure(figsize=(size, size), layout="constrained")
        axes = figure.subplots(d, d, squeeze=False)
        for i in range(d):
            low, high = np.quantile(draws[:, i], (0.001, 0.999))
            limits = low - 0.05 * (high - low), high + 0.05 * (high - low)
            for j in range(d):
                ax = axes[i, j]
                if j > i:
                    ax.set_axis_off()
                    continue
                if j == i:
                    ax.hist(draws[:, i], BINS, range=limits, color=POSTERIOR, alpha=0.5)
                    ax.axvline(fit[i], color=FIT)
                    ax.set_yticks([])
                else:
                    _pair(ax, draws[:, j], draws[:, i])
                    ax.plot(fit[j], fit[i], "+", color=FIT, markersize=8, markeredgewidth=1.3)
                    ax.set_xlim(axes[j, j].get_xlim())
                    ax.set_ylim(limits)
                if j == i:
                    ax.set_xlim(limits)
                ax.tick_params(top=True, right=j < i, axis="both", labelbottom=i == d - 1, labelleft=j == 0 and i > 0)
                ax.tick_params(axis="x", labelrotation=45)
                ax.locator_params(nbins=4, axis="x")
                if i == d - 1:
                    ax.set_xlabel(_short(names[j]))
                if j == 0 and i > 0:
                    ax.set_ylabel(_short(names[i]))
                    ax.locator_params(nbins=4, axis="y")
        if d > 1:
            axes[0, d - 1].text(1, 1, "best fit", color=FIT, ha="right", va="top", transform=axes[0, d - 1].transAxes)
    return figure


def draw_priors(found: Calibrated) -> Figure:
    """Each parameter over the range of its prior: density before and after the measurements."""
    draws, names = _draws(found)
    columns = min(len(names), 3)
    rows = -(-len(names) // columns)
    with rc_context(STYLE):
        figure = Figure(figsize=(WIDTH, 1.9 * rows + 0.2), layout="constrained")
        axes = figure.subplots(rows, columns, squeeze=False).ravel()
        for ax in axes[len(names) :]:
            ax.set_axis_off()
        for k, (name, prior) in enumerate(zip(names, found.stages.study.priors.values(), strict=True)):
            ax = axes[k]
            low, high = (float(prior.ppf(np.array(u))) for u in (0.001, 0.999))
            scale = np.log if prior.logarithmic else np.asarray
            x = np.geomspace(low, high, 401) if prior.logarithmic else np.linspace(low, high, 401)
            ax.fill_between(name.factor * x, _density(prior, x), color=PRIOR, alpha=0.3, linewidth=0, label="prior")
            edges = x[::10]
            heights, _ = np.histogram(scale(draws[:, k] / name.factor), scale(edges), density=True)
            ax.stairs(heights, name.factor * edges, color=POSTERIOR, fill=True, alpha=0.6, label="posterior")
            ax.axvline(name.factor * found.stages.fit.theta[k], color=FIT, label="best fit")
            if prior.logarithmic:
                ax.set_xscale("log")
                ax.xaxis.set_minor_formatter(NullFormatter())  # of less than a decade it would label every tick
            ax.set_xlabel(name.label)
            ax.set_yticks([])
            ax.set_ylim(bottom=0)
            ax.set_xlim(name.factor * low, name.factor * high)
        axes[0].set_ylabel("density")
        letter(axes[: len(names)].tolist())
        figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def _draws(found: Calibrated) -> tuple[Array, list[Parameter]]:
    """All draws (draws, parameters) in the units of the figures, and what the parameters are called."""
    theta = found.stages.posterior.samples.theta
    draws = theta.reshape(-1, theta.shape[2])
    names = [named(key, draws[:, k]) for k, key in enumerate(found.stages.names)]
    return draws * [name.factor for name in names], names


def _short(name: Parameter) -> str:
    """Symbol and unit; the words of what has no symbol."""
    return f"{name.symbol} ({name.unit.strip() or '-'})" if name.symbol else name.words


def _density(prior: Distribution, x: Array) -> Array:
    """Of the prior; over the logarithm for a logarithmic one, where it is uniform."""
    return np.exp(prior.logpdf(x)) * (x if prior.logarithmic else 1.0)


def _pair(ax: Axes, x: Array, y: Array) -> None:
    """Dots, and contours of a kernel estimate around shares of the draws."""
    from scipy.stats import gaussian_kde

    some = slice(None, None, max(1, len(x) // DOTS))
    ax.plot(x[some], y[some], ".", color=POSTERIOR, markersize=1.6, alpha=0.35, markeredgewidth=0, rasterized=True)
    points = np.unique(np.stack([x, y]), axis=1)
    if points.shape[1] < 20 or np.linalg.matrix_rank(np.cov(points)) < 2:
        return
    kernel = gaussian_kde(np.stack([x, y]))
    levels = np.quantile(kernel(np.stack([x, y])), [1.0 - mass for mass in MASSES])
    grids = np.meshgrid(*(np.linspace(v.min() - 0.1 * np.ptp(v), v.max() + 0.1 * np.ptp(v), 70) for v in (x, y)))
    if levels[0] < levels[1]:
        heights = kernel(np.stack([grid.ravel() for grid in grids])).reshape(grids[0].shape)
        ax.contour(*grids, heights, levels, colors=POSTERIOR, linewidths=(0.7, 1.1))
