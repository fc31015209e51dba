"""The checks by name, and the function that runs them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from difflib import get_close_matches

from warpgran.errors import OptionError
from warpgran.verification import cap, columns, convergence, dams, jumps, manufactured, properties, rest, uniform
from warpgran.verification.check import Check, CheckOptions, CheckResult, Row
from warpgran.verification.plots import style

CASES: dict[str, Check] = {
    "rest": rest.at_rest,
    "ritter": dams.ritter,
    "stoker": dams.stoker,
    "sliding": dams.sliding,
    "braked": dams.braked,
    "cap": cap.cap,
    "uniform": uniform.steady,
    "relaxation": uniform.relaxation,
    "manufactured": manufactured.manufactured,
    "riemann": jumps.riemann,
    "convergence": lambda options: convergence.convergence(device=options.device, precision=options.precision),
    "columns": lambda options: columns.columns(device=options.device, precision=options.precision),
}
DEEP: dict[str, Check] = {
    "properties": lambda options: properties.deep(),  # on the CPU, in both precisions
}
"""Checks that take minutes: run with --deep or by name."""


def chosen(names: Sequence[str], deep: bool = False) -> dict[str, Check]:
    """Cases by name, in the order of the collection: those named, or all; the long ones with `deep`.

    Raises:
        OptionError: A name is not one of a case.
    """
    known = CASES | DEEP
    for name in names:
        if name not in known:
            near = get_close_matches(name.lower(), known, n=1)
            hint = f"did you mean {near[0]}? " if near else ""
            raise OptionError(f"{name!r} is not a case; {hint}allowed: {', '.join(known)}")
    wanted = set(names) | (set(DEEP) if deep else set()) if names else set(known if deep else CASES)
    return {name: check for name, check in known.items() if name in wanted}


def run(
    checks: Mapping[str, Check], options: CheckOptions, started: Callable[[str], None] = lambda name: None
) -> dict[str, CheckResult]:
    """Run checks, one after another. One that cannot be computed does not hold.

    Args:
        checks: Checks by name.
        options: How to compute them.
        started: Called with the name of each as it starts.
    """
    outcomes = {}
    for name, check in checks.items():
        started(name)
        try:
            with style():
                outcomes[name] = check(options)
        except RuntimeError as error:  # a run that did not reach its end
            row = Row("the computation itself", float("nan"), "-", "it ends", False)
            outcomes[name] = CheckResult(name, (str(error),), (row,))
    return outcomes
