"""`wg.calibrate`: parameters fitted to measurements, from the screening of the prior to predictions."""

from __future__ import annotations

import os
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from warpgran.calibration import words
from warpgran.calibration.stages import STAGES, Show, Stages
from warpgran.case.calibration_section import CalibrationStudy, calibration_of
from warpgran.case.case import Case
from warpgran.errors import OptionError
from warpgran.run.options import EngineName, Options, Precision


@dataclass(frozen=True)
class Calibrated:
    """A calibration, as far as it was asked for.

    Attributes:
        stages: What each stage has found; one that was not asked for is computed when it is looked at.
        last: The last stage that was asked for.
        seconds: Wall time.
    """

    stages: Stages
    last: str
    seconds: float

    def reached(self, stage: str) -> bool:
        """Whether a stage was asked for."""
        return STAGES.index(stage) <= STAGES.index(self.last)

    @property
    def converged(self) -> bool:
        """Whether the populations of the posterior agree and hold enough effective draws; True if not asked for."""
        return not self.reached("posterior") or not words.not_converged(self.stages)

    def table(self) -> pd.DataFrame:
        """A row a parameter, in the units of the run file.

        Columns: those of its prior (prior_5, prior_95), of the best fit (fit, fit_sd) and of the posterior (mean, sd,
        q5, q50, q95, r_hat, effective), as far as it was computed.
        """
        return words.table(self.stages, self.reached)

    def told(self) -> list[str]:
        """Warnings that belong to the numbers of the table, a line each."""
        found = [*words.of_screening(self.stages)]
        if self.reached("fit"):
            found += words.of_fit(self.stages)
        if self.reached("posterior"):
            found += words.of_posterior(self.stages)
            found += words.not_converged(self.stages)
        return [*found, words.of_runs(self.stages.forward.tally, self.seconds)]

    def write(self, folder: str | os.PathLike[str] | None = None) -> list[Path]:
        """Write the netCDF file that ArviZ reads, the figures, and the page that holds everything.

        Args:
            folder: Where they go, by default where the runs are kept.

        Returns:
            Paths of the page calibration.html, of calibration.nc and of the pictures.

        Raises:
            StorageError: A file cannot be written, or something else is there.
        """
        from warpgran.calibration.page import write_figures, write_page
        from warpgran.calibration.result import write_result

        folder = self.stages.output if folder is None else Path(folder)
        pictures = write_figures(self, folder)
        write_page(self, pictures, folder / "calibration.html")
        write_result(self, folder / "calibration.nc")
        return [folder / "calibration.html", folder / "calibration.nc", *pictures]


def calibrate(
    case: Case,
    over: Mapping[str, Any],
    data: str | os.PathLike[str],
    *,
    output: str | os.PathLike[str] = "calibration",
    stage: str = "predictive",
    device: str = "cpu",
    precision: Precision = "float64",
    engine: EngineName = "warp",
    threads: int | None = None,
    **section: Any,
) -> Calibrated:
    """Fit parameters of a case to measurements.

    Args:
        case: What all experiments share.
        over: Prior distributions by dotted key, such as `{"rheology.mu1": {"low": 0.3, "high": 0.6}}`.
        data: Folder of the measurements.
        output: Folder of everything that is computed; what is there of the same input is resumed.
        stage: The last stage: screening, fit, posterior or predictive.
        device: As in `simulate`.
        precision: As in `simulate`.
        engine: As in `simulate`.
        threads: As in `simulate`.
        section: Other keys of the section `[calibration]`.

    Returns:
        The stages up to the last that was asked for.

    Raises:
        CaseError: Lists everything that is wrong with the priors and other keys.
        TableError: Lists everything that is wrong with the measurements.
        OptionError: No such stage or option.
        ResultError: No run of the screening ended cleanly, or too few.
    """
    study = calibration_of(case, {"over": over, **section})
    from warpgran.solve.device import quietly

    with quietly():
        return run_stages(study, Path(data), Path(output), Options(device, precision, engine, threads), stage)


def run_stages(
    study: CalibrationStudy,
    data: Path,
    output: Path,
    options: Options,
    stage: str,
    show: Show = lambda words, done, total: None,
) -> Calibrated:
    """Compute the stages of a calibration up to one of them, see `calibrate`."""
    if stage not in STAGES:
        raise OptionError(f"stage: {stage!r} is not known; allowed: {', '.join(STAGES)}")
    began = time.perf_counter()
    stages = Stages(study, data, output, options, show)
    for each in STAGES[: STAGES.index(stage) + 1]:
        getattr(stages, each)
    return Calibrated(stages, stage, time.perf_counter() - began)
