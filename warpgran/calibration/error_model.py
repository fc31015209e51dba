"""How far measurements and predictions may lie apart: noise, an error of the model, and an error of the grid.

For each kind of measurements (profiles, front, volume) the residuals r = measured - predicted are Gaussian with

    C = D + tau^2 R,    R_ij = exp(-|x_i - x_j|/(l X) - |t_i - t_j|/(l T))  within an experiment, 0 between two,

the form of Kennedy & O'Hagan (2001): independent noise, and a discrepancy of the model of size tau that is correlated
over a fraction l of the ranges X and T that the measurements span (exponential: Rasmussen & Williams 2006, ch. 4). D is
diagonal. With a column sigma D = sigma^2 + grid^2, grid being the error of the grid; without one the noise is inferred
too: D = s^2 (w^2 + (grid/s_0)^2) with w = 1, or w proportional to what is predicted, whichever the data favour.

tau, l, s and the choice of w are no parameters of the sampler: they do not change a run, so that their posterior is
summed over nodes for each prediction, and drawn afterwards. s is summed by formula: s^2 has a scaled inverse chi-square
prior, which makes the likelihood a Student's (Gelman et al. 2013, ch. 3).

Neighbouring residuals repeat each other: trace(D C^-1) is the number of independent measurements that would say as
much, the effective number of data.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.special import gammaln, logsumexp

from warpgran.arrays import Array
from warpgran.calibration.experiments import Experiments, Observed

LENGTHS = (0.03, 0.1, 0.3, 1.0)
"""Correlation lengths where none is given, equally likely, as fractions of the range."""
SIZES = np.geomspace(1e-3, 0.5, 24)
"""Errors of the model, over the scale of the kind; equally likely, which is uniform in the logarithm."""
RATIOS = np.geomspace(0.03, 30.0, 24)
"""The same over the noise, where that is inferred."""
NOISE, WORTH = 0.01, 1.0
"""Prior of an inferred noise: its size over the scale of the kind, and the number of measurements that it is worth."""
LEAST_SHAPE = 0.05
"""Least noise of the proportional form, over the scale of the kind."""


class Node(NamedTuple):
    """One combination of what is summed over.

    Attributes:
        size: tau in the unit of the kind; with inferred noise tau/s.
        length: l.
        proportional: Whether the noise is proportional to what is predicted.
    """

    size: float
    length: float
    proportional: bool


class Drawn(NamedTuple):
    """Draws of what is summed over.

    Attributes:
        node: Number of the node of each draw, (draws,).
        noise: Size of the noise, (draws,); 1 where sigma is measured.
    """

    node: Array
    noise: Array


@dataclass(frozen=True)
class _Part:
    """One experiment under one l and one form of the noise: C in the basis in which it is diagonal.

    Attributes:
        where: Place in the long vector.
        whitening: (data, data), of r into independent components of variance 1 + size^2 values.
        values: (data,).
        log_det: log det D.
        variance: The diagonal of D, (data,).
    """

    where: slice
    whitening: Array
    values: Array
    log_det: float
    variance: Array


class KindErrors:
    """The error model of one kind of measurements.

    Attributes:
        kind: Of the measurements.
        scale: What sizes are given over: the greatest value measured, for fronts their range.
        known: Whether sigma was measured.
        nodes: Combinations of size, length and form, equally likely.
    """

    def __init__(
        self,
        kind: str,
        parts: Sequence[tuple[slice, Observed]],
        predicted: Array,
        grid: Array,
        noise: float | None,
        length: float | None,
    ) -> None:
        """Prepare the sums.

        Args:
            kind: Of the measurements.
            parts: Each experiment's place in the long vector, and its measurements.
            predicted: What a good fit predicts, shape (all data,), for the noise in proportion.
            grid: Error of the grid, shape (all data,).
            noise: Size of the noise that the error of the grid is compared with where no sigma is given, if known.
            length: Correlation length; None to infer it.
        """
        self.kind = kind
        self.known = parts[0][1].sigma is not None
        values = np.concatenate([observed.value for _, observed in parts])
        self.scale = float(np.ptp(values) if kind == "front" else abs(values).max()) or float(abs(values).max()) or 1.0
        self.data = values.size
        lengths = LENGTHS if length is None else (length,)
        forms = (False,) if self.known else (False, True)
        sizes = self.scale * SIZES if self.known else RATIOS
        self.nodes = [Node(float(size), each, form) for each in lengths for form in forms for size in sizes]
        spans = [_span([observed.t for _, observed in parts]), _span([observed.x for _, observed in parts])]
        self._groups: list[list[_Part]] = []
        for each in lengths:
            for form in forms:
                group = []
                for where, observed in parts:
                    variance = self._variance(observed, predicted[where], grid[where], noise, form)
                    group.append(_part(where, observed, variance, each, spans))
                self._groups.append(group)
        self._sizes = sizes

    def _variance(self, observed: Observed, predicted: Array, grid: Array, noise: float | None, form: bool) -> Array:
        """The diagonal of D, over s^2 where the noise is inferred."""
        if observed.sigma is not None:
            return np.asarray(observed.sigma**2 + grid**2)
        shape = np.maximum(abs(predicted), LEAST_SHAPE * self.scale) / self.scale if form else np.ones(grid.size)
        return np.asarray(shape**2 + (0.0 if noise is None else (grid / noise) ** 2))

    def by_node(self, residuals: Array) -> tuple[Array, Array]:
        """Logarithm of the likelihood at each node, and the weighted sum of squares there, both (points, nodes).

        Args:
            residuals: Measured less predicted, shape (points, all data).
        """
        points = len(residuals)
        logs, squares = [], []
        for group in self._groups:
            q, log_det = np.zeros((points, self._sizes.size)), np.zeros(self._sizes.size)
            for part in group:
                variance = 1.0 + self._sizes[:, None] ** 2 * part.values
                q += (residuals[:, part.where] @ part.whitening) ** 2 @ (1.0 / variance).T
                log_det += np.log(variance).sum(axis=1) + part.log_det
            squares.append(q)
            logs.append(self._log_likelihood(q, log_det))
        return np.concatenate(logs, axis=1), np.concatenate(squares, axis=1)

    def _log_likelihood(self, q: Array, log_det: Array) -> Array:
        n = self.data
        if self.known:
            return np.asarray(-0.5 * (q + log_det + n * np.log(2.0 * np.pi)))
        worth, prior = WORTH, WORTH * (NOISE * self.scale) ** 2
        constant = (
            gammaln(0.5 * (n + worth)) - gammaln(0.5 * worth) + 0.5 * worth * np.log(prior) - 0.5 * n * np.log(np.pi)
        )
        return np.asarray(constant - 0.5 * log_det - 0.5 * (n + worth) * np.log(prior + q))

    def log_likelihood(self, residuals: Array) -> Array:
        """Logarithm of the likelihood with sizes, lengths and forms summed over, shape (points,)."""
        return np.asarray(logsumexp(self.by_node(residuals)[0], axis=1) - np.log(len(self.nodes)))

    def draw(self, residuals: Array, rng: np.random.Generator) -> Drawn:
        """Draws of what is summed over, one for each of some residuals (points, all data)."""
        logs, squares = self.by_node(residuals)
        weights = np.exp(logs - logsumexp(logs, axis=1, keepdims=True))
        chosen = (weights.cumsum(axis=1) < rng.random((len(logs), 1))).sum(axis=1).clip(max=len(self.nodes) - 1)
        q = squares[np.arange(len(chosen)), chosen] + WORTH * (NOISE * self.scale) ** 2
        noise = np.ones(len(chosen)) if self.known else np.sqrt(q / rng.chisquare(self.data + WORTH, len(chosen)))
        return Drawn(chosen, noise)

    def named(self, drawn: Drawn) -> dict[str, Array]:
        """Draws by name: model_error and, where it is inferred, noise, in the unit of the kind; correlation."""
        size = np.array([node.size for node in self.nodes])[drawn.node] * drawn.noise
        noise = {} if self.known else {"noise": drawn.noise}
        return {"model_error": size, **noise, "correlation": np.array([n.length for n in self.nodes])[drawn.node]}

    def errors(self, drawn: Drawn, rng: np.random.Generator) -> Array:
        """Errors that measurements would have under each draw, noise and model together: (draws, data)."""
        found = np.empty((len(drawn.node), self.data))
        for at in np.unique(drawn.node).tolist():
            rows = drawn.node == at
            group, size = self._groups[at // self._sizes.size], self.nodes[at].size
            parts = []
            for part in group:
                deviation = np.sqrt(1.0 + size**2 * part.values)
                normal = rng.standard_normal((int(rows.sum()), part.values.size))
                parts.append((normal * deviation) @ (part.whitening * part.variance[:, None]).T)
            found[rows] = np.concatenate(parts, axis=1)
        return found * drawn.noise[:, None]

    def likeliest(self, residuals: Array) -> tuple[Node, float]:
        """The likeliest node of one point (all data,), and the size of the noise there; 1 where sigma is measured."""
        logs, squares = self.by_node(residuals[None])
        at = int(np.argmax(logs[0]))
        q = squares[0, at] + WORTH * (NOISE * self.scale) ** 2
        return self.nodes[at], 1.0 if self.known else float(np.sqrt(q / (self.data + WORTH)))

    def whitened(self, residuals: Array, node: Node, noise: float) -> Array:
        """Residuals (points, all data) as independent ones of variance 1, those of this kind: (points, data)."""
        group = self._groups[self.nodes.index(node) // self._sizes.size]
        return np.concatenate(
            [residuals[:, p.where] @ p.whitening / np.sqrt(1.0 + node.size**2 * p.values) / noise for p in group],
            axis=1,
        )

    def effective(self, node: Node) -> float:
        """The effective number of data."""
        group = self._groups[self.nodes.index(node) // self._sizes.size]
        return float(sum((1.0 / (1.0 + node.size**2 * part.values)).sum() for part in group))

    def deviation(self, node: Node, noise: float) -> Array:
        """Standard deviation of each measurement, the error of the model included, shape (data,)."""
        group = self._groups[self.nodes.index(node) // self._sizes.size]
        size = node.size * noise
        return np.concatenate([np.sqrt(noise**2 * part.variance + size**2) for part in group])


def _span(values: Sequence[Array]) -> float:
    """Range of positions or times; 1 where there is none."""
    every = np.concatenate(values)
    return float(np.ptp(every)) if np.isfinite(every).all() and np.ptp(every) > 0 else 1.0


def _part(where: slice, observed: Observed, variance: Array, length: float, spans: Sequence[float]) -> _Part:
    """D and R of one experiment, made diagonal together."""
    distance = np.zeros((variance.size, variance.size))
    for values, span in zip((observed.t, np.nan_to_num(observed.x)), spans, strict=True):
        distance += abs(values[:, None] - values) / span
    root = np.sqrt(variance)
    values, vectors = np.linalg.eigh(np.exp(-distance / length) / root / root[:, None])
    return _Part(where, vectors / root[:, None], np.maximum(values, 0.0), float(np.log(variance).sum()), variance)


class ErrorModel:
    """The error model of all measurements.

    Attributes:
        experiments: What was measured.
        grid: Error of the grid, shape (data,).
        kinds: The error model of each kind.
    """

    def __init__(
        self,
        experiments: Experiments,
        length: float | None = None,
        predicted: Array | None = None,
        grid: Array | None = None,
        noise: Mapping[str, float] | None = None,
    ) -> None:
        """Prepare the sums of every kind.

        Args:
            experiments: What was measured.
            length: Correlation length; None to infer it.
            predicted: What a good fit predicts, shape (data,); by default what was measured.
            grid: Error of the grid, shape (data,); by default 0.
            noise: By kind the size of the noise of a good fit, which the error of the grid is compared with.
        """
        self.experiments = experiments
        self.value = experiments.value
        self.grid = np.zeros(self.value.size) if grid is None else grid
        by_kind: dict[str, list[tuple[slice, Observed]]] = {}
        for _, observed, where in experiments.slices():
            by_kind.setdefault(observed.kind, []).append((where, observed))
        self.kinds = {
            kind: KindErrors(kind, parts, self.value if predicted is None else predicted, self.grid,
                             (noise or {}).get(kind), length)
            for kind, parts in by_kind.items()
        }  # fmt: skip

    def log_likelihood(self, predictions: Array) -> Array:
        """Logarithm of the likelihood of predictions (points, data), shape (points,); minus infinity where NaN."""
        found = np.full(len(predictions), -np.inf)
        whole = np.isfinite(predictions).all(axis=1)
        residuals = self.value - predictions[whole]
        found[whole] = sum(errors.log_likelihood(residuals) for errors in self.kinds.values())
        return found

    def draw(self, predictions: Array, rng: np.random.Generator) -> tuple[dict[str, Array], Array]:
        """Draws of errors and lengths, one for each of some predictions (draws, data), and measurements under them.

        Returns:
            The draws by name, "front model_error", each (draws,), and what would be measured, (draws, data).
        """
        residuals = self.value - predictions
        named: dict[str, Array] = {}
        replicated = np.array(predictions)
        for kind, errors in self.kinds.items():
            drawn = errors.draw(residuals, rng)
            named |= {f"{kind} {name}": values for name, values in errors.named(drawn).items()}
            replicated[:, self.places(kind)] += errors.errors(drawn, rng)
        return named, replicated

    def places(self, kind: str) -> Array:
        """Places of a kind in the long vector."""
        parts = [where for _, observed, where in self.experiments.slices() if observed.kind == kind]
        return np.concatenate([np.arange(where.start, where.stop) for where in parts])

    def likeliest(self, prediction: Array) -> Likeliest:
        """The errors that are likeliest for one prediction (data,)."""
        residuals = self.value - prediction
        return Likeliest(self, {kind: errors.likeliest(residuals) for kind, errors in self.kinds.items()})


@dataclass(frozen=True)
class Likeliest:
    """An error model at its likeliest size, length and form of each kind.

    Attributes:
        model: The error model.
        nodes: By kind, with the size of the noise.
    """

    model: ErrorModel
    nodes: Mapping[str, tuple[Node, float]]

    def whitened(self, predictions: Array) -> Array:
        """Residuals of predictions (points, data) as independent ones of variance 1."""
        residuals = self.model.value - predictions
        kinds = self.model.kinds
        return np.concatenate([kinds[kind].whitened(residuals, *at) for kind, at in self.nodes.items()], axis=1)

    @property
    def noise(self) -> dict[str, float]:
        """Size of the noise by kind, where it is inferred."""
        return {kind: noise for kind, (_, noise) in self.nodes.items() if not self.model.kinds[kind].known}

    def effective(self) -> dict[str, float]:
        """The effective number of data by kind."""
        return {kind: self.model.kinds[kind].effective(node) for kind, (node, _) in self.nodes.items()}

    def deviation(self) -> Array:
        """Standard deviation of each measurement, the error of the model included, shape (data,)."""
        found = np.empty(self.model.value.size)
        for kind, at in self.nodes.items():
            found[self.model.places(kind)] = self.model.kinds[kind].deviation(*at)
        return found
