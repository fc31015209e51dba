"""What a result holds: the name, dimensions, units and meaning of every variable, in memory and in the file."""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

SCHEMA_VERSION = 1
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


COORDINATES = {
    "x": Variable(("cell",), "m", "distance along the slope"),
    "bed": Variable(("cell",), "m", "bed elevation normal to the slope"),
    "time": Variable(("time",), "s", "time of the snapshots"),
    "series_time": Variable(("sample",), "s", "time of the series"),
}
"""x and bed have the dimensions (run, cell) where the grids of a batch differ."""

FIELDS = {
    "h": Variable(("run", "time", "cell"), "m", "thickness normal to the slope"),
    "v": Variable(("run", "time", "cell"), "m s-1", "velocity along the slope"),
    "phi": Variable(("run", "time", "cell"), "1", "solid volume fraction"),
}

SERIES = {
    "front": Variable(("run", "sample"), "m", "front position, where the compacted thickness falls through h_front"),
    "front_speed": Variable(("run", "sample"), "m s-1", "front speed"),
    "h_max": Variable(("run", "sample"), "m", "maximum thickness"),
    "v_max": Variable(("run", "sample"), "m s-1", "maximum speed, however thin the flow"),
    "v_flow": Variable(("run", "sample"), "m s-1", "maximum speed where the compacted thickness exceeds h_front"),
    "volume_change": Variable(("run", "sample"), "1", "relative change of the volume that h_front marks"),
    "mass": Variable(("run", "sample"), "m2", "volume of solid per unit width"),
    "energy": Variable(("run", "sample"), "m4 s-2", "energy (2.7) per unit width and grain density"),
    "outflow": Variable(("run", "sample"), "1", "share of the solid that has left through the ends"),
}

PER_RUN = {
    "status": Variable(("run",), "1", "how the run ended"),
    "steps": Variable(("run",), "1", "time steps taken"),
    "stop_time": Variable(("run",), "s", "first sample after which v_flow stays below rest_speed"),
    "end_time": Variable(("run",), "s", "time reached"),
    "failure": Variable(("run",), "1", "where and how the run diverged"),
}

PARAMETERS = "params"
"""Group of the file that holds the keys in which the runs differ."""
