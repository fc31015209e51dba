"""Options of a computation: each reaches it from the command line, and values that are not allowed are refused."""

from __future__ import annotations

import inspect
from dataclasses import fields
from typing import Any

import pytest

import warpgran as wg
from warpgran.cli.run import run
from warpgran.run.options import DECISIVE, Options

NAMES = [field.name for field in fields(Options)]


def test_every_option_is_one_of_the_command() -> None:
    assert set(NAMES) <= set(inspect.signature(run).parameters)
    assert set(DECISIVE) <= set(NAMES)


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("precision", "float16", "precision: 'float16' is not known"),
        ("engine", "fortran", "engine: 'fortran' is not known"),
        ("threads", 0, "threads: 0 is out of range"),
        ("memory", float("nan"), "memory: nan is out of range"),
    ],
)
def test_what_is_not_allowed_is_refused(name: str, value: Any, words: str) -> None:
    with pytest.raises(wg.OptionError, match=words):
        Options(**{name: value})


@pytest.mark.parametrize("other", [{"precision": "float32"}, {"device": "cuda"}])
def test_the_reference_computes_on_the_cpu_in_float64_alone(other: dict[str, Any]) -> None:

    with pytest.raises(wg.OptionError, match="numpy computes"):
        Options(engine="numpy", **other)
