"""The JSON schema that ships: current, kept by every run file, broken by every kind of mistake."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest
from helpers.places import DOCS, ROOT
from jsonschema import Draft202012Validator

from warpgran.case.all_sections import ALL_SECTIONS
from warpgran.case.json_schema import SHIPPED, text
from warpgran.case.sections import SECTIONS

SCHEMA = json.loads(text())
RUNS = sorted((ROOT / "runs").rglob("*.toml"))
MISTAKES = {
    "a misspelt key": "grid.cell = 3",
    "a misspelt section": "[slop]\nangle = 1.0",
    "out of range": "column.phi = 1.5",
    "not one of the words": 'rheology.phi_eq = "f7"',
    "a word for a number": 'slope.angle = "steep"',
    "a misspelt key of a list": "time.series = { evry = 0.1 }",
    "a misspelt swept key": '[sweep.over]\n"slope.angel" = [1, 2]',
    "out of range in a sweep": '[sweep.over]\n"column.phi" = [0.6, 2.0]',
    "out of range in a nested sweep": "[sweep.over]\ncolumn.phi = [0.6, 2.0]",
    "not one of the modes": '[sweep]\nmode = "random"\n[sweep.over]\nslope.angle = [1]',
    "a misspelt key of a distribution": '[sensitivity.over]\n"slope.angle" = { lo = 1.0, high = 2.0 }',
    "a misspelt key of a prior": '[calibration.over]\n"slope.angle" = { lo = 1.0, high = 2.0 }',
    "a misspelt fitted key": '[calibration.over]\n"rheology.k" = { low = 1.0, high = 2.0 }',
    "a sensitivity over nothing": '[sensitivity]\nmethod = "morris"',
}
TOOLS = {
    "tombi": ["lint", "--offline"],
    "check-jsonschema": ["--schemafile", str(SHIPPED)],
}


def errors(data: dict[str, Any]) -> list[str]:
    return [error.message for error in Draft202012Validator(SCHEMA).iter_errors(data)]


def test_the_file_that_ships_is_current() -> None:
    # As data: an older pydantic writes 0.0 for 0.
    shipped = json.loads(SHIPPED.read_text(encoding="utf-8"))
    assert shipped == SCHEMA, "run: python -m warpgran.case.json_schema"
    Draft202012Validator.check_schema(SCHEMA)


def test_every_section_of_the_documents_has_its_part() -> None:
    headings = re.findall(r"(?m)^## `\[(\w+)\]`$", (DOCS / "run_file.md").read_text(encoding="utf-8"))
    assert set(headings) == set(ALL_SECTIONS)
    assert set(SCHEMA["properties"]) == {"title", *ALL_SECTIONS}


def test_every_section_that_a_file_of_the_room_declares_has_its_part() -> None:
    sources = [path.read_text(encoding="utf-8") for path in (ROOT / "warpgran" / "case").glob("*_section.py")]
    assert len(sources) >= 3
    declared = {name for source in sources for name in re.findall(r'"""The `\[(\w+)\]` section: ', source)}
    assert declared == ALL_SECTIONS.keys() - SECTIONS.keys()


@pytest.mark.parametrize("section", ALL_SECTIONS)
def test_every_key_says_what_it_means_and_what_is_allowed(section: str) -> None:
    for name, known in ALL_SECTIONS[section].described().items():
        key = SCHEMA["properties"][section]["properties"][name]
        assert key["description"].startswith(known.meaning) and known.hint in key["description"]
        assert known.unset in key["description"]
        assert key.get("unit", "") == known.unit
    assert '"null"' not in json.dumps(SCHEMA["properties"][section])  # TOML has none


@pytest.mark.parametrize("path", RUNS, ids=lambda path: path.stem)
def test_run_files_keep_it_and_name_it(path: Path) -> None:
    source = path.read_text(encoding="utf-8")
    assert errors(tomllib.loads(source)) == []
    first = source.partition("\n")[0]
    assert first.startswith("#:schema ")
    assert (path.parent / first.removeprefix("#:schema ")).resolve() == SHIPPED.resolve()


@pytest.mark.parametrize("mistake", MISTAKES)
def test_mistakes_break_it(mistake: str) -> None:
    assert errors(tomllib.loads(MISTAKES[mistake])) != []


@pytest.mark.slow
@pytest.mark.parametrize("tool", TOOLS)
def test_so_say_the_tools_of_editors_and_hooks(tool: str, tmp_path: Path) -> None:
    command = shutil.which(tool, path=str(Path(sys.executable).parent))
    if command is None:
        pytest.skip(f"{tool} is not installed: pip install -e '.[dev]'")

    def accepts(*paths: Path) -> bool:
        done = subprocess.run([command, *TOOLS[tool], *paths], capture_output=True, text=True, check=False)
        return done.returncode == 0

    assert accepts(*RUNS)
    for mistake in ("a misspelt key", "out of range", "not one of the words"):
        path = tmp_path / "mistaken.toml"
        path.write_text(f"#:schema {SHIPPED}\n{MISTAKES[mistake]}\n")
        assert not accepts(path), mistake
