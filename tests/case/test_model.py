"""What a key is declared with reaches the JSON schema, `help` and the words of errors."""

import subprocess
import sys
from typing import Any

import pytest
from pydantic import StrictBool, StrictFloat

from warpgran.case.case import Case
from warpgran.case.defaults import FOLLOWS
from warpgran.case.model import Model, declare
from warpgran.case.sections import KEYS, SECTIONS, Column, Rheology
from warpgran.case.sweep_section import Sweep

SCHEMAS = {name: Case.model_json_schema()["$defs"][model.__name__] for name, model in SECTIONS.items()}
SCHEMAS["sweep"] = Sweep.model_json_schema()
BOUNDS = {"enum", "minimum", "exclusiveMinimum", "maximum", "exclusiveMaximum"}


class Section(Model):
    """Two keys."""

    thick: StrictFloat | None = declare(None, "thickness", "h", unit="m", display=("mm", 1e3), gt=0, le=2.5)
    """Thickness of
    a layer.
    """
    on: StrictBool = declare(True, "switch")
    """A switch."""


@pytest.mark.parametrize("section", SCHEMAS)
def test_the_json_schema_says_what_every_key_is(section: str) -> None:
    for name, schema in SCHEMAS[section]["properties"].items():
        assert schema["description"] and schema["title"], name
        assert {"unit", "symbol", "display_unit", "display_factor"} <= schema.keys(), name
        forms: list[dict[str, Any]] = [schema, *schema.get("anyOf", [])]
        if any(form.get("type") in ("number", "integer") for form in forms):
            assert "allowed" in schema or any(BOUNDS & form.keys() for form in forms), name
    assert "Attributes" not in SCHEMAS[section]["description"]


def test_a_key_is_all_that_it_was_declared_with() -> None:
    key, switch = Section.described().values()
    assert (key.name, key.symbol, key.meaning) == ("thickness", "h", "Thickness of a layer.")
    assert (key.unit, key.display_unit, key.factor) == ("m", "mm", 1e3)
    assert (key.kind, key.allowed, key.hint) == (float, "> 0 and <= 2.5", "> 0 and <= 2.5, in m")
    assert (switch.kind, switch.hint, switch.default) == (bool, "", True)
    attributes = "    thick: Thickness of a layer. Allowed: > 0 and <= 2.5, in m.\n    on: A switch."
    assert Section.__doc__ == f"Two keys.\n\nAttributes:\n{attributes}"


def test_the_docstring_of_a_section_says_units_bounds_and_what_follows_other_keys() -> None:
    assert "    start: Left end of the rectangle. Allowed: in the grid, in m. Default: `grid.left`." in str(
        Column.__doc__
    )
    assert "    phi_eq: Form of phi_eq(I)" in str(Rheology.__doc__) and '"f0", "f1" or "f2"' not in str(
        Rheology.__doc__
    )


def test_no_source_is_read_for_docstrings_until_they_are_asked_for() -> None:
    code = (
        "import warpgran.case.read_study\n"
        "from warpgran.case.case import Case\n"
        "from warpgran.case.model import meanings\n"
        "before = meanings.cache_info().currsize; Case.__doc__; print(before, meanings.cache_info().currsize > 0)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["0", "True"]


def test_keys_follow_keys_and_say_which() -> None:
    for key, (_, leaders) in FOLLOWS.items():
        assert KEYS[key].default is None
        assert KEYS[key].unset
        assert set(leaders) <= KEYS.keys()
