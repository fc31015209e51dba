"""Every section that a run file can have: those of a case, and those that make the file a study of many runs."""

from __future__ import annotations

from warpgran.case.calibration_section import Calibration
from warpgran.case.model import Model
from warpgran.case.sections import SECTIONS
from warpgran.case.sensitivity_section import Sensitivity
from warpgran.case.sweep_section import Sweep

ALL_SECTIONS: dict[str, type[Model]] = SECTIONS | {
    "sweep": Sweep,
    "sensitivity": Sensitivity,
    "calibration": Calibration,
}
"""The sections by name. The tables of docs/run_file.md and the JSON schema are made from them."""
