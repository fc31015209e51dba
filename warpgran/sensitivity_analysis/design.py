"""The design that the runs of a result were computed for, and its runs in order."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass

import numpy as np
import xarray as xr

from warpgran.analysis.run_columns import WAITING
from warpgran.analysis.runs import status_words
from warpgran.arrays import Array
from warpgran.case.sensitivity_section import Sensitivity, read_sensitivity
from warpgran.errors import ResultError


@dataclass(frozen=True)
class Design:
    """A design and the values of its parameters.

    Attributes:
        section: What was asked for.
        values: Of the parameters, shape (samples, runs of a sample, parameters), in the units of the run file.
    """

    section: Sensitivity
    values: Array

    @property
    def keys(self) -> tuple[str, ...]:
        """The parameters, dotted."""
        return tuple(self.section.over)

    def by_sample(self, values: Array) -> Array:
        """Values of each run, shape (runs, ...), as (samples, runs of a sample, ...)."""
        return values.reshape(*self.values.shape[:2], *values.shape[1:])


def design_of(data: xr.Dataset) -> Design:
    """The design of a result.

    Args:
        data: All runs of it.

    Raises:
        ResultError: It is none, or lacks runs of it.
    """
    text = data.attrs.get("sensitivity")
    if not text:
        raise ResultError("the result is no sensitivity design: its run file has no section [sensitivity]")
    section = read_sensitivity(tomllib.loads(text)["sensitivity"])
    asked, there = section.size * section.per_sample, np.atleast_1d(data["run"].values)
    if not np.array_equal(there, np.arange(asked)):
        raise ResultError(
            f"the result has {there.size} of the {asked} runs of its design; allowed: all, so merge its shards"
        )
    waiting = int(np.isin(status_words(data), WAITING).sum())
    if waiting:
        raise ResultError(f"{waiting} of the {asked} runs of the design are not computed; compute them with --resume")
    values = np.stack([data[key].values.astype(float) for key in section.over], axis=1)
    return Design(section, values.reshape(section.size, section.per_sample, -1))
