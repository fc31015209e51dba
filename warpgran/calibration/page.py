"""The page of a calibration: everything that a reader of its numbers asks for, in one HTML file."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from warpgran.calibration import figures_measurements, figures_parameters, words
from warpgran.calibration.experiments import KINDS, UNITS
from warpgran.calibration.result import PACKAGES
from warpgran.case.sections import KEYS
from warpgran.figures.page import Page
from warpgran.figures.style import save

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from warpgran.calibration.calibrate import Calibrated
    from warpgran.calibration.stages import Stages

CAPTIONS = {
    "corner": "The posterior, a dot a draw, with contours around half and nine tenths of it, and the best fit. A "
    "narrow, slanted cloud is a combination that the measurements determine while its parts make up for each other.",
    "priors": "What the measurements have added: the posterior over the range of each prior.",
    "profiles": "Thickness, measured and predicted. Dark band: runs of draws from the posterior, what the uncertainty "
    "of the parameters makes. Light band: the same with noise, error of the model and error of the grid, where nine "
    "tenths of the measurements should lie.",
    "series": "Front and volume over time, with the same bands.",
    "residuals": "Measured less predicted by the best fit, in standard deviations of all errors together. A row of one "
    "sign, or a trend, is an error of the model and not noise; where it stands says in which places or times.",
}
"""What each figure shows, by the name of its file."""


def write_figures(found: Calibrated, folder: Path) -> list[Path]:
    """Draw what was asked for as PNG files into a folder; their names are the keys of CAPTIONS.

    Raises:
        StorageError: A file cannot be written, or something else is there.
    """
    drawn: dict[str, Figure | None] = {}
    if found.reached("posterior"):
        drawn["corner"] = figures_parameters.draw_corner(found)
        drawn["priors"] = figures_parameters.draw_priors(found)
    if found.reached("fit"):
        drawn["profiles"] = figures_measurements.draw_profiles(found)
        drawn["series"] = figures_measurements.draw_series(found)
        drawn["residuals"] = figures_measurements.draw_residuals(found)
    paths = []
    for name, figure in drawn.items():
        if figure is not None:
            paths.append(folder / f"{name}.png")
            save(figure, paths[-1])
    return paths


def write_page(found: Calibrated, pictures: Sequence[Path], path: Path) -> None:
    """Write the page.

    Args:
        found: What was computed.
        pictures: Files that `write_figures` has written.
        path: Where it goes, .html.

    Raises:
        StorageError: The file cannot be written.
    """
    stages = found.stages
    by_name = {picture.stem: picture for picture in pictures}
    title = stages.study.base.title
    page = Page(f"Calibration: {title}" if title else "Calibration")
    _summary(page, found)
    _measurements(page, stages)
    _priors(page, stages)
    if found.reached("fit"):
        _errors(page, found)
        _fit(page, stages)
    if found.reached("posterior"):
        _posterior(page, found)
    for heading, names in (
        ("Parameters", ("corner", "priors")),
        ("Predictions and measurements", ("profiles", "series")),
        ("Residuals", ("residuals",)),
    ):
        shown = [name for name in names if name in by_name]
        if shown:
            page.heading(heading, heading.lower().replace(" ", "-"))
        for name in shown:
            page.picture(by_name[name], CAPTIONS[name])
    _computation(page, found)
    page.write(path)


def _summary(page: Page, found: Calibrated) -> None:
    page.heading("Result", "result")
    stages = found.stages
    names = ", ".join(stages.names)
    experiments = stages.experiments
    page.paragraph(
        f"{len(stages.names)} parameters ({names}) fitted to {experiments.size} measurements of "
        f"{len(experiments.each)} experiments ({', '.join(e.name for e in experiments.each)})."
    )
    if found.reached("posterior"):
        page.paragraph(
            "The populations of the sampler agree; the posterior has converged."
            if found.converged
            else "The posterior has not converged: do not use its numbers. What to do is said below."
        )
    frame = found.table()
    titles = {
        "prior_5": "prior 5 %", "prior_95": "prior 95 %", "fit": "best fit", "fit_sd": "± (best fit)", "mean": "mean",
        "sd": "sd", "q5": "5 %", "q50": "50 %", "q95": "95 %", "r_hat": "R-hat", "effective": "effective draws",
    }  # fmt: skip
    rows = [
        [str(name), KEYS[str(name)].unit or "-", *(_number(value, str(column)) for column, value in row.items())]
        for name, row in frame.iterrows()
    ]
    page.table(["parameter", "unit", *(titles[str(column)] for column in frame)], rows)
    page.heading("What the numbers must not be read without", "remarks")
    for line in found.told():
        page.paragraph(f"{line[0].upper()}{line[1:]}.")


def _number(value: float, column: str) -> str:
    return f"{value:.0f}" if column == "effective" else f"{value:.3f}" if column == "r_hat" else f"{value:.4g}"


def _measurements(page: Page, stages: Stages) -> None:
    page.heading("Measurements", "measurements")
    rows = []
    for number, observed in stages.experiments.observed():
        experiment = stages.experiments.each[number]
        differs = ", ".join(f"{key} = {value}" for key, value in experiment.changes.items())
        times = np.unique(observed.t)
        at = f"{times[0]:.4g} to {times[-1]:.4g} s" if times.size > 1 else f"{times[0]:.4g} s"
        x = f"{observed.x.min():.4g} to {observed.x.max():.4g} m" if observed.kind == "profiles" else "-"
        sigma = "inferred" if observed.sigma is None else f"{np.median(observed.sigma):.3g} (median)"
        rows.append([experiment.name, differs, observed.kind, observed.value.size, f"{times.size}: {at}", x, sigma])
    page.table(["experiment", "keys of its own", "kind", "measurements", "times", "x", "sigma"], rows)


def _priors(page: Page, stages: Stages) -> None:
    page.heading("Model and priors", "priors")
    page.paragraph(
        "The depth-averaged compressible mu(I) model of Bouchut et al., run for each experiment with the keys of the "
        "run file, at the end of this page, and its own. All share the parameters, whose priors are independent:"
    )
    rows = [[name, KEYS[name].name, str(prior), KEYS[name].unit or "-"] for name, prior in stages.study.priors.items()]
    page.table(["parameter", "meaning", "prior", "unit"], rows)
    page.paragraph(
        f"{len(stages.screening.theta)} Sobol points of the prior were run first; {stages.screening.failed} of them "
        "have no likelihood, because a run failed or the case cannot be made. They count as impossible."
    )


def _errors(page: Page, found: Calibrated) -> None:
    page.heading("Errors", "errors")
    page.paragraph(
        "Measured less predicted is Gaussian, for each kind of measurements by itself: independent noise, the error of "
        "the grid, and an error of the model, correlated over a length in x and t (Kennedy & O'Hagan 2001). The size "
        "of the error of the model, the length, and the noise where no sigma was measured, are inferred with the "
        "parameters and averaged over; the table has them with their 90 % intervals. Correlated measurements repeat "
        "each other: the effective number is that of independent ones that would say as much. The error of the grid "
        "is the root of its mean square, from a grid of twice the cells at the best fit."
    )
    stages = found.stages
    posterior = found.reached("posterior")
    model = stages.error_model
    effective = model.likeliest(stages.fit.prediction).effective()
    rows = []
    for kind in KINDS:
        if kind not in model.kinds:
            continue
        grid = float(np.sqrt(np.mean(stages.grid_error[model.places(kind)] ** 2)))
        row = [kind, UNITS[kind], model.kinds[kind].data, f"{effective[kind]:.0f}", f"{grid:.2g}"]
        if posterior:
            for size in ("noise", "model_error", "correlation"):
                values = stages.posterior.errors.get(f"{kind} {size}")
                row.append("measured" if values is None else "{:.2g} ({:.2g} to {:.2g})".format(
                    *np.quantile(values, (0.5, 0.05, 0.95))))  # fmt: skip
        rows.append(row)
    columns = ["kind", "unit", "measurements", "effective number", "error of the grid"]
    page.table([*columns, *(("noise", "error of the model", "correlation length / range") if posterior else ())], rows)


def _fit(page: Page, stages: Stages) -> None:
    page.heading("Best fit", "best-fit")
    fit = stages.fit
    page.paragraph(
        f"Least squares from {len(fit.ends)} starts, of the likelihood alone within the bounds of the priors; log "
        f"likelihood {fit.log_likelihood:.2f}. Covariance from the Fisher information and the prior, before the error "
        "of the grid is added; below the diagonal correlations, on and above it covariances."
    )
    sd = np.sqrt(np.diag(fit.covariance))
    correlation = fit.covariance / np.outer(sd, sd)
    d = len(fit.names)
    rows = [
        [name, *(f"{correlation[i, j]:+.2f}" if j < i else f"{fit.covariance[i, j]:.3g}" for j in range(d))]
        for i, name in enumerate(fit.names)
    ]
    page.table(["", *fit.names], rows)
    page.paragraph(
        "Combinations of parameters, from the one that the measurements determine best to the one they determine "
        "least: how much of the width of the prior is left along it, and its parts in standard deviations of the "
        "priors. Where most of the width is left, the parameters make up for each other: moving them together by these "
        "parts hardly changes what was measured."
    )
    combinations = fit.combinations()
    rows = [[f"{left:.0%}", *(f"{part:+.2f}" for part in vector)] for left, vector in combinations]
    page.table(["left of the prior's width", *fit.names], rows)


def _posterior(page: Page, found: Calibrated) -> None:
    page.heading("Sampling", "sampling")
    section, sampled = found.stages.study.section, found.stages.posterior
    chains, draws = sampled.samples.log_likelihood.shape
    evidence = sampled.samples.log_evidence
    page.paragraph(
        f"Tempered sequential Monte Carlo: {chains} populations of {section.particles} particles, {draws} draws each. "
        f"R-hat (rank-normalized, split, between populations; Vehtari et al. 2021) should be at most "
        f"{words.MOST_R_HAT:g}, effective draws at least {words.LEAST_SIZE:g}. Log evidence "
        f"{evidence.mean():.2f} ± {evidence.std(ddof=1) / np.sqrt(chains):.2f}."
    )
    rows = [
        [f"{step.temperature:.3g}", step.moves, f"{step.acceptance:.0%}", step.failed, step.evaluations]
        for step in sampled.samples.steps
    ]
    page.table(["temperature", "moves", "accepted", "failed", "points so far"], rows)


def _computation(page: Page, found: Calibrated) -> None:
    page.heading("How it was computed", "computation")
    study, options = found.stages.study, found.stages.forward.options
    page.paragraph(
        f"Seed {study.section.seed}; the same seed, input and versions give the same numbers. Engine {options.engine}, "
        f"device {options.device}, precision {options.precision}. Versions: "
        f"{', '.join(f'{package} {version(package)}' for package in PACKAGES)}."
    )
    page.paragraph(
        "To cite: this software by its CITATION.cff, with the version above; the model by F. Bouchut, E. D. "
        "Fernández-Nieto, E. H. Koné, A. Mangeney and G. Narbona-Reina, Dilatancy in dry granular flows with a "
        "compressible mu(I) rheology; the sampler by H.-D. Dau and N. Chopin, Waste-free sequential Monte Carlo, "
        "J. R. Stat. Soc. B 84 (2022)."
    )
    page.preformatted(study.base.to_toml())
