"""Tempered sequential Monte Carlo: draws from a posterior whose likelihood is a run of the model.

Why our own: the engine is quick on batches of hundreds of runs. This sampler asks for some thirty batches of
chains x particles points, where an ensemble sampler such as emcee wants a hundred thousand points in thousands of small
batches, one after the other; the packaged samplers of this kind come with a language of models around them.

How: populations drawn from the prior pass through the densities prior x likelihood^temperature, the temperature rising
from 0 to 1. Each step goes to the highest temperature at which the weights of every population keep the wanted share
of effective draws (Del Moral, Doucet & Jasra 2012). Ancestors are drawn by these weights (systematic resampling) and
moved by Metropolis-Hastings; all that they pass through is the next population (waste-free SMC, Dau & Chopin 2022).
They move until they have forgotten where they began: a move with a relative squared jump r, 1 if independent, leaves
a correlation of 1 - r.

Moves are of two kinds, mixed in proportion to how far they carry: independent proposals from a mixture fitted to the
other populations (a proposal that a particle has helped to fit draws it inward: measured, variances 5 % too small at
32 particles, and a third of the effective draws), and a random walk with their covariance.

All of it happens in coordinates z that are standard normal under the prior, theta = ppf(Phi(z)): the edge of a uniform
prior lies at infinity, and no move runs into it.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from scipy.linalg import LinAlgError
from scipy.optimize import brentq
from scipy.special import logsumexp, ndtr, ndtri

from warpgran.arrays import Array
from warpgran.calibration.archive import read_arrays, write_arrays
from warpgran.calibration.proposals import Mixture
from warpgran.case.distributions import Distribution
from warpgran.errors import OptionError, ResultError
from warpgran.files import StorageError

FORGOTTEN = 0.2
"""Correlation that the moves of a temperature may leave."""
MOVES = (2, 10)
"""Least and most moves of a temperature."""
SHARES = (0.1, 0.9)
"""Least and greatest share of independent proposals."""
WALK_ACCEPTANCE = 0.3
"""Acceptance to which the step of the random walk is adapted; any between 0.23 and 0.44 is nearly the best."""

_WITHIN = (np.finfo(float).tiny, 1.0 - np.finfo(float).epsneg)
"""Least and greatest share of a prior: at 0 and 1 a normal one is infinite."""


@dataclass(frozen=True)
class Step:
    """One temperature: how it went, over all populations.

    Attributes:
        temperature: power of the likelihood.
        moves: of each ancestor.
        acceptance: share of the proposals accepted.
        failed: number of proposals without a likelihood.
        evaluations: points asked for so far.
    """

    temperature: float
    moves: int
    acceptance: float
    failed: int
    evaluations: int


@dataclass(frozen=True)
class Posterior:
    """What the sampler has found.

    Attributes:
        theta: draws from the posterior, (chains, draws, d), equally weighted. The draws of one ancestor follow each
            other, and ancestors of one origin stand side by side, so that the effective sample size by autocorrelation
            sees what they share.
        log_likelihood: of each draw, (chains, draws).
        start: draws from the prior that the populations began with, (chains, n, d).
        start_log_likelihood: of each, (chains, n); -inf where it failed.
        log_evidence: log of the marginal likelihood, an estimate of each population, (chains,).
        steps: the temperatures passed through.
    """

    theta: Array
    log_likelihood: Array
    start: Array
    start_log_likelihood: Array
    log_evidence: Array
    steps: tuple[Step, ...]


@dataclass
class _State:
    """All that the next temperature depends on; what a checkpoint holds."""

    z: Array  # (chains, n, d)
    log_likelihood: Array  # (chains, n)
    start_z: Array
    start_log_likelihood: Array
    log_evidence: Array  # (chains,)
    rng: np.random.Generator
    temperature: float = 0.0
    walk: float = 1.0  # step of the random walk, in standard deviations
    share: float = 0.5  # of independent proposals
    steps: list[Step] = field(default_factory=list)


_ARRAYS = ("z", "log_likelihood", "start_z", "start_log_likelihood", "log_evidence")
"""Of a state."""


def sample(
    log_likelihood: Callable[[Array], Array],
    priors: Sequence[Distribution],
    *,
    particles: int = 32,
    chains: int = 4,
    draws: int = 250,
    seed: int = 0,
    ess_fraction: float = 0.5,
    start: Array | None = None,
    checkpoint: Path | None = None,
    identity: str = "",
    progress: Callable[[Step], None] | None = None,
) -> Posterior:
    """Draw from the posterior of independent priors and a likelihood.

    Args:
        log_likelihood: of points (n, d), as (n,); -inf where a run failed. n is chains x particles but for the start.
        priors: of the d parameters.
        particles: ancestors of each population.
        chains: populations, at least two.
        draws: of each population from the posterior, at least.
        seed: of all that is random.
        ess_fraction: share of effective draws that a step of the temperature keeps.
        start: shares (n, d) of the priors below the points to begin with, uniform in (0, 1), such as Sobol points; n a
            multiple of `chains`. By default 4 chains x particles are drawn.
        checkpoint: file to go on from if it is there, written at every temperature; the outcome has the same bits.
        identity: what the likelihood depends on, in words: a checkpoint of another one is refused.
        progress: called after every temperature.

    Raises:
        OptionError: An option is out of range, or the checkpoint is that of another sampling.
        ResultError: Too few points of the prior have a likelihood to begin with.
        ValueError: The likelihood returned NaN, +inf or another number of values: not a matter of the data.
    """
    for name, value, low, high in (
        ("particles", particles, 4, np.inf),
        ("chains", chains, 2, np.inf),
        ("draws", draws, 4, np.inf),
        ("ess_fraction", ess_fraction, 0.1, 0.95),
    ):
        if not low <= value <= high:
            allowed = f">= {low:g}" if high == np.inf else f"{low:g} to {high:g}"
            raise OptionError(f"{name}: {value} is out of range; allowed: {allowed}")
    settings = {
        "parameters": len(priors), "particles": particles, "chains": chains, "draws": draws, "seed": seed,
        "ess_fraction": ess_fraction, "identity": identity,
        "start": None if start is None else len(start),
    }  # fmt: skip

    def evaluate(z: Array) -> Array:
        """Log likelihood of points (chains, n, d), as (chains, n)."""
        values = np.asarray(log_likelihood(_theta(z.reshape(-1, z.shape[2]), priors)), dtype=float)
        if values.shape != (z.shape[0] * z.shape[1],) or np.isnan(values).any() or np.isposinf(values).any():
            raise ValueError("log_likelihood must return one value a point, finite or -inf")
        return values.reshape(z.shape[:2])

    if checkpoint is not None and checkpoint.exists():
        state = _load(checkpoint, settings)
    else:
        state = _begin(evaluate, len(priors), particles, chains, seed, start)
        if checkpoint is not None:
            _save(state, checkpoint, settings)
    while state.temperature < 1.0:
        _advance(state, evaluate, particles, draws, ess_fraction)
        if checkpoint is not None:
            _save(state, checkpoint, settings)
        if progress is not None:
            progress(state.steps[-1])
    return Posterior(
        _theta(state.z, priors), state.log_likelihood, _theta(state.start_z, priors), state.start_log_likelihood,
        state.log_evidence, tuple(state.steps),
    )  # fmt: skip


def _theta(z: Array, priors: Sequence[Distribution]) -> Array:
    """Parameters from coordinates that are standard normal under the prior; both (..., d)."""
    u = np.clip(ndtr(z), *_WITHIN)
    return np.stack([prior.ppf(u[..., k]) for k, prior in enumerate(priors)], axis=-1)


def _begin(
    evaluate: Callable[[Array], Array], d: int, particles: int, chains: int, seed: int, start: Array | None
) -> _State:
    """Populations from the prior."""
    rng = np.random.default_rng(seed)
    if start is None:
        z = rng.standard_normal((chains, 4 * particles, d))
    elif start.ndim != 2 or start.shape[1] != d or len(start) % chains or not ((start >= 0) & (start <= 1)).all():
        raise OptionError(
            f"start: shape {start.shape}; allowed: (n, {d}) shares between 0 and 1, n a multiple of {chains}"
        )
    else:  # blocks in turn: every chains-th point of a Sobol sequence lies in one slice of the first parameter
        z = ndtri(np.clip(start, *_WITHIN)).reshape(chains, -1, d)
    values = evaluate(z)
    found = np.isfinite(values)
    if found.sum(axis=1).min() <= d:
        raise ResultError(
            f"cannot sample the posterior: {found.size - found.sum()} of {found.size} points of the prior have no "
            f"likelihood, their runs failed; allowed: more than {d} of each {found.shape[1]} with one (narrower priors)"
        )
    step = Step(0.0, 0, 1.0, int(found.size - found.sum()), found.size)
    return _State(z, values, z, values, np.zeros(chains), rng, walk=2.38 / d**0.5, steps=[step])


def _advance(
    state: _State, evaluate: Callable[[Array], Array], particles: int, draws: int, ess_fraction: float
) -> None:
    """Go to the next temperature: weigh, draw ancestors, move."""
    chains, _, d = state.z.shape
    rise = min(_rise(values, 1.0 - state.temperature, ess_fraction) for values in state.log_likelihood)
    state.temperature = 1.0 if state.temperature + rise > 1.0 - 1e-9 else state.temperature + rise
    logs = rise * state.log_likelihood
    totals = logsumexp(logs, axis=1)
    state.log_evidence = state.log_evidence + totals - np.log(logs.shape[1])
    weights = np.exp(logs - totals[:, None])
    try:
        others = [np.arange(chains) != c for c in range(chains)]
        mixtures = [Mixture(state.z[these].reshape(-1, d), weights[these].ravel()) for these in others]
    except LinAlgError:
        raise ResultError(
            f"cannot sample the posterior: at temperature {state.temperature:.3g} the particles are too few for "
            f"{d} parameters; allowed: more particles"
        ) from None
    ancestors = np.stack([_systematic(row, particles, state.rng) for row in weights])
    state.z = np.take_along_axis(state.z, ancestors[..., None], axis=1)
    state.log_likelihood = np.take_along_axis(state.log_likelihood, ancestors, axis=1)
    _move(state, evaluate, mixtures, MOVES[0] if state.temperature < 1.0 else max(MOVES[0], -(-draws // particles)))


def _move(state: _State, evaluate: Callable[[Array], Array], mixtures: Sequence[Mixture], least: int) -> None:
    """Move ancestors, `least` times or more; all that they pass through is the population then."""
    z, values = state.z, state.log_likelihood
    chains, particles, d = z.shape
    passed: list[tuple[Array, Array]] = []
    jumps: list[list[float]] = []
    accepted, failed, left = 0.0, 0, 1.0
    while len(passed) < least or (left > FORGOTTEN and len(passed) < MOVES[1]):
        independent = state.rng.random(values.shape) < state.share
        proposed, correction, squared = np.empty_like(z), np.zeros_like(values), np.empty_like(values)
        for c, mixture in enumerate(mixtures):
            walked = z[c] + state.walk * state.rng.standard_normal((particles, d)) @ mixture.factor.T
            proposed[c] = np.where(independent[c, :, None], mixture.draw(particles, state.rng), walked)
            ratio = mixture.log_density(z[c]) - mixture.log_density(proposed[c])
            correction[c] = np.where(independent[c], ratio, 0.0)
            squared[c] = ((mixture.whiten(proposed[c]) - mixture.whiten(z[c])) ** 2).mean(axis=1) / 2.0
        new = evaluate(proposed)
        prior_ratio = 0.5 * (z**2 - proposed**2).sum(axis=2)
        chance = np.exp(np.minimum(state.temperature * (new - values) + prior_ratio + correction, 0.0))
        taken = state.rng.random(values.shape) < chance
        z, values = np.where(taken[..., None], proposed, z), np.where(taken, new, values)
        passed.append((z, values))

        jump = chance * np.minimum(squared, 2.0)  # a rare long jump is no measure of the many
        jumps.append([float(jump[kind].mean()) if kind.any() else 0.0 for kind in (independent, ~independent)])
        if not independent.all():
            state.walk *= float(np.exp(chance[~independent].mean() - WALK_ACCEPTANCE))
        left *= max(1.0 - float(jump.mean(axis=1).min()), 0.0)
        accepted += float(taken.mean())
        failed += int(np.isneginf(new).sum())

    far = np.mean(jumps, axis=0)
    state.share = float(np.clip(far[0] / max(far.sum(), 1e-12), *SHARES))
    state.z = np.stack([z for z, _ in passed], axis=2).reshape(chains, -1, d)
    state.log_likelihood = np.stack([values for _, values in passed], axis=2).reshape(chains, -1)
    evaluations = state.steps[-1].evaluations + len(passed) * values.size
    state.steps.append(Step(state.temperature, len(passed), accepted / len(passed), failed, evaluations))


def _rise(log_likelihood: Array, most: float, ess_fraction: float) -> float:
    """The rise of the temperature, at most `most`, that keeps the share of effective draws among those possible."""
    finite = log_likelihood[np.isfinite(log_likelihood)]

    def surplus(rise: float) -> float:
        logs = rise * finite
        return float(np.exp(2.0 * logsumexp(logs) - logsumexp(2.0 * logs))) - ess_fraction * finite.size

    return most if surplus(most) >= 0.0 else float(brentq(surplus, 0.0, most, xtol=1e-15, rtol=1e-8))


def _systematic(weights: Array, n: int, rng: np.random.Generator) -> Array:
    """n indices of weights that add up to 1, in rising order; each occurs n times its weight, rounded up or down."""
    places = np.searchsorted(np.cumsum(weights), (rng.random() + np.arange(n)) / n)
    return np.minimum(places, np.flatnonzero(weights)[-1])


def _save(state: _State, path: Path, settings: dict[str, Any]) -> None:
    """Write a checkpoint, whole or not at all."""
    words = {
        "settings": settings,
        "rng": state.rng.bit_generator.state,
        "numbers": [state.temperature, state.walk, state.share],
        "steps": [asdict(step) for step in state.steps],
    }
    write_arrays(path, words=json.dumps(words), **{name: getattr(state, name) for name in _ARRAYS})


def _load(path: Path, settings: dict[str, Any]) -> _State:
    """Read a checkpoint.

    Raises:
        OptionError: It is no checkpoint, or that of another sampling.
    """
    try:
        text, *arrays = read_arrays(path, "words", *_ARRAYS)
    except StorageError:
        raise OptionError(f"{path}: is no checkpoint of the sampler, or damaged; remove it to begin anew") from None
    words = json.loads(str(text))
    other = [name for name, value in settings.items() if words["settings"].get(name) != value]
    if other:
        raise OptionError(f"{path}: is the checkpoint of another {', '.join(other)}; remove it to begin anew")
    rng = np.random.default_rng()
    rng.bit_generator.state = words["rng"]
    temperature, walk, share = words["numbers"]
    return _State(
        **dict(zip(_ARRAYS, arrays, strict=True)),
        rng=rng,
        temperature=temperature,
        walk=walk,
        share=share,
        steps=[Step(**step) for step in words["steps"]],
    )
