"""What a result holds: the name, dimensions, units and meaning of every variable, in memory and in the file alike."""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

SCHEMA_VERSION = 2
"""Goes up when a reader of older files would misread a new one."""


class Status(IntEnum):
    """How a run ended. Some are also the codes of kernels/clock.py."""

    OK = 0
    DIVERGED = 1
    STEP_LIMIT = 2
    INTERRUPTED = 3
    AT_REST = 4
    PENDING = 5

    @property
    def clean(self) -> bool:
        """Whether the run did all that was asked of it."""
        return self in (Status.OK, Status.AT_REST)

    @property
    def word(self) -> str:
        """The name in the file and in messages."""
        return self.name.lower()


CLEAN = tuple(status.word for status in Status if status.clean)
"""Words of the runs that did all that was asked of them."""


class Variable(NamedTuple):
    """One variable of a result."""

    dims: tuple[str, ...]
    units: str
    long_name: str
    standard_name: str = ""

    @property
    def attributes(self) -> dict[str, str]:
        """The names of the CF conventions."""
        named = {"units": self.units, "long_name": self.long_name, "standard_name": self.standard_name}
        return {name: text for name, text in named.items() if text}

    @property
    def padded(self) -> Variable:
        """The same where the grids of a batch differ: over numbers of cells, and x and bed in each run."""
        dims = tuple("cell" if dim == "x" else dim for dim in self.dims)
        return self._replace(dims=dims if "run" in dims or "cell" not in dims else ("run", *dims))


COORDINATES = {
    "run": Variable(("run",), "1", "number of the run in the study"),
    "time": Variable(("time",), "s", "time of the snapshots", "time"),
    "series_time": Variable(("series_time",), "s", "time of the series", "time"),
    "x": Variable(("x",), "m", "distance along the slope"),
    "cell": Variable(("cell",), "1", "number of the cell"),
}
"""Of the dimensions. A result has x where all its runs share the grid, else cell, and x and bed over (run, cell)."""

GRID = {
    "x": COORDINATES["x"],
    "bed": Variable(("x",), "m", "bed elevation normal to the slope"),
}
"""Of each grid."""

FIELDS = {
    "h": Variable(("run", "time", "x"), "m", "thickness normal to the slope"),
    "v": Variable(("run", "time", "x"), "m s-1", "velocity along the slope"),
    "phi": Variable(("run", "time", "x"), "1", "solid volume fraction"),
}

SERIES = {
    "front": Variable(
        ("run", "series_time"), "m", "front position, where the compacted thickness falls through h_front"
    ),
    "front_speed": Variable(("run", "series_time"), "m s-1", "front speed"),
    "h_max": Variable(("run", "series_time"), "m", "maximum thickness"),
    "v_max": Variable(("run", "series_time"), "m s-1", "maximum speed, however thin the flow"),
    "v_flow": Variable(("run", "series_time"), "m s-1", "maximum speed where the compacted thickness exceeds h_front"),
    "volume_change": Variable(("run", "series_time"), "1", "relative change of the volume that h_front marks"),
    "mass": Variable(("run", "series_time"), "m2", "volume of solid per unit width"),
    "energy": Variable(("run", "series_time"), "m4 s-2", "energy (2.7) per unit width and grain density"),
    "outflow": Variable(("run", "series_time"), "1", "share of the solid that has left through the ends"),
}

PER_RUN = {
    "status": Variable(("run",), "1", "how the run ended"),
    "steps": Variable(("run",), "1", "time steps taken"),
    "end_time": Variable(("run",), "s", "time reached"),
    "failure": Variable(("run",), "1", "where and how the run diverged"),
    "run_out": Variable(("run",), "m", "way of the front from the first sample to the last"),
    "h_max_final": Variable(("run",), "m", "maximum thickness at the end"),
    "v_flow_final": Variable(("run",), "m s-1", "v_flow at the end"),
    "outflow_final": Variable(("run",), "1", "share of the solid that has left through the ends until the end"),
    "dilation_max": Variable(("run",), "1", "largest volume_change"),
    "stop_time": Variable(("run",), "s", "first sample after which v_flow stays below rest_speed"),
}


def is_key(name: str) -> bool:
    """Whether a variable is a key of the run file in which the runs differ: a coordinate of `run`."""
    return "." in name
