"""`warpgran new` and `warpgran schema`."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

import warpgran as wg
from warpgran.case.json_schema import SHIPPED
from warpgran.case.sections import KEYS
from warpgran.cli.app import app


def warpgran(*arguments: str) -> Result:
    return CliRunner().invoke(app, arguments)


@pytest.mark.parametrize("full", [(), ("--full",)])
def test_a_new_file_is_the_case_of_the_defaults(tmp_path: Path, full: tuple[str, ...]) -> None:
    path = tmp_path / "mine.toml"
    result = warpgran("new", str(path), *full)
    assert result.exit_code == 0, result.output
    assert str(path) in result.stdout
    case = wg.Case.from_toml(path)
    assert case == wg.Case(title="mine")
    source = path.read_text()
    assert source == "".join(f"{line.rstrip()}\n" for line in source.splitlines())
    # With every key told in the words of its declaration, however they are wrapped.
    words = " ".join(source.replace("\n#", " ").split())
    told = [key for key, known in KEYS.items() if " ".join(known.meaning.split()) in words]
    named = [key for key in told if re.search(rf"(?m)^(?:# )?{key.partition('.')[2]} =", source)]
    assert len(told) == len(named) == (len(KEYS) if full else 9)


def test_a_file_that_is_there_stays(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text("title = 'mine'")
    result = warpgran("new", str(path))
    assert result.exit_code == 2
    assert result.stderr == f"warpgran: {path} is there already, and is left as it is; name another file\n"
    assert path.read_text() == "title = 'mine'"


def test_the_schema_is_printed_as_it_ships() -> None:
    assert warpgran("schema").stdout == SHIPPED.read_text(encoding="utf-8")
