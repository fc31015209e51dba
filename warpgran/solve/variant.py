"""The choices of a case that are compiled into its kernels, each in one row of a table."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from warpgran.case import sections
from warpgran.case.case import Case, CaseError, Problem
from warpgran.kernels.precision import Variant

SINGLE_ALPHA = 5.0
"""Largest alpha in float32: above 6 phi^alpha h of thin dilute cells is smaller than its smallest number."""


class Choice(NamedTuple):
    """One choice.

    Attributes:
        keys: The keys of the run file that decide it.
        of: What it is, from their values in this order.
    """

    keys: tuple[str, ...]
    of: Callable[..., Any]


CHOICES: dict[str, Choice] = {
    "order": Choice(("scheme.order",), int),
    "alpha_two": Choice(("scheme.alpha",), lambda alpha: alpha == 2.0),
    "lambda_zero": Choice(("scheme.lambda",), lambda weight: weight == 0.0),
    "phi_eq": Choice(
        ("rheology.phi_eq", "rheology.phi_eq_N"), lambda law, N: "f2_one" if law == "f2" and N == 1.0 else law
    ),
    "relaxation": Choice(("scheme.relaxation",), str),
    "viscosity": Choice(("scheme.viscosity",), str),
    "periodic": Choice(("scheme.left",), lambda left: left == "periodic"),
}
"""By field of Variant, which has no others but the precision."""

KEYS = tuple(dict.fromkeys(key for choice in CHOICES.values() for key in choice.keys))
"""The keys of the run file that decide what is compiled in: runs that agree in them share kernels."""


def variant_of(case: Case, precision_name: str) -> Variant:
    """What must be compiled in for a case.

    Raises:
        CaseError: The precision cannot hold its numbers.
    """
    alpha = case.scheme.alpha
    if precision_name == "float32" and alpha > SINGLE_ALPHA:
        message = f"{alpha} is out of range in float32; allowed: > 1 and <= {SINGLE_ALPHA:g}, or float64"
        raise CaseError([Problem("scheme.alpha", message)])
    values = {
        key: sections.KEYS[key].default if value is None else value for key, value in case.flat().items() if key in KEYS
    }
    chosen = {name: of(*(values[key] for key in keys)) for name, (keys, of) in CHOICES.items()}
    return Variant(**{"precision": precision_name, **chosen})
