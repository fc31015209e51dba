"""The stages of a calibration: screening, best fit, posterior, predictions. Each is computed when it is asked for.

Everything that is computed is kept in a folder: the screening and the predictions as result files, the runs of the fit
and of the posterior as batches of predictions, the sampler's state. A second start with the same input computes what is
missing, and gives the same bits.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from warpgran.arrays import Array
from warpgran.calibration.batches import Batches
from warpgran.calibration.diagnostics import effective_size, r_hat, tail_size
from warpgran.calibration.error_model import ErrorModel
from warpgran.calibration.experiments import Experiments, read_experiments
from warpgran.calibration.fit import Fit, best_fit
from warpgran.calibration.forward import Forward
from warpgran.calibration.screening import Screening, shares_at, sobol_points
from warpgran.calibration.smc import Posterior, Step, sample
from warpgran.case.calibration_section import CalibrationStudy
from warpgran.case.identity import identity
from warpgran.case.problems import CaseError
from warpgran.run.options import DECISIVE, Options

if TYPE_CHECKING:
    import xarray as xr

STAGES = ("screening", "fit", "posterior", "predictive")
"""In their order; each needs those before it."""
Show = Callable[[str, float, float], None]
"""Called with the words of a stage, the amount done and the total."""
RICHARDSON = {1: 2.0, 2: 4.0 / 3.0}
"""Error of a grid over its difference to a grid of twice the cells, by the order of the scheme."""
TO_SAMPLE, TO_DRAW = 1, 2
"""What is added to the seed for each stage that draws."""


@dataclass(frozen=True)
class Sampled:
    """What the third stage has found.

    Attributes:
        samples: Of the parameters.
        predictions: Of each draw, (chains, draws, data).
        errors: Draws of the sizes of errors, (chains, draws) by name such as "front model_error".
        r_hat: Rank-normalized split R-hat by name; 1 where the populations agree.
        size: Effective number of draws by name, the lesser one of bulk and tails.
    """

    samples: Posterior
    predictions: Array
    errors: Mapping[str, Array]
    r_hat: Mapping[str, float]
    size: Mapping[str, float]


@dataclass(frozen=True)
class Predictive:
    """What the fourth stage has found.

    Attributes:
        theta: Draws from the posterior, (draws, parameters).
        data: Their runs, one of each experiment for each draw.
        predictions: What they predict of what was measured, (draws, data).
        replicated: The same with the errors that measurements have, (draws, data).
    """

    theta: Array
    data: xr.Dataset
    predictions: Array
    replicated: Array


class Stages:
    """The stages of one calibration.

    Attributes:
        study: What is asked for.
        experiments: What was measured.
        names: The parameters.
        output: The folder where everything is kept.
        forward: The model, with what its runs took.
    """

    def __init__(
        self,
        study: CalibrationStudy,
        data: Path,
        output: Path,
        options: Options,
        show: Show = lambda words, done, total: None,
    ) -> None:
        """Read the measurements. Nothing is computed yet.

        Raises:
            TableError: Lists everything that is wrong with the measurements.
        """
        self.study = study
        self.experiments: Experiments = read_experiments(study, data)
        self.names = tuple(study.priors)
        self.output = output
        self.forward = Forward(self.experiments, self.names, options)
        self._show = show

    @cached_property
    def _folder(self) -> Path:
        """Where runs are kept; made when first asked for."""
        folder = self.output / "runs"
        folder.mkdir(parents=True, exist_ok=True)
        return folder

    def _batches(self, forward: Forward, name: str) -> Batches:
        return Batches(lambda theta: forward(theta), self._folder / name, _identity(forward))

    @cached_property
    def _predict(self) -> Batches:
        return self._batches(self.forward, "batches")

    @cached_property
    def screening(self) -> Screening:
        """Sobol points of the prior. Its runs are kept as a result file."""
        theta = sobol_points(self.study.priors, self.study.section.screening, self.study.section.seed)
        path = self._folder / "screening.h5"
        predictions, _ = self.forward.kept(theta, path, lambda done, of: self._show("screening", done, of))
        return Screening(theta, predictions)

    @cached_property
    def fit(self) -> Fit:
        """The best fit, from the best points of the screening."""
        section = self.study.section
        model = ErrorModel(self.experiments, section.correlation)
        starts = self.screening.best(model.log_likelihood(self.screening.predictions), section.starts)
        count = 0

        def predict(theta: Array) -> Array:
            nonlocal count
            count += len(theta)
            self._show("best fit", count, count + len(theta))
            return self._predict(theta)

        def near(prediction: Array) -> ErrorModel:
            return ErrorModel(self.experiments, section.correlation, prediction)

        return best_fit(predict, near, self.study.priors, starts)

    @cached_property
    def grid_error(self) -> Array:
        """Error of the grid of each prediction at the best fit, (data,), from a grid of twice the cells."""
        base = self.experiments.base
        try:
            fine = base.with_(**{"grid.cells": 2 * base.grid.cells})
        except CaseError:
            return np.zeros(self.experiments.size)
        forward = Forward(Experiments(fine, self.experiments.each), self.names, self.forward.options)
        predicted = self._batches(forward, "fine")(self.fit.theta[None])[0]
        self.forward.tally.join(forward.tally)
        error = RICHARDSON[base.scheme.order] * abs(predicted - self.fit.prediction)
        return np.nan_to_num(error)

    @cached_property
    def error_model(self) -> ErrorModel:
        """How far measurements and predictions may lie apart, with the error of the grid."""
        return ErrorModel(
            self.experiments,
            self.study.section.correlation,
            self.fit.prediction,
            self.grid_error,
            self.fit.errors.noise,
        )

    @cached_property
    def posterior(self) -> Sampled:
        """Draws from the posterior; the screening is where the populations begin."""
        section, priors = self.study.section, self.study.priors
        screening, model = self.screening, self.error_model
        begin = len(screening.theta) // section.chains * section.chains  # as many for each population

        def log_likelihood(theta: Array) -> Array:
            begins = len(theta) == begin and np.allclose(theta, screening.theta[:begin], rtol=1e-9, atol=0.0)
            return model.log_likelihood(screening.predictions[:begin] if begins else self._predict(theta))

        def progress(step: Step) -> None:
            self._show("posterior", step.temperature, 1.0)

        known = _digest(_identity(self.forward), self.experiments.value, model.grid, repr(priors), repr(section),
                        *(o.sigma for _, o in self.experiments.observed()))  # fmt: skip
        start = shares_at(priors, screening.theta[:begin])
        found = sample(
            log_likelihood,
            list(priors.values()),
            particles=section.particles,
            chains=section.chains,
            seed=section.seed + TO_SAMPLE,
            start=np.clip(start, 1e-12, 1.0 - 1e-12),
            checkpoint=self._folder / f"posterior-{known}.npz",
            identity=known,
            progress=progress,
        )
        shape = found.theta.shape[:2]
        predictions = self._predict(found.theta.reshape(-1, len(priors)))
        errors, _ = model.draw(predictions, np.random.default_rng([section.seed, TO_DRAW]))
        draws = {name: found.theta[..., k] for k, name in enumerate(self.names)}
        return Sampled(
            found,
            predictions.reshape(*shape, -1),
            {name: values.reshape(shape) for name, values in errors.items()},
            {name: r_hat(values) for name, values in draws.items()},
            {name: min(effective_size(values), tail_size(values)) for name, values in draws.items()},
        )

    @cached_property
    def predictive(self) -> Predictive:
        """Runs of some draws of the posterior, as a result file, and what would be measured of them."""
        section = self.study.section
        rng = np.random.default_rng([section.seed, TO_DRAW, 1])
        draws = self.posterior.samples.theta.reshape(-1, len(self.names))
        theta = draws[np.sort(rng.choice(len(draws), min(section.predictive, len(draws)), replace=False))]
        path = self._folder / "predictive.h5"
        predictions, data = self.forward.kept(theta, path, lambda done, of: self._show("predictions", done, of))
        whole = np.isfinite(predictions).all(axis=1)
        replicated = np.full(predictions.shape, np.nan)
        replicated[whole] = self.error_model.draw(predictions[whole], rng)[1]
        return Predictive(theta, data, predictions, replicated)


def _identity(forward: Forward) -> str:
    """Of all that predictions depend on beside the parameters."""
    experiments, options = forward.experiments, forward.options
    return _digest(
        identity(experiments.base), *forward.names,
        *(repr(dict(e.changes)) for e in experiments.each),
        *(values for _, o in experiments.observed() for values in (o.kind, o.t, o.x)),
        *(str(getattr(options, name)) for name in DECISIVE), options.device.partition(":")[0],
        *map(version, ("warpgran", "warp-lang")),
    )  # fmt: skip


def _digest(*parts: Any) -> str:
    """A hash of texts and arrays, 16 hexadecimal digits."""
    found = hashlib.sha256()
    for part in parts:
        found.update(part.tobytes() if isinstance(part, np.ndarray) else repr(part).encode())
        found.update(b"|")
    return found.hexdigest()[:16]
