"""The ways in which the run files are computed: by either scheme, in the paper's own form, on finer cells."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from warpgran.case.case import Case
from warpgran.case.sections import KEYS
from warpgran.errors import OptionError

PRECURSOR = 1e-5  # m, of the layer that the paper's viscosity needs
AS_GIVEN: dict[str, Any] = {"scheme.order": 2, "scheme.start": 0} | {
    key: None for key, known in KEYS.items() if known.order == 1
}
"""Order 2 on the cells of the run file from the first moment, without the keys that order 1 alone has."""
ORDER_2 = AS_GIVEN | {"scheme.h_min": None}
"""The same with its own least thickness, whatever a run file of order 1 sets."""


@dataclass(frozen=True)
class Setting:
    """How the cases of a run file are changed.

    Attributes:
        name: Name of its column in claims.csv, and of its folder.
        words: Description.
        changes: Values by dotted key, None to take a key out.
        as_paper: With the paper's viscosity (3.20) over a precursor layer.
        refinement: How many times the cells of the run file.
        base: Name of the setting that it changes or refines; none for one that stands for itself.
    """

    name: str
    words: str
    changes: dict[str, Any] = field(default_factory=dict)
    as_paper: bool = False
    refinement: int = 1
    base: str = ""

    def apply(self, case: Case) -> Case:
        """The case, changed.

        Without dilatancy (K = 0) the paper's viscosity moves phi out of (0, 1] in the second step wherever its third
        coefficient differs from the first, while phi is to stay as it was. With one coefficient for both it is our
        bounded form: that is what such a case gets.
        """
        changes = dict(self.changes)
        if self.as_paper:
            changes["scheme.h_bed"] = PRECURSOR
            changes["scheme.viscosity"] = "paper" if case.rheology.K > 0 else "bounded"
        if self.refinement > 1:
            changes["grid.cells"] = self.refinement * case.grid.cells
        return case.with_(**changes) if changes else case


DEFAULTS = Setting("defaults", "the run files as they are: order 1, bounded viscosity, dry bed")
AS_PAPER = Setting(
    "paper_form", "as the paper has it: order 1, its viscosity (3.20), a precursor layer of 0.01 mm", as_paper=True
)
SECOND_ORDER = Setting("order_2", "order 2 with its own defaults, dry bed", ORDER_2)
SETTINGS = (
    DEFAULTS,
    AS_PAPER,
    SECOND_ORDER,
    Setting("defaults_2x", "the run files with twice the cells", refinement=2, base="defaults"),
    Setting("defaults_4x", "the run files with four times the cells", refinement=4, base="defaults"),
    Setting(
        "paper_form_2x", "as the paper has it, with twice the cells", as_paper=True, refinement=2, base="paper_form"
    ),
    Setting(
        "phi_stat_585",
        "the run files with phi_stat = 0.585, as section 4.1 says",
        {"rheology.phi_stat": 0.585},
        base="defaults",
    ),
    Setting("order_2_grain", "order 2 with h_min of one grain, as order 1 has it", AS_GIVEN, base="order_2"),
    Setting("order_2_2x", "order 2 with twice the cells", ORDER_2, refinement=2, base="order_2"),
)


def setting_named(name: str) -> Setting:
    """A setting by its name.

    Raises:
        OptionError: There is none such; the message says which there are.
    """
    for setting in SETTINGS:
        if setting.name == name:
            return setting
    allowed = ", ".join(setting.name for setting in SETTINGS)
    raise OptionError(f"setting: {name!r} is not known; allowed: {allowed}")
