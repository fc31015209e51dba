"""The indices of a result as a labelled dataset: `wg.indices`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from warpgran.arrays import Array
from warpgran.errors import ResultError
from warpgran.sensitivity_analysis.design import Design, design_of
from warpgran.sensitivity_analysis.main_effects import main_effects
from warpgran.sensitivity_analysis.morris import morris
from warpgran.sensitivity_analysis.outputs import Output, outputs_of
from warpgran.sensitivity_analysis.sobol import CONFIDENCE, Estimate, sobol
from warpgran.sensitivity_analysis.soundness import kept

ROUNDING = {"float64": 1e-9, "float32": 1e-5}
"""A standard deviation below this share of the output is rounding, by the precision of the runs."""
OVER_TIME = "_over_time"
"""End of the name of a variable that is resolved in time."""
LONG_NAMES = {
    "first_order": "first-order Sobol index",
    "total_order": "total Sobol index",
    "mu_star": "mean amount of the elementary effect",
    "mu": "mean elementary effect",
    "sigma": "standard deviation of the elementary effect",
    "mean": "mean over the runs",
    "sd": "standard deviation over the runs",
    "main_effect": "mean of the output at a value of the parameter",
    "main_effect_low": "5 % of the output at a value of the parameter",
    "main_effect_high": "95 % of the output at a value of the parameter",
    "main_effect_at": "value of the parameter",
}
COPIED = ("title", "run_file", "case_toml", "sensitivity", "warpgran_version", "warp_version", "precision", "device")
"""Attributes of the result that go with its indices."""


def indices(data: xr.Dataset, of: Sequence[str] | None = None, *, drop_failed: bool = False) -> xr.Dataset:
    """Sensitivity indices of the runs of a design.

    Args:
        data: The result of a `[sensitivity]` file, with all its runs.
        of: What is asked about, instead of what the file asks: `run_out`, `h_max_final`, `dilation_max`, `stop_time`,
            series (`front`), which are resolved in time, and series at a time (`front@0.5`).
        drop_failed: Leave out the base samples of runs that cannot be used, instead of refusing them.

    Returns:
        Variables over `output` and `parameter`; NaN where an output does not vary.

        - sobol: first_order and total_order, shares of the variance, each with _low and _high, the ends of its 95 %
          bootstrap interval; main_effect with _low and _high (5 and 95 % of the runs) over `bin`
        - morris: mu_star with its interval, mu and sigma, in units of the output
        - both: mean and sd of the outputs

        Those of series stand over `series`, `series_time` and `parameter`, with _over_time behind their names. The
        attributes samples and dropped_samples count what was used and left out; notes are warnings, a line each.

    Raises:
        ResultError: It is no design or not all of it, something asked for is not known, or runs cannot be used.
    """
    design = design_of(data)
    outputs = outputs_of(data, design.section.of if of is None else of)
    good, notes = kept(design, data, outputs, drop_failed)
    found = xr.Dataset(
        coords={
            "parameter": list(design.keys),
            "distribution": ("parameter", [str(law) for law in design.section.over.values()]),
        },
        attrs={name: data.attrs[name] for name in COPIED if name in data.attrs},
    )
    rounding = ROUNDING[str(data.attrs.get("precision", "float64"))]
    single = [output for output in outputs if output.times is None]
    series = [output for output in outputs if output.times is not None]
    if single:
        values = design.by_sample(np.stack([output.values for output in single], axis=1))[good]
        found = found.assign_coords(_labels("output", single))
        found = found.assign(_computed(design, good, values, rounding, ("output",), ""))
        if design.section.method == "sobol":
            found = found.assign(_main_effects(design, good, values))
    if series:
        times = data["series_time"].values
        values = design.by_sample(np.concatenate([output.values for output in series], axis=1))[good]
        found = found.assign_coords(_labels("series", series))
        found = found.assign_coords(series_time=("series_time", times, {"units": "s", "long_name": "time"}))
        computed = _computed(design, good, values, rounding, ("series", "series_time"), OVER_TIME, times.size)
        found = found.assign(computed)
    notes += _constant(found)
    found.attrs |= {
        "method": design.section.method,
        "samples": int(good.sum()),
        "dropped_samples": int((~good).sum()),
        "runs": good.size * design.section.per_sample,
        "seed": design.section.seed,
        "confidence": CONFIDENCE,
        "notes": "\n".join(notes),
    }
    return found


def _labels(dim: str, outputs: Sequence[Output]) -> dict[str, tuple[str, list[str]]]:
    return {
        dim: (dim, [output.name for output in outputs]),
        f"{dim}_units": (dim, [output.units for output in outputs]),
        f"{dim}_words": (dim, [output.words for output in outputs]),
    }


def _computed(
    design: Design, good: Array, y: Array, rounding: float, dims: tuple[str, ...], suffix: str, times: int = 0
) -> dict[str, xr.Variable]:
    """The variables of outputs whose values are given, shape (samples, runs of a sample, outputs)."""
    seed = design.section.seed
    if design.section.method == "sobol":
        whole = sobol(y, seed, rounding)
        values: dict[str, Array | Estimate] = {"first_order": whole.first_order, "total_order": whole.total_order}
        independent = y[:, :2]
    else:
        statistics = morris(y, design.values[good], seed)
        values = {"mu_star": statistics.mu_star, "mu": statistics.mu, "sigma": statistics.sigma}
        independent = y[:, :1]
    plain: dict[str, Array] = {"mean": independent.mean(axis=(0, 1)), "sd": independent.std(axis=(0, 1))}
    for name, value in values.items():
        parts = value._asdict() if isinstance(value, Estimate) else {"value": value}
        plain |= {name if part == "value" else f"{name}_{part}": array for part, array in parts.items()}
    variables = {}
    for name, array in plain.items():
        own = (*dims, "parameter") if array.ndim == 2 else dims
        shaped = array.reshape(-1, times, *array.shape[1:]) if times else array
        variables[name + suffix] = xr.Variable(own, shaped, _attributes(name))
    return variables


def _attributes(name: str) -> dict[str, str]:
    base = name.removesuffix("_low").removesuffix("_high")
    if name in LONG_NAMES:
        words = LONG_NAMES[name]
    else:
        words = f"{LONG_NAMES[base]}, {name.rpartition('_')[2]} end of the interval"
    return {"long_name": words} | ({"units": "1"} if base.endswith("_order") else {})


def _main_effects(design: Design, good: Array, y: Array) -> dict[str, xr.Variable]:
    effects = main_effects(y, design.values[good])
    dims = ("output", "parameter", "bin")
    arrays = {"main_effect": effects.mean, "main_effect_low": effects.low, "main_effect_high": effects.high}
    variables = {name: xr.Variable(dims, array, _attributes(name)) for name, array in arrays.items()}
    return variables | {"main_effect_at": xr.Variable(dims[1:], effects.at, _attributes("main_effect_at"))}


def _constant(found: xr.Dataset) -> list[str]:
    """Which outputs do not vary at all."""
    if "first_order" not in found:
        return []
    return [
        f"{name} is the same in all runs, so that it has no indices"
        for name in found["output"].values.tolist()
        if found["total_order"].sel(output=name).isnull().all()
    ]


def checked_of(of: Sequence[str]) -> tuple[str, ...]:
    """Names of outputs that `--of` gives, some with commas between.

    Raises:
        ResultError: There is none.
    """
    names = tuple(name.strip() for text in of for name in text.split(",") if name.strip())
    if not names:
        raise ResultError("of: asks for nothing; allowed: results of a run, and series")
    return names
