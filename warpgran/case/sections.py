"""The sections of a run file: their keys, defaults, ranges and meanings.

Lengths are in m, times in s, angles in degrees and everything else in SI units. A key is judged here by itself; rules
that involve several keys are in `between_keys`. Keys and attributes have one name, but for `lambda`, a word that
Python keeps for itself: its attribute is `lambda_`.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import (
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    PlainValidator,
    StrictBool,
    StrictFloat,
    StrictInt,
    Tag,
    model_validator,
)

from warpgran.arrays import Array
from warpgran.case.problems import shown
from warpgran.case.tables import BedTable, ProfileTable, Source, TableError, read_bed, read_profile


class Model(BaseModel):
    """Values by key: frozen, without unknown keys, numbers finite and only of numbers."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False, hide_input_in_errors=True)

    @model_validator(mode="before")
    @classmethod
    def _numpy_values(cls, data: Any) -> Any:
        """NumPy's numbers and arrays as Python's, which are all that strict numbers take."""
        if not isinstance(data, Mapping):
            return data
        return {k: v.tolist() if isinstance(v, np.generic | np.ndarray) else v for k, v in data.items()}

    @classmethod
    def keys(cls) -> dict[str, str]:
        """Every key of the run file by the attribute that holds it."""
        return {name: field.alias or name for name, field in cls.model_fields.items()}


def _key(default: Any, allowed: str, **options: Any) -> Any:
    """A key of the run file, with what is allowed there in words."""
    return Field(default, json_schema_extra={"allowed": allowed}, **options)


Positive = Annotated[StrictFloat, Field(gt=0)]
NotNegative = Annotated[StrictFloat, Field(ge=0)]


class Rheology(Model):
    """Friction, dilatancy and walls (Table 1 of the paper; equations 2.8, 2.9, 2.13, 2.14, 4.1).

    Attributes:
        mu1: Friction at a vanishing inertial number.
        mu2: Friction at a large inertial number.
        I0: Inertial number where friction is half-way.
        grain_diameter: d, m.
        K: Dilation coefficient; 0 is the incompressible model.
        K_tilde: Slope of the equilibrium volume fraction over the inertial number.
        phi_stat: Equilibrium volume fraction at rest.
        phi_eq: Regularization of the equilibrium volume fraction: f0, f1 or f2.
        phi_eq_N: Exponent N of f2.
        mu_wall: Friction at the side walls, 0 for none.
        channel_width: Distance of the side walls, m.
    """

    mu1: StrictFloat = _key(0.48, ">= 0", ge=0)
    mu2: StrictFloat = _key(0.73, ">= rheology.mu1", ge=0)
    I0: StrictFloat = _key(0.279, "> 0", gt=0)
    grain_diameter: StrictFloat = _key(7e-4, "> 0, in m", gt=0)
    K: StrictFloat = _key(4.09, ">= 0", ge=0)
    K_tilde: StrictFloat = _key(0.2, ">= 0", ge=0)
    phi_stat: StrictFloat = _key(0.582, "> 0 and < 1", gt=0, lt=1)
    phi_eq: Literal["f0", "f1", "f2"] = _key("f2", '"f0", "f1" or "f2"')
    phi_eq_N: StrictFloat = _key(1.0, "> 0", gt=0)
    mu_wall: StrictFloat = _key(0.0, ">= 0", ge=0)
    channel_width: StrictFloat = _key(0.2, "> 0, in m", gt=0)


class Grid(Model):
    """Equal cells along the slope.

    Attributes:
        left: Left end, m.
        right: Right end, m.
        cells: Number of cells.
    """

    left: StrictFloat = _key(-0.2, "< grid.right, in m")
    right: StrictFloat = _key(1.6, "> grid.left, in m")
    cells: StrictInt = _key(1800, ">= 4 and <= 10000000", ge=4, le=10_000_000)

    @property
    def dx(self) -> float:
        """Cell size, m."""
        return (self.right - self.left) / self.cells

    @property
    def x(self) -> Array:
        """Cell centres left + (i + 1/2) dx, m, shape (cells,)."""
        return self.left + (np.arange(self.cells, dtype=np.float64) + 0.5) * self.dx


def _source(value: Any) -> Source:
    if isinstance(value, str | os.PathLike | Mapping):
        return value
    raise TableError([f"{shown(value)} is not the path of a CSV file"])


def _bed(value: Any) -> BedTable | None:
    return value if value is None or isinstance(value, BedTable) else read_bed(_source(value))


def _profile(value: Any) -> ProfileTable | None:
    return value if value is None or isinstance(value, ProfileTable) else read_profile(_source(value))


class Slope(Model):
    """The plane and the bed on it.

    Attributes:
        angle: Inclination, degrees, positive downhill toward +x.
        gravity: g, m s-2.
        bed: Elevation normal to the plane, m, linear between points and constant beyond them; None for a plane.
    """

    angle: StrictFloat = _key(0.0, ">= -80 and <= 80, in degrees", ge=-80, le=80)
    gravity: StrictFloat = _key(9.81, "> 0, in m/s2", gt=0)
    bed: Annotated[BedTable | None, PlainValidator(_bed)] = _key(None, "the path of a CSV file")


class Column(Model):
    """The grains at time 0, at rest but for a profile with a velocity.

    Attributes:
        height: m.
        length: m.
        phi: Solid volume fraction.
        start: Left end, m; None for the left end of the grid.
        profile: Thickness and optionally solid volume fraction and velocity over x, instead of a rectangle.
    """

    height: StrictFloat = _key(0.14, "> 0, in m", gt=0)
    length: StrictFloat = _key(0.20, "> 0, in m", gt=0)
    phi: StrictFloat = _key(0.62, "> 0 and < 1", gt=0, lt=1)
    start: StrictFloat | None = _key(None, "in the grid, in m")
    profile: Annotated[ProfileTable | None, PlainValidator(_profile)] = _key(None, "the path of a CSV file")

    def start_on(self, grid: Grid) -> float:
        """Left end of the rectangle, m."""
        return grid.left if self.start is None else self.start

    def thickness_on(self, grid: Grid) -> Array:
        """Thickness at the cell centres, m, shape (cells,); 0 at and beyond the ends."""
        x = grid.x
        if self.profile is not None:
            return np.interp(x, self.profile.x, self.profile.h, left=0.0, right=0.0)
        start = self.start_on(grid)
        return np.where((x > start) & (x < start + self.length), self.height, 0.0)


class Every(Model):
    """Equally spaced times 0, every, 2 every, ... up to the end, in s."""

    every: Positive


def _branch(value: Any) -> str | None:
    """Which of the two forms of times is meant, so that errors are told of that one alone."""
    if isinstance(value, Mapping | Every):
        return "<every>"
    return "<list>" if isinstance(value, list | tuple) else None


Times = Annotated[
    Annotated[tuple[NotNegative, ...], Tag("<list>")] | Annotated[Every, Tag("<every>")], Discriminator(_branch)
]


class Time(Model):
    """How long to run and when to look, in s.

    Attributes:
        end: Last time.
        snapshots: Times of whole profiles; None for five, equally spaced.
        series: Times of the scalar series.
        rest_speed: The mass is at rest below this speed, m s-1.
        stop_at_rest: End a run at the first sample where it is slower than rest_speed and not speeding up.
        step_limit: A run that takes more steps is given up.
    """

    end: StrictFloat = _key(1.8, "> 0, in s", gt=0)
    snapshots: Times | None = _key(None, "times in [0, time.end] or { every = s }, in s")
    series: Times = _key(Every(every=0.01), "times in [0, time.end] or { every = s }, in s")
    rest_speed: StrictFloat = _key(1e-3, "> 0, in m/s", gt=0)
    stop_at_rest: StrictBool = _key(False, "true or false")
    step_limit: StrictInt = _key(10_000_000, ">= 1", ge=1)


class Scheme(Model):
    """Choices of the numerical method.

    Attributes:
        alpha: Exponent of the third conserved quantity phi^alpha h.
        lambda_: Weight of the kinetic energy in the reconstruction; `lambda` in the run file.
        cfl: Courant number.
        relaxation: Dilatancy step, rational (3.17) or exponential (3.18).
        viscosity: Stabilization, bounded or as in the paper (3.20).
        xi: Coefficients of the stabilization for mass, momentum and volume fraction.
        h_min: Least thickness in the shear rate, m; None for one grain diameter.
        h_bed: Thickness of the layer beside the column, m.
        h_front: Thickness that marks the front, m.
        left: Left boundary, wall, open or periodic.
        right: Right boundary, wall, open or periodic.
        window: Visit only what is wet; off gives the same bits, for measuring.
    """

    alpha: StrictFloat = _key(2.0, "> 1 and <= 10", gt=1, le=10)
    lambda_: StrictFloat = _key(0.0, ">= 0 and <= 1", ge=0, le=1, alias="lambda")
    cfl: StrictFloat = _key(0.45, "> 0 and <= 0.5", gt=0, le=0.5)
    relaxation: Literal["rational", "exponential"] = _key("rational", '"rational" or "exponential"')
    viscosity: Literal["bounded", "paper"] = _key("bounded", '"bounded" or "paper"')
    xi: tuple[NotNegative, NotNegative, NotNegative] = _key(
        (2.0, 2.0, 5.0), "three numbers >= 0, the second <= the first"
    )
    h_min: Positive | None = _key(None, "> 0, in m")
    h_bed: StrictFloat = _key(0.0, ">= 0, in m", ge=0)
    h_front: StrictFloat = _key(1e-3, "> 0, in m", gt=0)
    left: Literal["wall", "open", "periodic"] = _key("wall", '"wall", "open" or "periodic"')
    right: Literal["wall", "open", "periodic"] = _key("open", '"wall", "open" or "periodic"')
    window: StrictBool = _key(True, "")

    @property
    def periodic(self) -> bool:
        """Whether the two ends of the grid are one interface."""
        return self.left == "periodic"


SECTIONS: dict[str, type[Model]] = {
    "rheology": Rheology,
    "slope": Slope,
    "column": Column,
    "grid": Grid,
    "time": Time,
    "scheme": Scheme,
}


def _allowed() -> dict[str, str]:
    words = {"title": "", **dict.fromkeys(SECTIONS, "")}
    for section, model in SECTIONS.items():
        for name, key in model.keys().items():
            extra = model.model_fields[name].json_schema_extra
            words[f"{section}.{key}"] = str(extra["allowed"]) if isinstance(extra, dict) else ""
    return words | dict.fromkeys(("time.snapshots.every", "time.series.every"), "> 0 and <= time.end, in s")


ALLOWED = _allowed()
"""Every dotted key, sections first, and what is allowed there in words."""
