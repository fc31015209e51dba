"""The checks by name, and the function that runs them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from difflib import get_close_matches

from matplotlib.figure import Figure

from warpgran.errors import OptionError
from warpgran.verification import (
    cap,
    columns,
    convergence,
    dams,
    energy,
    jumps,
    manufactured,
    properties,
    rest,
    uniform,
    waves,
)
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
    "waves": waves.waves,
    "riemann": jumps.riemann,
    "energy": energy.energy,
    "convergence": convergence.convergence,
    "columns": columns.columns,
}
ORDERS = (1, 2)
"""Values of `scheme.order`."""
DEEP: dict[str, Check] = {
    "properties": properties.deep,  # on the CPU, in both precisions
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
    checks: Mapping[str, Check],
    options: CheckOptions,
    orders: Sequence[int] = ORDERS,
    started: Callable[[str], None] = lambda name: None,
) -> dict[str, CheckResult]:
    """Run checks, one after another, each under every order. One that cannot be computed does not hold.

    Args:
        checks: Checks by name.
        options: How to compute them; its order has no part.
        orders: Values of `scheme.order`.
        started: Called with the name of each as it starts.
    """
    outcomes = {}
    for name, check in checks.items():
        started(name)
        outcomes[name] = side_by_side({n: _computed(name, check, replace(options, order=n)) for n in orders})
    return outcomes


def _computed(name: str, check: Check, options: CheckOptions) -> CheckResult:
    try:
        with style():
            return _to_rounding(check(options), options)
    except RuntimeError as error:  # a run that did not reach its end
        row = Row("the computation itself", float("nan"), "-", "it ends", False)
        return CheckResult(name, (str(error),), (row,))


SINGLE = 1e-4
"""An error of float32 at which rounding takes the place of the order of the scheme of order 2."""


def _to_rounding(result: CheckResult, options: CheckOptions) -> CheckResult:
    if options.precision == "float64" or options.order == 1:
        return result
    rows = tuple(
        replace(row, bound=f"{row.bound}; in float32 or error <= {SINGLE:g}", holds=row.holds or row.error <= SINGLE)
        if row.errors and row.holds is not None
        else row
        for row in result.rows
    )
    return replace(result, rows=rows)


def side_by_side(results: Mapping[int, CheckResult]) -> CheckResult:
    """Results of one check under several orders as one: rows that compare the same follow one another."""
    rows = [replace(row, scheme=order) for order, result in results.items() for row in result.rows]
    places = {compared: n for n, compared in enumerate(dict.fromkeys(row.compared for row in rows))}
    rows.sort(key=lambda row: places[row.compared])  # stable: by order within
    figures: dict[str, Figure] = {}
    run_files: dict[str, str] = {}
    for order, result in results.items():
        for name, figure in result.figures.items():
            figure.set_label(f"Order {order}. {figure.get_label()}")
            figures[f"{name}_order_{order}"] = figure
        run_files |= {f"order_{order}_{name}": text for name, text in result.run_files.items()}
    text = dict.fromkeys(paragraph for result in results.values() for paragraph in result.text)
    title = next(iter(results.values())).title
    return CheckResult(title, tuple(text), tuple(rows), figures, run_files)
