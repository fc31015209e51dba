"""What the application has beside its commands: version, completion."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from warpgran.cli.app import app

BASH, FISH = shutil.which("bash"), shutil.which("fish")
SHIM = f"""#!{sys.executable}
import sys
from warpgran.cli.app import main
sys.argv[0] = "warpgran"
main()
"""
COMPLETE = """
source completion
COMP_WORDS=({words}) COMP_CWORD={last}
_warpgran_completion ./warpgran
echo "${{COMPREPLY[@]}}"
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with the command and what `--show-completion` prints for bash and fish."""
    monkeypatch.setenv("_TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION", "1")  # tests may run in none
    command = tmp_path / "warpgran"
    command.write_text(SHIM)
    command.chmod(0o755)
    for shell, name in (("bash", "completion"), ("fish", "completion.fish")):
        script = CliRunner().invoke(app, ["--show-completion", shell], prog_name="warpgran").stdout
        (tmp_path / name).write_text(script)
    return tmp_path


def completed(folder: Path, *words: str) -> list[str]:
    """What bash offers for the last of these words."""
    assert BASH
    script = COMPLETE.format(words=" ".join(("warpgran", *words)), last=len(words))
    done = subprocess.run([BASH, "-c", script], cwd=folder, capture_output=True, text=True, check=True)
    assert done.stderr == ""
    return done.stdout.split()


def test_version() -> None:
    result = CliRunner().invoke(app, ["--version"])
    assert result.exit_code == 0
    name, number = result.stdout.split()
    assert name == "warpgran" and number[0].isdigit()


@pytest.mark.skipif(BASH is None, reason="needs bash")
def test_commands_options_and_keys_complete(folder: Path) -> None:
    assert completed(folder, "ver") == ["verify"]
    assert completed(folder, "run", "--prec") == ["--precision"]
    assert completed(folder, "run", "--precision", "float") == ["float64", "float32"]
    assert completed(folder, "run", "--set", "rheology.K") == ["rheology.K", "rheology.K_tilde"]


@pytest.mark.skipif(FISH is None, reason="needs fish")
@pytest.mark.parametrize(
    ("words", "offered"),
    [
        ("ver", ["verify"]),
        ("run --precision float", ["float32", "float64"]),
        ("run --set rheology.K", ["rheology.K", "rheology.K_tilde"]),
        ("run coll", ["collapse.toml"]),
    ],
)
def test_fish_completes(folder: Path, words: str, offered: list[str]) -> None:
    assert FISH
    (folder / "collapse.toml").touch()
    script = f"set PATH {folder} $PATH; source completion.fish; complete -C 'warpgran {words}'"
    asked = [FISH, "--no-config", "-c", script]
    done = subprocess.run(asked, cwd=folder, capture_output=True, text=True, check=True)
    assert [line.partition("\t")[0] for line in done.stdout.splitlines()] == offered


@pytest.mark.skipif(BASH is None, reason="needs bash")
def test_run_files_complete_by_the_shell_itself(folder: Path) -> None:
    (folder / "collapse.toml").touch()
    assert completed(folder, "run", "coll") == []  # where we offer nothing, `-o default` offers files
    assert "complete -o default -F _warpgran_completion warpgran" in (folder / "completion").read_text()


def test_a_command_ends_without_a_search_for_garbage_in_all_modules() -> None:
    code = (
        "import atexit, gc, sys; atexit.register(lambda: print(gc.get_freeze_count(), len(gc.get_objects())))\n"
        "from warpgran.cli.app import main; sys.argv[1:] = ['--version']; main()"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    frozen, left = map(int, done.stdout.split()[-2:])  # what is registered first is called last
    assert frozen > 100 * left
