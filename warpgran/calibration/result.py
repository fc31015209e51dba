"""The netCDF file of a calibration, in the groups that ArviZ reads.

Groups: `posterior`, `sample_stats`, `posterior_predictive` and `prior` have the dimensions chain and draw first;
`observed_data` holds what was measured under the same names as `posterior_predictive`, and `constant_data` its standard
deviations and the error of the grid. ArviZ 0.23 opens it by `arviz.from_netcdf`, 1.x and plain xarray by
`xarray.open_datatree`. Two groups of ours stand beside them: `fit`, the best fit, and `tempering`, the sampler's way.

The likelihood of correlated measurements is no product over them, so that there is no group `log_likelihood`; that of
each draw is in `sample_stats`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from warpgran.arrays import Array
from warpgran.calibration.experiments import KINDS, UNITS, Experiments
from warpgran.case.sections import KEYS
from warpgran.files import MARK, replacing

if TYPE_CHECKING:
    import xarray as xr

    from warpgran.calibration.calibrate import Calibrated

PACKAGES = ("warpgran", "warp-lang", "numpy", "scipy")
"""Whose versions are written down."""
MEASURED = {"profiles": "thickness", "front": "position of the front", "volume": "volume over the initial one, less 1"}


def write_result(found: Calibrated, path: Path) -> None:
    """Write what was asked for, whole or not at all, over an earlier file of warpgran.

    Raises:
        StorageError: The file cannot be written, or something else is there.
    """
    import xarray as xr

    with replacing(path, ours=MARK) as part:
        xr.Dataset(attrs=_attributes(found)).to_netcdf(part, mode="w", engine="h5netcdf")
        for name, data in groups(found).items():
            data.attrs |= {"created_at": datetime.now(UTC).isoformat(), "inference_library": "warpgran"}
            data.to_netcdf(part, mode="a", group=name, engine="h5netcdf")


def groups(found: Calibrated) -> dict[str, xr.Dataset]:
    """The groups of the file by name, of the stages that were asked for."""
    import xarray as xr

    stages, experiments = found.stages, found.stages.experiments
    everything: dict[str, xr.Dataset] = {"observed_data": _measured(experiments, experiments.value, ())}
    theta = stages.screening.theta
    prior = {name: _variable(name, theta[None, :, k]) for k, name in enumerate(stages.names)}
    everything["prior"] = xr.Dataset(prior).assign_coords(_draws(theta[None]))
    if not found.reached("fit"):
        return everything
    everything["constant_data"] = _constants(found)
    everything["fit"] = _fit(found)
    if not found.reached("posterior"):
        return everything
    sampled = stages.posterior
    draws, errors = sampled.samples, sampled.errors
    posterior = {name: _variable(name, draws.theta[..., k]) for k, name in enumerate(stages.names)}
    posterior |= {name.replace(" ", "."): _variable(name, values) for name, values in errors.items()}
    coordinates = _draws(draws.theta)
    everything["posterior"] = xr.Dataset(posterior).assign_coords(coordinates)
    logs = (("chain", "draw"), draws.log_likelihood, {"long_name": "log likelihood of all measurements", "units": "1"})
    everything["sample_stats"] = xr.Dataset({"log_likelihood": logs}).assign_coords(coordinates)
    steps = [asdict(step) for step in draws.steps]
    tempering = {name: ("step", np.array([step[name] for step in steps])) for name in steps[0]}
    evidence = ("chain", draws.log_evidence, {"long_name": "log marginal likelihood", "units": "1"})
    everything["tempering"] = xr.Dataset(tempering | {"log_evidence": evidence})
    if found.reached("predictive"):
        predictive = stages.predictive
        everything["posterior_predictive"] = _measured(
            experiments, predictive.replicated[None], ("chain", "draw")
        ).assign_coords(_draws(predictive.replicated[None]))
    return everything


def _draws(values: Array) -> dict[str, Array]:
    """Coordinates of draws (chains, draws, ...)."""
    return {"chain": np.arange(values.shape[0]), "draw": np.arange(values.shape[1])}


def _variable(name: str, values: Array) -> tuple[tuple[str, str], Array, dict[str, str]]:
    """A parameter, or the size of an error, with its unit."""
    if name in KEYS:
        return ("chain", "draw"), values, {"long_name": KEYS[name].name, "units": KEYS[name].unit or "1"}
    kind, _, size = name.partition(" ")
    unit = "1" if size == "correlation" else UNITS[kind]
    return ("chain", "draw"), values, {"long_name": f"{kind}: {size.replace('_', ' ')}", "units": unit}


def _by_kind(experiments: Experiments) -> Iterator[tuple[str, Array, dict[str, Any]]]:
    """Each kind with the places of its measurements in the long vector, and their coordinates."""
    for kind in KINDS:
        found = [(number, o, where) for number, o, where in experiments.slices() if o.kind == kind]
        if not found:
            continue
        dim = f"{kind}_datum"
        names = np.concatenate([np.repeat(experiments.each[number].name, o.t.size) for number, o, _ in found])
        coordinates: dict[str, Any] = {
            f"{kind}_experiment": (dim, names.astype(object)),
            f"{kind}_t": (dim, np.concatenate([o.t for _, o, _ in found]), {"long_name": "time", "units": "s"}),
        }
        if kind == "profiles":
            x = np.concatenate([o.x for _, o, _ in found])
            coordinates[f"{kind}_x"] = (dim, x, {"long_name": "position", "units": "m"})
        yield kind, np.concatenate([np.arange(w.start, w.stop) for _, _, w in found]), coordinates


def _measured(experiments: Experiments, values: Array, dims: tuple[str, ...]) -> xr.Dataset:
    """Values (..., data) of what was measured, a variable a kind."""
    import xarray as xr

    data = xr.Dataset()
    for kind, places, coordinates in _by_kind(experiments):
        attributes = {"long_name": MEASURED[kind], "units": UNITS[kind]}
        data[kind] = ((*dims, f"{kind}_datum"), values[..., places], attributes)
        data = data.assign_coords(coordinates)
    return data


def _constants(found: Calibrated) -> xr.Dataset:
    """Standard deviations of the measurements, NaN where none is given, and the error of the grid."""
    import xarray as xr

    experiments = found.stages.experiments
    sigma = np.concatenate(
        [np.full(o.value.size, np.nan) if o.sigma is None else o.sigma for _, o in experiments.observed()]
    )
    data = xr.Dataset()
    for kind, places, coordinates in _by_kind(experiments):
        for name, words, values in (
            ("sigma", "standard deviation, as measured", sigma),
            ("grid_error", "error of the grid", found.stages.grid_error),
        ):
            attributes = {"long_name": f"{kind}: {words}", "units": UNITS[kind]}
            data[f"{kind}_{name}"] = (f"{kind}_datum", values[places], attributes)
        data = data.assign_coords(coordinates)
    return data


def _fit(found: Calibrated) -> xr.Dataset:
    """The best fit: values and covariance of the parameters, and what it predicts."""
    fit, experiments = found.stages.fit, found.stages.experiments
    data = _measured(experiments, fit.prediction, ())
    names = np.array(fit.names, dtype=object)
    data = data.assign_coords({"parameter": names, "parameter_of_column": names})
    data["value"] = ("parameter", fit.theta, {"long_name": "best fit, in the units of the run file"})
    data["covariance"] = (
        ("parameter", "parameter_of_column"), fit.covariance,
        {"long_name": "covariance at the best fit, the prior included"},
    )  # fmt: skip
    data["log_likelihood"] = ((), fit.log_likelihood, {"long_name": "log likelihood at the best fit"})
    return data


def _attributes(found: Calibrated) -> dict[str, Any]:
    """What was computed, and by what."""
    study, options = found.stages.study, found.stages.forward.options
    priors = "\n".join(f"{name}: {prior}" for name, prior in study.priors.items())
    return {
        "title": study.base.title or "Calibration",
        "case": study.base.to_toml(),
        "priors": priors,
        "experiments": "\n".join(experiment.name for experiment in found.stages.experiments.each),
        "seed": study.section.seed,
        "stage": found.last,
        "converged": "yes" if found.converged else "no",
        "remarks": "\n".join(found.told()),
        "device": options.device,
        "precision": options.precision,
        "versions": "\n".join(f"{package} {version(package)}" for package in PACKAGES),
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
    }
