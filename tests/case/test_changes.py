"""`Case.with_`: by section as editors complete it, and by dotted key."""

from __future__ import annotations

import pydoc
from typing import Any, Literal, get_args, get_origin, get_type_hints

import pytest

import warpgran as wg
from warpgran.case import changes
from warpgran.case.sections import SECTIONS

STEEP = wg.Case(title="Steep", slope={"angle": 22.0, "gravity": 9.8}, column={"phi": 0.6})


def test_sections_and_dotted_keys_change_the_same() -> None:
    by_section = STEEP.with_(slope={"angle": 16.0}, grid={"cells": 900}, title="Less steep")
    assert by_section == STEEP.with_(**{"slope.angle": 16.0, "grid.cells": 900, "title": "Less steep"})
    assert (by_section.slope.angle, by_section.slope.gravity, by_section.column.phi) == (16.0, 9.8, 0.6)


def test_none_restores_defaults_of_a_key_and_of_a_section() -> None:
    level = STEEP.with_(slope={"angle": None}, title="Level")
    assert level.flat() == STEEP.flat() | {"title": "Level", "slope.angle": 0.0} | follows(0.0, 9.8)
    assert STEEP.with_(slope=None).slope == wg.Case().slope


def follows(angle: float, gravity: float) -> dict[str, Any]:
    return {"time.rest_speed": wg.Case(slope={"angle": angle, "gravity": gravity}).rest_speed}


def test_the_attribute_of_lambda_is_its_key_too() -> None:
    for name in ("lambda", "lambda_"):
        assert STEEP.with_(**{"scheme": {"order": 1, name: 0.5}}).scheme.lambda_ == 0.5


def test_all_mistakes_are_told_at_once() -> None:
    with pytest.raises(wg.CaseError) as caught:
        STEEP.with_(**{"slope": {"angel": 1.0}, "column": {"phi": 2.0}, "grid": 3})
    told = str(caught.value)
    assert all(key in told for key in ("slope.angel", "did you mean slope.angle", "column.phi", "grid: 3"))


@pytest.mark.parametrize("section", SECTIONS)
def test_what_editors_complete_is_what_there_is(section: str) -> None:
    model = SECTIONS[section]
    declared = get_type_hints(getattr(changes, f"{model.__name__}Changes"))
    assert list(declared) == list(model.model_fields)
    for name, hint in declared.items():
        annotation = model.model_fields[name].annotation
        kind = model.described()[model.keys()[name]].kind
        *kinds, none = get_args(hint)
        assert none is type(None)
        if get_origin(annotation) is Literal:
            assert get_args(kinds[0]) == get_args(annotation)
        elif kind is not None:
            assert kinds == [kind]


def test_a_case_shows_what_differs_from_the_defaults() -> None:
    assert repr(wg.Case()) == "<Case, all defaults>"
    assert repr(STEEP) == "<Case 'Steep': slope.angle = 22.0, slope.gravity = 9.8, column.phi = 0.6>"
    html = wg.Case(title="<b>", column={"phi": 0.6})._repr_html_()
    assert "&lt;b&gt;" in html and "<b><b>" not in html
    assert [word in html for word in ("column.phi", "0.6", "0.62", "column.height")] == [True, True, True, False]


def test_a_study_shows_what_varies_and_what_all_share() -> None:
    html = STEEP.sweep({"rheology.K": [0.0, 4.0], "column.phi": [0.55, 0.6]}, mode="zip")._repr_html_()
    assert "Steep [sweep.over.column.phi = [0.55, 0.6]], 2 runs" in html
    assert html.index("rheology.K") < html.index("slope.angle")
    assert html.count("column.phi") == 2 and "0.55, 0.6" in html
    many = STEEP.sweep({"slope.angle": {"low": 0.0, "high": 10.0}}, mode="latin", samples=50)._repr_html_()
    assert "50 values" in many


def test_help_is_about_us() -> None:
    text = pydoc.plain(pydoc.render_doc(wg.Case))
    assert all(name in text for name in ("with_(", "sweep(", "from_toml(", "initial_state(", "rheology: Friction"))
    assert "model_dump" not in text and "__pydantic" not in text
    assert len(text.splitlines()) < 220
    assert {"angle", "bed"} < set(dir(STEEP.slope)) and "model_dump" not in dir(STEEP)
