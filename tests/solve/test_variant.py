"""What is compiled in: no choice of the run file can be computed with the kernels of another."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from typing import Any, Literal, get_args, get_origin, get_type_hints

import pytest
from helpers.cases import FIRST, FIRST_ALONE, small

from warpgran.case.sections import SECTIONS
from warpgran.case.study import Study
from warpgran.kernels.precision import Variant
from warpgran.solve.blocks import plan
from warpgran.solve.schedule import Outputs
from warpgran.solve.variant import CHOICES, KEYS, variant_of

NOT_COMPILED = {
    "scheme.left": "wall and open differ by a number, v_left; periodic is tested below",
    "scheme.right": "wall and open differ by a number, v_right; periodic is what the left end is",
    "scheme.window": "the window is two numbers of each run, lo and hi",
    "time.stop_at_rest": "a number, rest_speed, is negative where it is off",
}
"""Keys whose words change no kernel, and why."""


def choices() -> dict[str, tuple[Any, ...]]:
    """Every key of the run file that takes one of a few values, with these."""
    found: dict[str, tuple[Any, ...]] = {}
    for section, model in SECTIONS.items():
        for name, key in model.keys().items():
            kind = model.model_fields[name].annotation
            if get_origin(kind) is Literal or kind is bool:
                found[f"{section}.{key}"] = get_args(kind) or (False, True)
    return found


def test_what_is_listed_as_not_compiled_is_a_choice() -> None:
    assert choices().keys() >= NOT_COMPILED.keys()


@pytest.mark.parametrize("key", [key for key in choices() if key not in NOT_COMPILED])
def test_runs_that_differ_in_a_choice_get_kernels_of_their_own(key: str) -> None:
    words = choices()[key]
    study = Study(small(**FIRST) if key in FIRST_ALONE else small(), {key: words})
    outputs = Outputs.of(study[0])
    blocks = plan(study, range(len(study)), outputs, "float64", on_cpu=True, threads=1, memory=1e12)
    assert len({block.variant for block in blocks}) == len(words)
    assert {block.runs: block.variant for block in blocks} == {
        (run,): variant_of(study[run], "float64") for run in range(len(study))
    }


@pytest.mark.parametrize(
    ("changes", "field", "value"),
    [
        ({"scheme.alpha": 2.5}, "alpha_two", False),
        (FIRST | {"scheme.lambda": 0.5}, "lambda_zero", False),
        ({"rheology.phi_eq_N": 2.0}, "phi_eq", "f2"),
        ({"scheme.left": "periodic", "scheme.right": "periodic"}, "periodic", True),
    ],
)
def test_numbers_that_are_compiled_in(changes: dict[str, Any], field: str, value: Any) -> None:
    usual = variant_of(small(**FIRST) if FIRST.items() <= changes.items() else small(), "float64")
    assert variant_of(small(**changes), "float64") == replace(usual, **{field: value})
    assert any(key in KEYS for key in changes)


def test_no_two_variants_share_a_name() -> None:
    values = [get_args(kind) or (False, True) for kind in get_type_hints(Variant).values()]
    variants = [Variant(*each) for each in product(*values)]
    assert len({variant.name for variant in variants}) == len(variants)


@pytest.mark.parametrize("field", CHOICES)
def test_a_field_without_a_row_is_an_error(field: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(CHOICES, field)
    with pytest.raises(TypeError, match=f"missing 1 required positional argument: '{field}'"):
        variant_of(small(), "float64")
