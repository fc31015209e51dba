"""Who may import whom. What judges the kernels shares no code with them, and layers look downward only."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
LAYERS = [
    {"tables", "schema", "kernels", "reference"},
    {"errors"},
    {"sections"},
    {"times", "sweep_section"},
    {"checks", "sweep_values"},
    {"runfile"},
    {"case"},
    {"identity"},
    {"sweep", "outputs", "device"},
    {"state"},
    {"solver"},
    {"engines", "blocks"},
    {"results"},
    {"storage", "simulation"},
    {"cluster", "jobs", "merging", "summary", "derived"},
    {"keys"},
    {"drawing"},
    {"figures", "animation", "batch_figures"},
    {"__init__", "cli"},
]
# The ways up, and only when called: Case.sweep, a shorthand for warpgran.sweep.sweep that needs no import, and
# simulate(client=...), which hands over to the cluster.
UPWARD_WHEN_CALLED = {("case", "warpgran.sweep"), ("simulation", "warpgran.cluster")}


def imports(path: Path, typing_too: bool = False, when_called: bool = True) -> set[str]:
    """Top-level names that a file imports, warpgran's own modules as warpgran.NAME."""
    tree = ast.parse(path.read_text())
    if not when_called:
        for node in ast.walk(tree):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                node.body = []
    if not typing_too:
        for node in ast.walk(tree):
            if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
                node.body = []
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found |= {f"warpgran.{a.name}" for a in node.names} if node.module == "warpgran" else {node.module}
    return {".".join(name.split(".")[:2]) if name.startswith("warpgran") else name.split(".")[0] for name in found}


def test_kernels_import_warp_alone() -> None:
    allowed = {"warp", "warpgran.kernels", "typing", "functools", "dataclasses"}
    for path in (ROOT / "kernels").glob("*.py"):
        assert imports(path, typing_too=True) <= allowed, path.name


def test_the_reference_imports_numpy_alone() -> None:
    assert imports(ROOT / "warpgran" / "reference.py") == {"__future__", "typing", "numpy"}


def test_layers_import_downward() -> None:
    level = {module: n for n, layer in enumerate(LAYERS) for module in layer}
    files = {path.stem for path in (ROOT / "warpgran").glob("*.py")}
    assert files <= level.keys(), "a new module needs its layer here"
    for name in files:
        at_once = imports(ROOT / "warpgran" / f"{name}.py", when_called=False)
        for other in imports(ROOT / "warpgran" / f"{name}.py"):
            if other.startswith("warpgran.") and (other in at_once or (name, other) not in UPWARD_WHEN_CALLED):
                assert level[other.removeprefix("warpgran.")] < level[name], f"{name} imports {other}"


@pytest.mark.parametrize(
    ("statement", "absent"),
    [
        ("import warpgran.cli", ["warp", "xarray", "matplotlib", "scipy", "pydantic", "h5py"]),
        ("import warpgran", ["matplotlib", "scipy", "warp"]),
        ("import warpgran.reference", ["warp"]),
    ],
)
def test_imports_stay_light(statement: str, absent: list[str]) -> None:
    code = f"{statement}; import sys; print(*[name for name in {absent!r} if name in sys.modules])"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert found == []


def test_kernels_is_no_top_level_package() -> None:
    code = "import kernels"
    failed = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT, check=False)
    assert "import this package as warpgran.kernels" in failed.stderr
