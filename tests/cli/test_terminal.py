"""Progress bars, on a terminal and where there is none."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from helpers.places import ROOT
from typer.testing import CliRunner

from warpgran.cli.app import app

CODE = """
from warpgran.cli.terminal import progress_bar
with progress_bar() as show:
    show(1, 2, "half of it")
    print("printed meanwhile")
"""


@pytest.mark.skipif(os.name != "posix", reason="opens a pseudo-terminal")
def test_a_bar_keeps_to_the_terminal() -> None:
    keyboard, screen = os.openpty()
    done = subprocess.run([sys.executable, "-c", CODE], stdout=subprocess.PIPE, stderr=screen, text=True, check=True)
    os.close(screen)
    assert done.stdout == "printed meanwhile\n"
    assert b"half of it" in os.read(keyboard, 65_536)
    os.close(keyboard)


@pytest.mark.skipif(os.name != "posix", reason="opens a pseudo-terminal")
def test_a_long_title_leaves_room_for_the_bar_and_the_amount() -> None:
    keyboard, screen = os.openpty()
    code = CODE.replace("half of it", "Slope and packing of a column, and much more of it " * 3)
    narrow = {**os.environ, "COLUMNS": "80", "TERM": "xterm"}
    subprocess.run([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=screen, env=narrow, check=True)
    os.close(screen)
    shown = os.read(keyboard, 65_536)
    assert b"1 of 2 runs" in shown and shown.count("\u2501".encode()) > 10
    os.close(keyboard)


def test_without_a_terminal_there_is_no_bar() -> None:
    done = subprocess.run([sys.executable, "-c", CODE], capture_output=True, text=True, check=True)
    assert (done.stdout, done.stderr) == ("printed meanwhile\n", "")


TABLE = """
from rich.table import Table
from warpgran.cli.terminal import print_whole
table = Table(*("a heading" for _ in range(20)))
table.add_row(*("-1.234567890" for _ in range(20)))
print_whole(table)
"""


@pytest.mark.skipif(os.name != "posix", reason="opens a pseudo-terminal")
def test_a_narrow_terminal_cuts_no_number() -> None:
    keyboard, screen = os.openpty()
    for out in (screen, subprocess.PIPE):
        narrow = {**os.environ, "COLUMNS": "60", "TERM": "xterm"}
        done = subprocess.run([sys.executable, "-c", TABLE], stdout=out, env=narrow, check=True)
        printed = (done.stdout or os.read(keyboard, 65_536)).decode()
        assert printed.count("-1.234567890") == 20
        assert "\u2026" not in printed
    os.close(screen)
    os.close(keyboard)


TITLE = 'title = "\\u001b[31m[/red] :smile: $x_{\\u0007 \\u009b2J"\n'


@pytest.mark.slow
def test_a_title_cannot_steer_the_terminal_or_break_a_picture(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.toml").write_text(TITLE + "[time]\nend = 0.05\n[grid]\ncells = 400\n")
    for command in ("check", "run", "summary", "plot", "converge"):
        result = CliRunner().invoke(app, [command, "a.h5" if command in ("summary", "plot") else "a.toml"])
        assert result.exit_code == 0, result.output
        assert all(character.isprintable() or character == "\n" for character in result.output)
        assert r"\x1b[31m[/red] :smile: $x_{\x07 \x9b2J" in result.output or command in ("summary", "plot")


def test_the_command_line_writes_in_one_place() -> None:
    for path in (ROOT / "warpgran" / "cli").glob("*.py"):
        if path.name != "terminal.py":
            assert not re.search(r"typer\.echo\(|(?<![._])print\(|\bclick\.echo\(", path.read_text()), path.name
