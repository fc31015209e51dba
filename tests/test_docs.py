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
from warpgran.paper.catalogue import CLAIMS
from warpgran.paper.remarks import OURS

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


def test_links_lead_to_files() -> None:
    links = list(found(r"\]\((?!http)([^)#]+)[^)]*\)", DOCUMENTS))
    assert len(links) > 20
    assert [(file, link) for file, link in links if not (ROOT / file).parent.joinpath(link).exists()] == []


def headings(path: Path) -> set[str]:
    """Anchors of a page's headings, as GitHub and MyST make them."""
    titles = re.findall(r"^#+ (.+)$", path.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


def test_links_lead_to_headings() -> None:
    links = [(file, *link.split("#")) for file, link in found(r"\]\((?!http)([^)#]*#[^)]+)\)", DOCUMENTS)]
    assert len(links) > 5
    pages = [(ROOT / file).parent / page if page else ROOT / file for file, page, _ in links]
    assert [link for link, page in zip(links, pages, strict=True) if link[2] not in headings(page)] == []


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
