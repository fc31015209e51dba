"""The documents that repeat what the code says: they must say the same."""

from __future__ import annotations

import re
import tomllib
from typing import Any

from helpers.places import ROOT

from warpgran.case.case import Case
from warpgran.case.sections import ALLOWED, SECTIONS, Model
from warpgran.case.sweep_section import Sweep
from warpgran.case.toml import plain
from warpgran.paper.catalogue import CLAIMS

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def rows_of_keys() -> dict[str, list[str]]:
    """Default, allowed and unit as docs/run_file.md has them, by dotted key."""
    rows: dict[str, list[str]] = {}
    section = ""
    for line in (ROOT / "docs" / "run_file.md").read_text(encoding="utf-8").splitlines():
        if line.startswith("## "):
            name = re.fullmatch(r"## `\[(\w+)\]`", line)
            section = f"{name[1]}." if name else ""
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if line.startswith("| `") and len(cells) == 5:
            key = section + cells[0].strip("`")
            assert key not in rows
            rows[key] = cells[1:4]
    return rows


def defaults() -> dict[str, Any]:
    """The models' defaults by dotted key; None for one that follows another key."""
    values: dict[str, Any] = {"title": Case().title}
    sections: dict[str, type[Model]] = {**SECTIONS, "sweep": Sweep}
    for section, model in sections.items():
        for name, key in model.keys().items():
            values[f"{section}.{key}"] = plain(model.model_fields[name].default)
    return values


def literal(cell: str) -> Any:
    """The value that a cell shows, None where it is in words."""
    try:
        return tomllib.loads(f"value = {cell.strip('`')}")["value"]
    except tomllib.TOMLDecodeError:
        return None


def test_every_key_is_documented_with_its_default() -> None:
    assert {key: literal(default) for key, (default, _, _) in rows_of_keys().items()} == defaults()


def test_what_is_allowed_is_what_the_errors_say() -> None:
    rows = rows_of_keys()
    words = ALLOWED | Sweep.allowed()
    for key in defaults():
        if words[key]:
            _, allowed, unit = rows[key]
            assert words[key] == (f"{allowed}, in {unit}" if unit else allowed)


def test_every_claim_of_the_paper_is_in_the_table() -> None:
    lines = (ROOT / "docs" / "paper.md").read_text(encoding="utf-8").splitlines()
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if line.startswith("|")]
    told = [row[1] for row in rows if len(row) == 7][2:]
    assert told == [f"{claim.says} [{claim.paper}]" if claim.paper else claim.says for claim in CLAIMS]


def test_every_dependency_is_explained() -> None:
    text = (ROOT / "docs" / "dependencies.md").read_text(encoding="utf-8")
    extras = [name for names in PROJECT["optional-dependencies"].values() for name in names]
    names = {re.split(r"[\[<>=~!; ]", entry)[0] for entry in PROJECT["dependencies"] + extras} - {PROJECT["name"]}
    assert set(re.findall(r"^\| ([a-z0-9-]+) \|", text, re.MULTILINE)) == names


def test_the_citation_is_of_this_version() -> None:
    lines = (ROOT / "CITATION.cff").read_text(encoding="utf-8").splitlines()
    assert f"version: {PROJECT['version']}" in lines
    assert f"license: {PROJECT['license']}" in lines
