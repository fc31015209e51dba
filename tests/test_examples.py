"""The examples of the documents and docstrings do what they show, on coarse grids, in a folder of their own."""

from __future__ import annotations

import ast
import os
import re
import shlex
from collections.abc import Iterator
from glob import glob
from pathlib import Path
from shutil import copyfile, copytree
from textwrap import dedent
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pytest
import xarray
from helpers.places import DOCS, ROOT, RUNS
from typer.main import get_group
from typer.testing import CliRunner

import warpgran as wg
from warpgran.cli.app import app

DOCUMENTS = [ROOT / "README.md", *sorted(path for path in DOCS.rglob("*.md") if "made" not in path.parts)]
SUITE = [*(ROOT / "warpgran").rglob("*.py"), *(ROOT / "kernels").rglob("*.py")]
SLOW = ("calibrate", "reproduce", "verify")
ELSEWHERE = ("cuda", "tcp://", "sensitivity.samples=")
"""Arguments of commands that need another machine or thousands of runs; these and the slow ones are parsed, not run."""
OWN_DATA = DOCS / "how_to" / "own_data.md"
MEASURED: dict[str, Any] = {
    "x": np.linspace(-0.2, 1.4, 9), "b": np.linspace(0.1, 0, 9), "h": np.linspace(0.12, 0, 9), "phi": np.full(9, 0.6)
}  # fmt: skip
"""What the page on one's own data has from elsewhere."""
LANGUAGES = (DOCS / "how_to" / "snakemake.md",)
"""Documents whose blocks are of languages that look like Python."""
BATCH = {"SLURM_ARRAY_TASK_ID": "3", "SLURM_CPUS_PER_TASK": "2"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """The working folder: the run files of the checkout on coarse grids, their sweeps of few runs."""
    path = tmp_path_factory.mktemp("examples")
    (path / "runs").mkdir()
    for file in RUNS.glob("*.toml"):
        text = re.sub(r"^cells = \d+", "cells = 60", file.read_text(encoding="utf-8"), flags=re.MULTILINE)
        text = re.sub(r"^samples = \d+", "samples = 32", text, flags=re.MULTILINE)
        (path / "runs" / file.name).write_text(text, encoding="utf-8")
    copytree(RUNS / "calibrate_two_slopes", path / "runs" / "calibrate_two_slopes")
    (path / "sweep.toml").write_text((path / "runs" / "sweep_latin.toml").read_text(encoding="utf-8"), encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(path)
        for name, value in BATCH.items():
            patch.setenv(name, value)
        for name, *copies in (("dense_22deg", "a", "before"), ("loose_22deg", "b", "after", "out")):
            invoke("run", f"runs/{name}.toml", "--no-picture")
            for copied in copies:
                copyfile(f"{name}.h5", f"{copied}.h5")
        (block,) = re.findall(r"^```toml\n(.*?)^```", OWN_DATA.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
        for name, text in (("flume", block), ("study", Path("sweep.toml").read_text(encoding="utf-8"))):
            Path(f"{name}.toml").write_text(text, encoding="utf-8")
        yield path


def invoke(*arguments: str, allowed: tuple[int, ...] = (0,)) -> None:
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code in allowed, f"warpgran {shlex.join(arguments)}\n{result.output}{result.exception}"


def python_blocks(path: Path) -> list[str]:
    """The blocks of Python in a document, one after the other, or the example of a docstring."""
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".md":
        blocks = re.findall(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
        return ["".join(blocks)] if blocks and path not in LANGUAGES else []
    strings = [ast.get_docstring(node) or "" for node in ast.walk(ast.parse(text))
               if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef)]  # fmt: skip
    block = re.compile(r"^( *)import warpgran[^\n]*(?:\n(?:\1[^\n]*)?)*", re.MULTILINE)
    return [dedent(found[0]) for string in strings for found in block.finditer(string)]


def commands(path: Path) -> list[list[str]]:
    """The arguments of each `warpgran` in the blocks of code of a document, without what the shell does with it."""
    text = path.read_text(encoding="utf-8").replace("\\\n", "")  # a command in two lines is one
    lines = [line for line in text.splitlines() if line.startswith("    ")]
    parts = [part for line in lines for part in line.split("&&") if part.strip().startswith("warpgran ")]
    return [shlex.split(part.partition(" > ")[0], comments=True)[1:] for part in parts]


BLOCKS = [(path, block) for path in DOCUMENTS + SUITE for block in python_blocks(path)]
INLINE = [
    (path, code)
    for path in DOCUMENTS
    for code in re.findall(r"`((?:wg|case|Case|data|xarray)\.\w[^`]*\))`", path.read_text(encoding="utf-8"))
]
COMMANDS = [(path, command) for path in DOCUMENTS for command in commands(path)]


def test_the_examples_are_found() -> None:
    assert {path.name for path, _ in BLOCKS} >= {"README.md", "cluster.md", "__init__.py"}
    assert len(COMMANDS) > 30 and len(INLINE) > 4


@pytest.mark.parametrize(
    ("path", "block"),
    [pytest.param(*each, marks=pytest.mark.slow if "distributed" in each[1] else ()) for each in BLOCKS],
    ids=[path.name for path, _ in BLOCKS],
)
def test_python_runs(folder: Path, path: Path, block: str) -> None:
    if "distributed" in block:
        distributed = pytest.importorskip("distributed")
        with distributed.LocalCluster(n_workers=1, host="127.0.0.1", dashboard_address=None) as cluster:
            exec(block.replace("tcp://HOST:8786", cluster.scheduler_address), {})
    else:
        exec(block, dict(MEASURED) if path == OWN_DATA else {})
    plt.close("all")


@pytest.mark.parametrize(("path", "code"), INLINE, ids=[code for _, code in INLINE])
def test_python_within_a_line_runs(folder: Path, path: Path, code: str) -> None:
    case = wg.Case()
    known: dict[str, Any] = {"wg": wg, "Case": wg.Case, "case": case, "xarray": xarray, "path": "runs/dense_22deg.toml"}
    if code.startswith("wg.open_dataset"):
        known["path"] = "dense_22deg.h5"
    if "data" in code:
        known["data"] = wg.open_dataset("dense_22deg.h5")
    if "(a," in code:
        known["a"] = wg.open_dataset("dense_22deg.h5")
    eval(code, known)
    plt.close("all")


@pytest.mark.slow
@pytest.mark.parametrize(("path", "command"), COMMANDS, ids=[shlex.join(command) for _, command in COMMANDS])
def test_commands_run(folder: Path, path: Path, command: list[str]) -> None:
    arguments = [found for word in command for found in (glob(word) if "*" in word else [os.path.expandvars(word)])]
    if arguments[0] in SLOW or any(word.startswith(ELSEWHERE) for word in arguments):
        parsed(arguments)
    else:
        # of all shards only some are there, and results that are compared differ
        invoke(*arguments, allowed=(0, 1) if arguments[0] in ("merge", "compare") else (0,))


def parsed(arguments: list[str]) -> None:
    """Parse a command without running it; an unknown command, option or value raises."""
    group = get_group(app)
    group.commands[arguments[0]].callback = lambda **options: None
    group.main(arguments, standalone_mode=False)


@pytest.mark.parametrize("path", DOCUMENTS, ids=[path.name for path in DOCUMENTS])
def test_commands_within_a_line_have_options_that_are_there(path: Path) -> None:
    group = get_group(app)
    for code in re.findall(r"`warpgran\s([^`]+)`", path.read_text(encoding="utf-8")):
        name, *words = code.split()
        known = {flag for option in group.commands[name].params for flag in (*option.opts, *option.secondary_opts)}
        assert {word for word in words if word.startswith("-")} <= known, code
