"""Sweeps that several tests use, and what helps to make and to look at them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from warpgran.case.case import Case, CaseError
from warpgran.case.study import Study

ANGLE_AND_PHI = {"slope.angle": [0, 10, 22], "column.phi": [0.55, 0.62]}
FREE = {"rheology.K": {"low": 0.0, "high": 8.0}, "grid.cells": {"low": 100, "high": 400}}


def write(folder: Path, text: str, samples: str | None = None) -> Path:
    """A run file of this text, with the table samples.csv beside it."""
    (folder / "a.toml").write_text(text, encoding="utf-8")
    if samples is not None:
        (folder / "samples.csv").write_text(samples, encoding="utf-8")
    return folder / "a.toml"


def refused(over: Any, **options: Any) -> dict[str, str]:
    """Messages by key of a sweep that must fail; each key at most once."""
    with pytest.raises(CaseError) as caught:
        Case().sweep(over, **options)
    return messages(caught.value)


def messages(error: CaseError) -> dict[str, str]:
    """Messages by key; each key at most once."""
    found = {problem.key: problem.message for problem in error.problems}
    assert len(found) == len(error.problems)
    return found


def table(study: Study) -> list[tuple[Any, ...]]:
    """The swept values, a tuple a run."""
    return list(zip(*(study.values(key) for key in study.keys), strict=True))
