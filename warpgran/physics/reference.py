"""The NumPy reference of a case: a run by the scheme of its order, which the kernels are compared with."""

from __future__ import annotations

from typing import TYPE_CHECKING

from warpgran.physics.first_order import FirstOrder
from warpgran.physics.second_order import SecondOrder
from warpgran.physics.state import Run

if TYPE_CHECKING:
    from warpgran.case.case import Case

SCHEMES: dict[int, type[Run]] = {1: FirstOrder, 2: SecondOrder}
"""By their order."""


def reference(case: Case) -> Run:
    """A run of a case at its initial state."""
    return SCHEMES[case.scheme.order](case)
