"""Progress bars, on a terminal and where there is none."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

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


def test_without_a_terminal_there_is_no_bar() -> None:
    done = subprocess.run([sys.executable, "-c", CODE], capture_output=True, text=True, check=True)
    assert (done.stdout, done.stderr) == ("printed meanwhile\n", "")
