"""The documents that repeat what the code says: they must say the same."""

from __future__ import annotations

import re
import tomllib

import pytest
from helpers.places import DOCS, ROOT

from warpgran.case.key_tables import with_tables
from warpgran.paper.catalogue import CLAIMS

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def test_the_tables_of_keys_are_those_of_the_code() -> None:
    page = (DOCS / "run_file.md").read_text(encoding="utf-8")
    assert with_tables(page) == page, "run: python -m warpgran.case.key_tables docs/run_file.md"
    with pytest.raises(ValueError, match=r"0 tables of keys under the heading `\[grid\]`"):
        with_tables(page.replace("## `[grid]`", "## `[mesh]`"))


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
