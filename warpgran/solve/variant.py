"""The choices of a case that are compiled into its kernels."""

from __future__ import annotations

from warpgran.case.case import Case, CaseError, Problem
from warpgran.kernels.precision import Variant

SINGLE_ALPHA = 5.0
"""Largest alpha in float32: above 6 phi^alpha h of thin dilute cells is smaller than its smallest number."""


def variant_of(case: Case, precision_name: str) -> Variant:
    """What must be compiled in for a case.

    Raises:
        CaseError: The precision cannot hold its numbers.
    """
    r, scheme = case.rheology, case.scheme
    if precision_name == "float32" and scheme.alpha > SINGLE_ALPHA:
        message = f"{scheme.alpha} is out of range in float32; allowed: > 1 and <= {SINGLE_ALPHA:g}, or float64"
        raise CaseError([Problem("scheme.alpha", message)])
    return Variant(
        precision=precision_name,
        alpha_two=scheme.alpha == 2.0,
        lambda_zero=scheme.lambda_ == 0.0,
        phi_eq="f2_one" if r.phi_eq == "f2" and r.phi_eq_N == 1.0 else r.phi_eq,
        relaxation=scheme.relaxation,
        viscosity=scheme.viscosity,
        periodic=scheme.periodic,
    )
