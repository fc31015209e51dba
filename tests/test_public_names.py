"""`import warpgran as wg`: what type checkers see of it is what there is at run time."""

import ast
import inspect
import re

import pytest
from helpers.places import ROOT

import warpgran as wg


def test_names_for_type_checkers_are_those_of_dir() -> None:
    tree = ast.parse((ROOT / "warpgran" / "__init__.py").read_text(encoding="utf-8"))
    [typing] = [node for node in tree.body if isinstance(node, ast.If)]
    homes = {
        alias.name: node.module for node in typing.body if isinstance(node, ast.ImportFrom) for alias in node.names
    }
    assert dir(wg) == sorted(homes)
    for name, home in homes.items():
        assert getattr(wg, name).__module__ == home
        assert inspect.getdoc(getattr(wg, name))


def test_every_error_of_the_package_is_public() -> None:
    files = [path.read_text(encoding="utf-8") for path in (ROOT / "warpgran").rglob("*.py")]
    errors = {name for text in files for name in re.findall(r"^class (\w+)\(WarpgranError", text, re.MULTILINE)}
    assert "CaseError" in errors
    assert errors <= set(dir(wg))


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="module 'warpgran' has no attribute 'simulat'"):
        wg.simulat  # noqa: B018
