"""What a step is made of: kernels in the order of launch, and what the threads of each are over."""

from enum import Enum
from typing import Any, NamedTuple


class Over(Enum):
    """What the threads of a launch are over."""

    CELLS = "the windows of all runs, in chunks that lanes walk, see ranges.py"
    RUNS = "the runs, a thread each"
    LANES = "the runs, a block of lanes each"


class Stage(NamedTuple):
    """A launch.

    Attributes:
        kernel: Each of its arguments is the array or number of that name, see the package.
        over: What its threads are over.
        named: Arguments that are an array of another name, since two stages of a scheme share the kernel.
    """

    kernel: Any
    over: Over
    named: dict[str, str] = {}  # noqa: RUF012


class Stages(NamedTuple):
    """A scheme as lists of launches.

    Attributes:
        load: Once, after runs have been loaded.
        look: What a state decodes to, and its recording in the runs that are due.
        choose: The time step of each run.
        advance: The state after that step.
        tick: The time after that step.
        start: Before each replay of the time loop, whose condition it sets.
    """

    load: tuple[Stage, ...]
    look: tuple[Stage, ...]
    choose: tuple[Stage, ...]
    advance: tuple[Stage, ...]
    tick: tuple[Stage, ...]
    start: tuple[Stage, ...]

    @property
    def step(self) -> tuple[Stage, ...]:
        """All launches of a step."""
        return (*self.look, *self.choose, *self.advance, *self.tick)


class Careful(NamedTuple):
    """The kernels that both schemes share. They work on runs, not cells, and honour NaN."""

    record: Any
    time_step: Any
    tick: Any
    start: Any


def launches(*rows: tuple[Any, ...]) -> tuple[Stage, ...]:
    """Stages, each given as a tuple; its kernel is None where a variant does without it."""
    return tuple(Stage(*row) for row in rows if row[0] is not None)
