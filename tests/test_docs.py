"""What documents and docstrings say of the code: the same as the code says, and of things that are there."""

from __future__ import annotations

import json
import re
import runpy
import tomllib
from collections.abc import Iterator
from pathlib import Path
from pkgutil import resolve_name
from xml.etree import ElementTree

import pytest
from helpers.places import DOCS, ROOT, TESTS
from helpers.rooms import arrows

import warpgran as wg
from warpgran.case.key_tables import with_tables
from warpgran.cli.table import MARKS, rich_table
from warpgran.paper.catalogue import CLAIMS
from warpgran.paper.remarks import OURS
from warpgran.schema import Status

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]

FOLDERS = ("warpgran", "kernels", "tests", "benchmarks", "docs", "runs")
DOCUMENTS = [
    *ROOT.glob("*.md"),
    *(path for path in DOCS.rglob("*.md") if "made" not in path.parts),
    ROOT / "benchmarks" / "README.md",
]
SOURCES = [path for folder in FOLDERS for path in (ROOT / folder).rglob("*.py")]


def found(pattern: str, paths: list[Path]) -> Iterator[tuple[str, str]]:
    """Each match of a pattern, with the name of the file that it is in."""
    for path in paths:
        for match in re.findall(pattern, path.read_text(encoding="utf-8")):
            yield path.relative_to(ROOT).as_posix(), match


def linked(path: Path) -> list[tuple[str, str, str]]:
    """Words, file and anchor of each link of a document to a place in the repository."""
    return re.findall(r"\[([^\]]*)\]\((?!https?:)([^)#\s]*)#?([^)\s]*)\)", prose(path))


def prose(path: Path) -> str:
    """A document without its blocks of code."""
    return re.sub(r"^```.*?^```$|^    [^\n]*$", "", path.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)


def anchors(path: Path) -> set[str]:
    """Anchors of a page's headings, as GitHub and MyST make them: of equal ones all but the first are numbered."""
    titles = re.findall(r"^#+ (.+)$", prose(path), re.MULTILINE)
    made: list[str] = []
    for title in titles:
        plain = re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-")
        made.append(f"{plain}-{titles[: len(made)].count(title)}" if title in titles[: len(made)] else plain)
    return set(made)


def unsound(document: Path) -> list[str]:
    """Links of a document that show no words, or lead to no file or heading."""
    found = []
    for words, file, anchor in linked(document):
        target = document.parent / file if file else document
        if not (words.strip() and target.exists() and (not anchor or anchor in anchors(target))):
            found.append(f"{document.name}: [{words}]({file}#{anchor})")
    return found


def test_links_lead_to_files_and_headings() -> None:
    assert sum(len(linked(document)) for document in DOCUMENTS) > 50
    assert [link for document in DOCUMENTS for link in unsound(document)] == []


def test_broken_links_are_found(tmp_path: Path) -> None:
    (tmp_path / "a.md").write_text("# A\n\n# A\n\n    # B\n\n[1](b.md#c), [2](#a-1), [3](#b), [4](c.md), [](b.md)\n")
    (tmp_path / "b.md").write_text("# C\n```\n# D\n[5](c.md)\n```\n[6](#d)\n")
    assert unsound(tmp_path / "a.md") == ["a.md: [3](#b)", "a.md: [4](c.md#)", "a.md: [](b.md#)"]
    assert unsound(tmp_path / "b.md") == ["b.md: [6](#d)"]


def test_broken_links_of_the_site_are_found(tmp_path: Path) -> None:
    broken = runpy.run_path(str(DOCS / "broken_links.py"))["broken"]
    links = (
        "b.html#c",
        "#",
        "b.html#d",
        "c.png",
        "https://python.org",
        "http://python.org",
        "data:,",
        "//cdn.org/x.js",
    )
    (tmp_path / "a.html").write_text("".join(f'<a href="{link}">' for link in links))
    (tmp_path / "b.html").write_text('<p id="c"><img src="d%20e.png">')
    (tmp_path / "d e.png").write_bytes(b"")
    assert broken(tmp_path) == [
        f"a.html: {link}" for link in ("b.html#d", "c.png", "http://python.org", "//cdn.org/x.js")
    ]


def test_files_that_are_named_are_there() -> None:
    paths = list(found(rf"(?<![\w/.*])((?:{'|'.join(FOLDERS)})/[\w/.]*\w)(?![\w*{{])", DOCUMENTS + SOURCES))
    assert len(paths) > 20
    assert [(file, path) for file, path in paths if not (ROOT / path).exists()] == []


def test_public_names_are_there() -> None:
    names = list(found(r"\bwg\.([a-zA-Z_]\w+)", DOCUMENTS + [path for path in SOURCES if TESTS not in path.parents]))
    assert len(names) > 20
    assert [(file, name) for file, name in names if not hasattr(wg, name)] == []


def test_public_names_have_their_place_on_the_page() -> None:
    page = (DOCS / "reference" / "python.md").read_text(encoding="utf-8")
    described = re.findall(r"^\.\. auto(?:class|function|exception):: (\w+)$", page, re.MULTILINE)
    assert set(wg.__all__) - set(described) == set()


def test_every_word_of_the_printed_table_is_a_term_of_the_site() -> None:
    page = (DOCS / "reference" / "printed_table.md").read_text(encoding="utf-8")
    (glossary,) = re.findall(r"^```\{glossary\}\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
    terms = set(re.findall(r"^(\S.*)$", glossary, re.MULTILINE))
    table = rich_table(wg.summary(wg.simulate(wg.Case(grid={"right": 0.2, "cells": 40}, time={"end": 0.1}))))
    headings = {str(column.header).splitlines()[0].strip() for column in table.columns}
    statuses = {status.word for status in Status}
    assert len(headings) > 8 and (headings | statuses) - terms == set()
    notes = [note for _, note in MARKS.values()]
    assert [note for note in notes if not any(note.startswith(term) for term in terms)] == []


def test_modules_that_are_named_are_there() -> None:
    names = list(found(r"(?<![\w/.])(warpgran(?:\.[a-z]\w*)+)\b(?!/)", DOCUMENTS))
    assert ("benchmarks/README.md", "warpgran.solve.blocks.plan") in names
    for _, name in names:
        resolve_name(name)


def test_the_rooms_are_drawn_as_they_are() -> None:
    script = runpy.run_path(str(DOCS / "draw_rooms.py"))
    texts = [
        element.text for element in ElementTree.parse(script["PICTURE"]).iter() if element.tag.endswith("}description")
    ]
    assert [json.loads(text or "") for text in texts] == [script["shown"]()], "run: python docs/draw_rooms.py"


def test_the_architecture_names_what_is_there() -> None:
    page = (DOCS / "architecture.md").read_text(encoding="utf-8")
    files = re.findall(r"`([\w/]+\.py)`", page)
    names = re.findall(rf"`((?:{'|'.join(room for room in arrows() if room != 'schema')})(?:\.\w+)+)`", page)
    assert len(files) > 20 and len(names) > 20
    assert [file for file in files if not ((ROOT / file).exists() or (ROOT / "warpgran" / file).exists())] == []
    for name in names:
        resolve_name(f"warpgran.{name}")


def test_the_tables_of_keys_are_those_of_the_code() -> None:
    page = (DOCS / "run_file.md").read_text(encoding="utf-8")
    assert with_tables(page) == page, "run: python -m warpgran.case.key_tables docs/run_file.md"
    with pytest.raises(ValueError, match=r"0 tables of keys under the heading `\[grid\]`"):
        with_tables(page.replace("## `[grid]`", "## `[mesh]`"))


def test_every_claim_of_the_paper_is_in_the_table() -> None:
    lines = (ROOT / "docs" / "paper.md").read_text(encoding="utf-8").splitlines()
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if line.startswith("|")]
    told = [row[1] for row in rows if len(row) == 9][2:]
    assert told == [f"{claim.says} [{claim.paper}]" if claim.paper else claim.says for claim in CLAIMS]
    assert [row[0].endswith("†") for row in rows if len(row) == 9][2:] == [claim.name in OURS for claim in CLAIMS]


def test_every_dependency_is_explained() -> None:
    text = (ROOT / "docs" / "dependencies.md").read_text(encoding="utf-8")
    extras = [name for names in PROJECT["optional-dependencies"].values() for name in names]
    names = {re.split(r"[\[<>=~!; ]", entry)[0] for entry in PROJECT["dependencies"] + extras} - {PROJECT["name"]}
    assert set(re.findall(r"^\| ([a-z0-9-]+) \|", text, re.MULTILINE)) == names


def test_the_citation_is_of_this_version() -> None:
    lines = (ROOT / "CITATION.cff").read_text(encoding="utf-8").splitlines()
    assert f"version: {PROJECT['version']}" in lines
    assert f"license: {PROJECT['license']}" in lines
