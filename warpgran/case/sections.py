"""The sections of a run file. Each key is declared once, with its default, range, unit, symbol and meaning.

A key is judged here by itself; rules that involve several keys are in `between_keys`. Keys and attributes have one
name, but for `lambda`, a word that Python keeps for itself: its attribute is `lambda_`. Numbers in parentheses are
equations of the paper.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Discriminator, Field, PlainValidator, StrictBool, StrictFloat, StrictInt, Tag, WithJsonSchema

from warpgran.arrays import Array
from warpgran.case.model import MM, MM_PER_S, KeyInfo, Model, declare
from warpgran.case.problems import shown
from warpgran.case.tables import BedTable, ProfileTable, Source, TableError, read_bed, read_profile

NotNegative = Annotated[StrictFloat, Field(ge=0)]


class Rheology(Model):
    """Friction, dilatancy and side walls; by default Table 1 of the paper."""

    mu1: StrictFloat = declare(0.48, "friction at rest", r"\mu_1", ge=0)
    """Friction at a vanishing inertial number (2.13)."""
    mu2: StrictFloat = declare(0.73, "friction in fast flow", r"\mu_2", allowed=">= rheology.mu1", ge=0)
    """Friction at a large inertial number (2.13)."""
    I0: StrictFloat = declare(0.279, "inertial number", "I_0", gt=0)
    """Inertial number where friction is half-way from `mu1` to `mu2`."""
    grain_diameter: StrictFloat = declare(7e-4, "grain diameter", "d", unit="m", display=MM, gt=0)
    """Grain diameter d, in the inertial number."""
    K: StrictFloat = declare(4.09, "dilation coefficient", "K", ge=0)
    """Dilation coefficient in tan psi = K (phi - phi_eq) (2.8); 0 is the incompressible model."""
    K_tilde: StrictFloat = declare(0.2, "slope of equilibrium", r"\tilde{K}", ge=0)
    """How fast phi_eq falls with the inertial number (2.9)."""
    phi_stat: StrictFloat = declare(0.582, "fraction at rest", r"\varphi_\mathrm{stat}", gt=0, lt=1)
    """phi_eq at rest."""
    phi_eq: Literal["f0", "f1", "f2"] = declare("f2", "law of equilibrium", r"\varphi_\mathrm{eq}")
    """Form of phi_eq(I), with s for `phi_stat` and q for `K_tilde` I: f0 is max(0, s - q), f1 is s exp(-q/s), f2 is
    s/(1 + q/(N s))^N.
    """
    phi_eq_N: StrictFloat = declare(1.0, "exponent of f2", "N", gt=0)
    """N of f2; the others do not use it."""
    mu_wall: StrictFloat = declare(0.0, "friction at the walls", r"\mu_\mathrm{w}", ge=0)
    """Friction at the side walls (4.1), 0 for none; the paper has 0.18."""
    channel_width: StrictFloat = declare(0.2, "channel width", "W", unit="m", gt=0)
    """Distance of the side walls."""


class Grid(Model):
    """Equal cells; cell i has its centre at left + (i + 1/2) (right - left)/cells."""

    left: StrictFloat = declare(-0.2, "left end of grid", r"x_\mathrm{left}", unit="m", allowed="< grid.right")
    """Left end."""
    right: StrictFloat = declare(1.6, "right end of grid", r"x_\mathrm{right}", unit="m", allowed="> grid.left")
    """Right end."""
    cells: StrictInt = declare(1800, "number of cells", "n", ge=4, le=10_000_000)
    """Number of cells."""

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


_PATH = "the path of a CSV file"
_TABLE = WithJsonSchema({"type": "string"})


class Slope(Model):
    """An inclined plane along x, and the bed on it; heights are measured normal to the plane."""

    angle: StrictFloat = declare(0.0, "slope angle", r"\theta", unit="degrees", display=("°", 1.0), ge=-80, le=80)
    """Inclination; positive is downhill toward +x, the opposite of the paper's Fig. 1."""
    gravity: StrictFloat = declare(9.81, "gravity", "g", unit="m/s2", display=("m/s²", 1.0), gt=0)
    """Acceleration of gravity."""
    bed: Annotated[BedTable | None, PlainValidator(_bed), _TABLE] = declare(
        None, "bed", "b", allowed=_PATH, unset="none: a plane"
    )
    """Bed elevation over x, normal to the plane."""


class Column(Model):
    """The grains at time 0: a rectangle at rest, or a profile."""

    height: StrictFloat = declare(0.14, "column height", "h_0", unit="m", gt=0)
    """Height of the rectangle."""
    length: StrictFloat = declare(0.20, "column length", r"\ell_0", unit="m", gt=0)
    """Length of the rectangle, which must lie in the grid and cover a cell centre."""
    phi: StrictFloat = declare(0.62, "initial fraction", r"\varphi_0", gt=0, lt=1)
    """Solid volume fraction, everywhere."""
    start: StrictFloat | None = declare(
        None, "column start", "x_0", unit="m", allowed="in the grid", unset="`grid.left`"
    )
    """Left end of the rectangle."""
    profile: Annotated[ProfileTable | None, PlainValidator(_profile), _TABLE] = declare(
        None, "initial profile", allowed=_PATH, unset="none: a rectangle"
    )
    """Thickness over x, and optionally solid volume fraction and velocity. It stands instead of `height`, `length` and
    `start`, and of `phi` where it has a column phi; a key that it replaces must not be set.
    """

    def start_on(self, grid: Grid) -> float:
        """Left end of the rectangle, m."""
        return grid.left if self.start is None else self.start

    @property
    def greatest_height(self) -> float:
        """Height of the rectangle, or greatest thickness of the profile, m."""
        return self.height if self.profile is None else float(self.profile.h.max())

    def thickness_on(self, grid: Grid) -> Array:
        """Thickness at the cell centres, m, shape (cells,); 0 at and beyond the ends."""
        x = grid.x
        if self.profile is not None:
            return np.interp(x, self.profile.x, self.profile.h, left=0.0, right=0.0)
        start = self.start_on(grid)
        return np.where((x > start) & (x < start + self.length), self.height, 0.0)


class Every(Model):
    """Equally spaced times 0, every, 2 every, ... up to the end."""

    every: StrictFloat = declare(..., "interval", unit="s", allowed="> 0 and <= time.end", gt=0)
    """Interval between the times."""


def _branch(value: Any) -> str | None:
    """The form of times that is meant, so that errors speak of that one alone."""
    if isinstance(value, Mapping | Every):
        return "<every>"
    return "<list>" if isinstance(value, list | tuple) else None


Times = Annotated[
    Annotated[tuple[NotNegative, ...], Tag("<list>")] | Annotated[Every, Tag("<every>")], Discriminator(_branch)
]


_TIMES = "times in [0, time.end] or { every = s }"


class Time(Model):
    """Duration and output times."""

    end: StrictFloat = declare(1.8, "end", r"t_\mathrm{end}", unit="s", gt=0)
    """When the run ends."""
    snapshots: Times | None = declare(
        None, "snapshots", unit="s", allowed=_TIMES, unset="t = 0 and five more, equally spaced"
    )
    """When whole profiles are stored."""
    series: Times | None = declare(None, "series", unit="s", allowed=_TIMES, unset="200 equal intervals")
    """When front, greatest height and the other scalars are stored."""
    rest_speed: StrictFloat | None = declare(
        None,
        "speed at rest",
        r"v_\mathrm{rest}",
        unit="m/s",
        display=MM_PER_S,
        unset="1e-3 sqrt(g_c h_0), h_0 the greatest height of the column",
        gt=0,
    )
    """The mass has stopped at the first sample after which its greatest speed stays below this."""
    stop_at_rest: StrictBool = declare(False, "stop at rest")
    """End a run at the first sample where what is thicker than `h_front` is slower than `rest_speed` and not speeding
    up; later samples and snapshots repeat that state.
    """
    step_limit: StrictInt = declare(10_000_000, "step limit", ge=1)
    """A run that takes more steps is given up."""


_End = Literal["wall", "open", "periodic"]


class Scheme(Model):
    """Choices of the numerical method."""

    order: StrictInt = declare(2, "order", allowed="1 or 2", ge=1, le=2)
    """Order of accuracy: 2, or 1 for the scheme of the paper."""
    start: StrictInt = declare(2, "start levels", order=2, ge=0, le=10)
    """The first moments of a run are computed on cells 2^start times smaller; 0 for none."""
    alpha: StrictFloat = declare(2.0, "exponent", r"\alpha", gt=1, le=10)
    """Exponent of the third conserved quantity, phi^alpha h."""
    lambda_: StrictFloat = declare(0.0, "weight", r"\lambda", alias="lambda", order=1, ge=0, le=1)
    """Weight of the kinetic energy in the reconstruction (B.16). In Python: `case.scheme.lambda_`."""
    cfl: StrictFloat = declare(0.45, "Courant number", "C", gt=0, le=0.5)
    """Courant number."""
    relaxation: Literal["rational", "exponential"] = declare("rational", "relaxation", order=1)
    """Dilatancy step: (3.17) or (3.18)."""
    viscosity: Literal["bounded", "paper"] = declare("bounded", "viscosity", order=1)
    """Stabilization: ours, or (3.20) to the letter."""
    xi: tuple[NotNegative, NotNegative, NotNegative] = declare(
        (2.0, 2.0, 5.0),
        "coefficients of the stabilization",
        r"\xi",
        allowed="three numbers >= 0, the second <= the first",
        order=1,
    )
    """Coefficients of the stabilization for mass, momentum and volume fraction; zeros turn it off."""
    h_min: StrictFloat | None = declare(
        None,
        "least thickness",
        r"h_\mathrm{min}",
        unit="m",
        display=MM,
        unset="five grain diameters; one with `order = 1`",
        gt=0,
    )
    """Least thickness in the shear rate, which means nothing below some grains."""
    h_bed: StrictFloat = declare(0.0, "bed layer", r"h_\mathrm{bed}", unit="m", display=MM, ge=0)
    """Thickness of a precursor layer beside the column, less than the column's height; 0 is a dry bed."""
    h_front: StrictFloat | None = declare(
        None, "front thickness", r"h_\mathrm{front}", unit="m", display=MM, unset="two grain diameters", gt=0
    )
    """Compacted thickness phi h/phi_stat that marks the front; the volume counts what is thicker."""
    left: _End = declare("wall", "left boundary")
    """Left boundary; periodic only together with the right one."""
    right: _End = declare("open", "right boundary")
    """Right boundary."""
    window: StrictBool = declare(True, "window")
    """Visit only what is wet. Off gives the same bits, for measuring."""

    @property
    def start_levels(self) -> int:
        """Levels of finer cells that a run starts on; none with order 1."""
        return self.start if self.order == 2 else 0

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

KEYS: dict[str, KeyInfo] = {
    f"{section}.{name}": known for section, model in SECTIONS.items() for name, known in model.described().items()
}
"""What is known of every dotted key."""

ALLOWED: dict[str, str] = {
    **dict.fromkeys(("title", *SECTIONS), ""),
    **{name: known.hint for name, known in KEYS.items()},
    **dict.fromkeys(("time.snapshots.every", "time.series.every"), Every.described()["every"].hint),
}
"""Every dotted key, sections first, and what is allowed there in words."""
