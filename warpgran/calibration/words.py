"""What a calibration has found, as a table, and what must be said beside it, in words."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import pandas as pd

from warpgran.arrays import Array
from warpgran.calibration.experiments import UNITS
from warpgran.calibration.forward import Tally
from warpgran.calibration.screening import shares_at
from warpgran.calibration.stages import Stages
from warpgran.case.study import Study
from warpgran.case.unlikely import unlikely

EDGE = 0.05
"""Width, as a share of the prior, of the edges on which a posterior may lean."""
LEANS = 2.0
"""A posterior leans on an edge if it has this many times the share there that the prior has."""
LIKE_PRIOR = 0.8
"""A parameter is left open by the data if its standard deviation is more than this share of the prior's."""
LEAST_PART = 0.2
"""Least part of a parameter in a combination for it to be named, in standard deviations of the prior."""
MOST_R_HAT, LEAST_SIZE = 1.05, 100.0
"""Of a posterior that has converged."""
NAMED = 3
"""Most measurements that are named one by one."""


def table(stages: Stages, reached: Callable[[str], bool]) -> pd.DataFrame:
    """A row a parameter, see `Calibrated.table`."""
    priors = stages.study.priors
    columns: dict[str, list[float]] = {
        "prior_5": [float(prior.ppf(np.array(0.05))) for prior in priors.values()],
        "prior_95": [float(prior.ppf(np.array(0.95))) for prior in priors.values()],
    }
    if reached("fit"):
        columns |= {"fit": stages.fit.theta.tolist(), "fit_sd": np.sqrt(np.diag(stages.fit.covariance)).tolist()}
    if reached("posterior"):
        found = stages.posterior
        draws = found.samples.theta.reshape(-1, len(priors))
        columns |= {"mean": draws.mean(axis=0).tolist(), "sd": draws.std(axis=0, ddof=1).tolist()}
        quantiles = np.quantile(draws, (0.05, 0.5, 0.95), axis=0)
        columns |= {name: row.tolist() for name, row in zip(("q5", "q50", "q95"), quantiles, strict=True)}
        columns |= {"r_hat": [found.r_hat[name] for name in stages.names]}
        columns |= {"effective": [found.size[name] for name in stages.names]}
    return pd.DataFrame(columns, index=pd.Index(stages.names, name="parameter"))


def of_screening(stages: Stages) -> Iterator[str]:
    """What is unlikely of the case, failed runs, and measurements beyond the reach of the model."""
    found = stages.screening
    yield from unlikely(Study(stages.experiments.base, {}))
    if found.failed:
        share = f"{found.failed} of {len(found.theta)} points of the prior"
        yield f"{share} have no likelihood: their runs failed, or cannot be made; they count as impossible"
    experiments = stages.experiments
    deviation = np.concatenate(
        [
            np.full(o.value.size, 0.05 * np.ptp(o.value)) if o.sigma is None else o.sigma
            for _, o in experiments.observed()
        ]
    )
    beyond = found.beyond_reach(experiments, deviation) if found.failed < len(found.theta) else np.zeros(0, dtype=bool)
    for number, observed, where in experiments.slices():
        at = np.flatnonzero(beyond[where])
        if at.size:
            which = ", ".join(_place(observed.t[i], observed.x[i]) for i in at[:NAMED])
            more = f" and {at.size - NAMED} more" if at.size > NAMED else ""
            name = f"{observed.kind} at {experiments.each[number].name}"
            noise = "three sigma" if observed.sigma is not None else "15 % of their range"
            yield (
                f"{name}: {at.size} of {observed.value.size} measurements lie further than {noise} from all that the "
                f"model gives anywhere in the prior: {which}{more}"
            )


def _place(t: float, x: float) -> str:
    return f"t = {t:.4g} s" if np.isnan(x) else f"t = {t:.4g} s, x = {x:.4g} m"


def of_fit(stages: Stages) -> Iterator[str]:
    """Combinations that the data determine best, least, and not at all, and the error of the grid."""
    fit = stages.fit
    combinations = fit.combinations()
    for k, (ratio, vector) in enumerate(combinations):
        is_open = ratio > LIKE_PRIOR
        if is_open or k in (0, len(combinations) - 1):
            how = "not determined by the data" if is_open else "least determined" if k else "best determined"
            moves = _combination(fit.names, vector * fit.units, vector)
            yield f"{how}: {moves} ({ratio:.0%} of the width of the prior is left)"
    ends = np.sort(fit.ends[:, -1])
    if len(ends) > 1 and ends[-1] - ends[-2] > 2.0:
        yield f"of {len(ends)} starts one has led to the best fit: there are several valleys, or too few starts"
    for kind, errors in stages.error_model.kinds.items():
        grid = stages.grid_error[stages.error_model.places(kind)]
        size = float(np.sqrt(np.mean(grid**2)))
        share = f"{size / errors.scale:.1%} of what was measured"
        yield f"{kind}: the error of the grid is {size:.2g}{_unit(kind)}, {share}, and is added to the noise"


def _combination(names: tuple[str, ...], steps: Array, parts: Array) -> str:
    """`rheology.K up by 1.2 with rheology.mu1 down by 0.03`, for one standard deviation of the prior."""
    order = np.argsort(-abs(parts))
    sign = np.sign(parts[order[0]])
    named = [i for i in order if abs(parts[i]) >= LEAST_PART]
    moves = [f"{names[i]} {'up' if sign * steps[i] > 0 else 'down'} by {abs(steps[i]):.2g}" for i in named]
    return " with ".join([moves[0], " and ".join(moves[1:])]) if len(moves) > 1 else moves[0]


def _unit(kind: str) -> str:
    return f" {UNITS[kind]}" if UNITS[kind] != "1" else ""


def of_posterior(stages: Stages) -> Iterator[str]:
    """Edges of the prior, parameters left open, trade-offs, and the sizes of errors."""
    found, names = stages.posterior, stages.names
    draws = found.samples.theta.reshape(-1, len(names))
    shares = shares_at(stages.study.priors, draws)
    for name, share in zip(names, shares.T, strict=True):
        for side, at in (("low", share < EDGE), ("high", share > 1.0 - EDGE)):
            if at.mean() > LEANS * EDGE:
                yield (
                    f"{name}: leans on the {side} edge of its prior ({at.mean():.0%} of the posterior lies in the last "
                    f"{EDGE:.0%} of it); the data may want values beyond"
                )
        if share.std() > LIKE_PRIOR / np.sqrt(12.0):
            yield f"{name}: the posterior is as wide as the prior; the data do not determine it by itself"
    for kind, errors in stages.error_model.kinds.items():
        size = found.errors[f"{kind} model_error"].ravel()
        low, middle, high = np.quantile(size, (0.05, 0.5, 0.95)) / errors.scale
        node, _ = stages.fit.errors.nodes[kind]
        data = f"{errors.data} measurements are worth {errors.effective(node):.0f} independent ones at the best fit"
        noise = ""
        if not errors.known:
            noise = f"noise of {np.median(found.errors[f'{kind} noise']):.2g}{_unit(kind)} inferred; "
        yield f"{kind}: {noise}error of the model {middle:.1%} ({low:.1%} to {high:.1%}) of what was measured; {data}"


def not_converged(stages: Stages) -> list[str]:
    """What a posterior that has not converged needs, a line a parameter; nothing of one that has."""
    found = stages.posterior
    section = stages.study.section
    lines = []
    for name in stages.names:
        r_hat, size = found.r_hat[name], found.size[name]
        if r_hat > MOST_R_HAT or size < LEAST_SIZE:
            lines.append(
                f"{name}: not converged: R-hat {r_hat:.3f} (allowed: <= {MOST_R_HAT}), {size:.0f} effective draws "
                f"(allowed: >= {LEAST_SIZE:.0f}); set calibration.particles = {2 * section.particles}, "
                f"or narrow the priors"
            )
    return lines


def of_runs(tally: Tally, seconds: float) -> str:
    """What was computed, and how long it took."""
    failed = f", {sum(tally.ended.values())} of which failed" if tally.ended else ""
    refused = f"; {tally.refused} cannot be made" if tally.refused else ""
    share = f", {tally.engine_seconds / seconds:.0%} of it in the engine" if tally.runs else ""
    return f"{tally.runs} runs{failed}{refused} in {seconds:.0f} s{share}"
